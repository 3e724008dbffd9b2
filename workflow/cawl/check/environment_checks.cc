#include "workflow/cawl/check/environment_checks.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/function_registry.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/rule_names.h"
#include "workflow/cawl/structure_checks.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::cawl {
namespace {

// "https://w3id.org/docent#" of "https://w3id.org/docent#isAt".
std::string_view NamespaceOf(std::string_view iri) {
  size_t end = iri.find_last_of("#/");
  if (end == std::string_view::npos) end = iri.rfind(':');
  return end == std::string_view::npos ? std::string_view() : iri.substr(0, end + 1);
}

class EnvironmentChecker {
 public:
  EnvironmentChecker(const Document& document, const Environment& environment, xml::ElementReader* reader)
      : document_(document),
        environment_(environment),
        reader_(*reader),
        names_(IriNames::WellKnown()),
        operations_(environment.OperationNames()) {
    for (const auto& [prefix, iri] : document.prefixes) names_.Add(prefix, iri);
  }

  void Check(Cancellation* cancellation) {
    for (const ServiceProvider& provider : document_.providers) {
      for (const Service& service : provider.services) CheckOperation(service.operation);
    }
    CheckTypes(document_);
    if (document_.activator) {
      CheckTypes(*document_.activator);
      CheckCondition(document_.activator->condition);
    }
    for (const Flow& flow : document_.flows) CheckFlow(flow, cancellation);
  }

 private:
  static constexpr char kDeclare[] = "declare it in the ontology, if it is not misspelt";
  static constexpr char kNeverHolds[] = "it will never hold unless a fact with this word is told";

  // Of what a scope declares: classes, or datatypes of the ontology.
  template <typename ScopeElement>
  void CheckTypes(const ScopeElement& element) {
    otherwise_ = kDeclare;
    const auto check = [&](const std::optional<Term>& type, const SourceSpan& span) {
      if (type && type->IsIri() && !environment_.IsKnown(type->lexical))
        CheckWord(type->lexical, span, kClasses);
    };
    for (const Message& message : element.messages) {
      for (const Part& part : message.parts) check(part.type_term, part.type.span);
    }
    for (const Variable& variable : element.variables) check(variable.type_term, variable.type.span);
    otherwise_ = kNeverHolds;
  }

  std::optional<OperationSignature> CheckOperation(const Text& name) {
    if (name.empty()) return std::nullopt;
    std::optional<OperationSignature> found = environment_.FindOperation(name.value);
    if (!found && environment_.KnowsServices() && !reader_.full(Diagnostic::Severity::kWarning)) {
      const std::string known = operations_.empty()
                                    ? "no robot offers anything now and no RSEL process is registered"
                                    : Concat("there are: ", xml::ListOf(operations_));
      xml::Advice advice = reader_.DidYouMean(name.value, operations_, known);
      advice.hint = Concat("an invoke of it waits until a robot joins that offers it; ", advice.hint);
      reader_
          .Warning(
              name.span,
              Concat("no robot offers operation ", name.value, " now, and no robot service has this name"),
              advice)
          .rule = kUnknownOperation;
    }
    return found;
  }

  // The class, and those that stand above it in the ontology: what an operation of the class is, too.
  std::set<std::string> WithSuperclasses(const std::string& iri) const {
    static const std::string sub_class = Concat(kRdfsNs, "subClassOf"),
                             same = Concat(kOwlNs, "equivalentClass");
    std::set<std::string> seen = {iri};
    std::vector<std::string> next = {iri};
    while (!next.empty()) {
      const Term at = Term::Iri(next.back());
      next.pop_back();
      std::vector<Term> above = environment_.Objects(at, sub_class);
      for (const Term& term : environment_.Objects(at, same)) above.push_back(term);
      for (const Term& term : environment_.Subjects(same, at)) above.push_back(term);
      for (const Term& term : above) {
        if (term.IsIri() && seen.insert(term.lexical).second) next.push_back(term.lexical);
      }
    }
    return seen;
  }

  // Of operations that robots offer now.
  struct Offered {
    bool known = false;  // false: it is not known which robots there are
    std::vector<std::string> classes;
    std::set<std::string> with_superclasses;
  };
  const Offered& OfferedClasses() {
    if (offered_) return *offered_;
    Offered& out = offered_.emplace();
    std::optional<std::vector<std::string>> classes = environment_.OfferedCapabilities();
    out.known = classes.has_value();
    if (classes) out.classes = *std::move(classes);
    for (const std::string& iri : out.classes) out.with_superclasses.merge(WithSuperclasses(iri));
    return out;
  }

  void CheckCapability(const Invoke& invoke) {
    const std::string& quoted = invoke.operation.value;
    if (quoted.size() < 2) return;  // a mistake that is reported already
    const std::string wanted = quoted.substr(1, quoted.size() - 2);
    otherwise_ = "an invoke of it waits until a robot joins that offers an operation of this class";
    CheckWord(wanted, invoke.operation.span, kClasses);
    otherwise_ = kNeverHolds;
    const Offered& offered = OfferedClasses();
    if (!offered.known || offered.with_superclasses.contains(wanted) ||
        reader_.full(Diagnostic::Severity::kWarning))
      return;
    std::vector<std::string> shown;
    for (const std::string& iri : offered.classes) shown.push_back(names_.Iri(iri));
    const std::string known = shown.empty() ? "no robot describes what class its operations are of"
                                            : Concat("there are: ", xml::ListOf(shown));
    reader_
        .Warning(invoke.operation.span,
                 Concat("no robot offers an operation of class ", names_.Iri(wanted), " now"),
                 Concat("an invoke of it waits until a robot joins that offers one; ", known))
        .rule = kUnknownOperation;
  }

  void CheckSubflow(const Text& name) {
    if (name.empty() || document_.FindFlow(name.value) != nullptr ||
        reader_.full(Diagnostic::Severity::kError))
      return;
    if (!environment_.KnowsServices()) return;
    if (!services_) {
      const std::vector<std::string> names = environment_.ApplicationServices();
      services_.emplace(names.begin(), names.end());
    }
    if (services_->contains(name.value)) return;
    std::vector<std::string> known(services_->begin(), services_->end());
    for (const Flow& flow : document_.flows) known.push_back(flow.name.value);
    reader_.Error(name.span, Concat("there is no flow or deployed workflow ", name.value),
                  reader_.DidYouMean(name.value, known, Concat("there are: ", xml::ListOf(known))));
  }

  // Keys that can have a value somewhere in the flow: declared ones, and what the activator's and nodes' conditions bind.
  std::set<std::string> KeysOf(const Flow& flow) const {
    std::set<std::string> out;
    Scope cawl(document_);
    Scope scope(cawl, flow);
    for (const Scope* s : {&cawl, &scope}) {
      for (const Variable& v : s->variables()) {
        for (const std::string& key : scope.Keys(v)) out.insert(key);
      }
    }
    if (document_.activator && document_.activator->flow.value == flow.name.value) {
      for (const std::string& name : BoundBy(document_.activator->condition)) out.insert(name);
    }
    for (const Node& node : flow.nodes) {
      if (!node.condition) continue;
      for (const std::string& name : BoundBy(*node.condition)) out.insert(name);
    }
    return out;
  }

  void CheckFlow(const Flow& flow, Cancellation* cancellation) {
    if (IsOver(cancellation)) return;
    CheckTypes(flow);
    std::set<std::string> keys = KeysOf(flow);
    for (const Node& node : flow.nodes) {
      if (IsOver(cancellation)) return;
      CheckTypes(node);
      if (node.condition) CheckCondition(*node.condition);
      if (node.hold) CheckConstraint(*node.hold);
      for (const Action& action : node.actions) {
        otherwise_ = action.kind == Action::Kind::kTell
                         ? kDeclare
                         : "it takes nothing away unless a fact with this word is told";
        for (const Constraint& fact : action.facts) CheckConstraint(fact);
        otherwise_ = kNeverHolds;
        for (const Computation::Call& call : action.computed.calls) CheckCall(call);
      }
      CheckOperation(node.compensate);
      for (const Invoke& invoke : node.invokes) {
        for (const Input& input : invoke.inputs) {
          for (const Computation::Call& call : input.computed.calls) CheckCall(call);
        }
        CheckSubflow(invoke.subflow);
        if (invoke.capability.given()) {
          CheckCapability(invoke);
          continue;
        }
        if (!invoke.subflow.empty()) continue;  // an operation beside it is an error of its own
        std::optional<OperationSignature> operation = CheckOperation(invoke.operation);
        if (operation && operation->inputs_known) {
          CheckInputs(flow, node, invoke, *operation, keys);
          CheckGiven(invoke, *operation);
        }
      }
    }
    for (const Link& link : flow.links) {
      if (link.while_constraint) CheckConstraint(*link.while_constraint);
    }
  }

  void CheckCall(const Computation::Call& call) {
    if (environment_.Functions() == nullptr || reader_.full(Diagnostic::Severity::kWarning)) return;
    const auto mistake = sparql::FindCallMistake(environment_.Functions(), call.function, call.arguments);
    if (!mistake) return;
    reader_.Warning(call.place, Concat(mistake->message, ": the node will fail"), mistake->hint).rule =
        kUndefinedTerm;
  }

  void CheckInputs(const Flow& flow, const Node& node, const Invoke& invoke,
                   const OperationSignature& operation, const std::set<std::string>& keys) {
    for (const std::string& input : operation.inputs) {
      if (keys.contains(input) || invoke.FindInput(input) != nullptr) continue;
      bool own = std::any_of(node.variables.begin(), node.variables.end(),
                             [&](const Variable& v) { return v.name.value == input; });
      if (own) continue;
      std::vector<std::string> known(keys.begin(), keys.end());
      std::string message =
          Concat("operation ", operation.name, " needs ", input, ", but no variable ", input,
                 " is declared in flow ", flow.name.value, " and no condition binds ?", input);
      const std::string hint =
          reader_
              .DidYouMean(input, known,
                          Concat("write <variable name=\"", input, "\"> or bind ?", input, " in a condition"))
              .hint;
      if (operation.of_robot) {
        reader_.Warning(invoke.operation.span, std::move(message), hint).rule = kUnsetVariable;
      } else {
        reader_.Error(invoke.operation.span, std::move(message), hint).rule = kUnsetVariable;
      }
    }
  }

  // By ext:input; `robot` says which robot does it.
  void CheckGiven(const Invoke& invoke, const OperationSignature& operation) {
    for (const Input& input : invoke.inputs) {
      const std::vector<std::string>& known = operation.inputs;
      if (input.part.empty() || input.part.value == "robot" || reader_.full(Diagnostic::Severity::kWarning) ||
          std::find(known.begin(), known.end(), input.part.value) != known.end())
        continue;
      reader_
          .Warning(input.part.span,
                   Concat("operation ", operation.name, " has no input ", input.part.value,
                          ": this value is not used"),
                   reader_.DidYouMean(input.part.value, known,
                                      known.empty() ? std::string("it has no inputs")
                                                    : Concat("it has: ", xml::ListOf(known))))
          .rule = kUnknownInput;
    }
  }

  void CheckCondition(const Condition& condition) {
    for (const Context& context : condition.contexts) {
      for (const Rule& rule : context.rules) {
        for (const Constraint& constraint : rule.constraints) CheckConstraint(constraint);
      }
    }
  }

  void CheckConstraint(const Constraint& constraint) {
    if (constraint.time != Constraint::Time::kNone) {  // the clock's own words, but for a place that is open
      const Word& place = constraint.subject;
      if (place.kind == Word::Kind::kTerm && place.term.IsIri())
        CheckResource(place.term.lexical, place.span);
      return;
    }
    if (constraint.verb.kind == Word::Kind::kTerm) {
      CheckWord(constraint.verb.term.lexical, constraint.verb.span, kProperties);
    }
    bool types = constraint.verb.kind == Word::Kind::kTerm && constraint.verb.term.lexical == kRdfType;
    for (const Word* word : {&constraint.subject, &constraint.object}) {
      if (word->type_term && word->type_term->IsIri()) {
        CheckWord(word->type_term->lexical, word->type.span, kClasses);
      }
      if (word->kind != Word::Kind::kTerm || !word->term.IsIri()) continue;
      if (types && word == &constraint.object) {
        CheckWord(word->term.lexical, word->span, kClasses);
      } else {
        CheckResource(word->term.lexical, word->span);
      }
    }
  }

  using List = std::vector<std::string> (Environment::*)(std::string_view) const;
  enum Kind { kClasses, kProperties, kWords };
  static constexpr List kLists[] = {&Environment::Classes, &Environment::Properties, &Environment::Words};

  // What the ontologies have in a namespace. Many words are of few namespaces.
  const std::vector<std::string>& KnownIn(std::string_view space, Kind kind) {
    const auto [it, is_new] = known_in_.try_emplace({std::string(space), kind});
    if (is_new) it->second = (environment_.*kLists[kind])(space);
    return it->second;
  }

  // Only in namespaces of which the ontology describes words of this kind.
  void CheckWord(const std::string& iri, const SourceSpan& span, Kind kind) {
    const bool of_class = kind == kClasses;
    std::string_view space = NamespaceOf(iri);
    if (space == kXsdNs || space == kRdfNs || reader_.full(Diagnostic::Severity::kWarning)) return;
    if (of_class ? environment_.IsClass(iri) : environment_.IsProperty(iri)) return;
    const std::vector<std::string>& known = KnownIn(space, kind);
    if (!known.empty()) Warn(iri, span, of_class ? "class" : "property", known);
  }

  // An individual: only where its namespace is an ontology's own (it defines classes or properties).
  void CheckResource(const std::string& iri, const SourceSpan& span) {
    std::string_view space = NamespaceOf(iri);
    if (environment_.IsKnown(iri) || reader_.full(Diagnostic::Severity::kWarning)) return;
    if (KnownIn(space, kClasses).empty() && KnownIn(space, kProperties).empty()) return;
    Warn(iri, span, "word", KnownIn(space, kWords));
  }

  void Warn(const std::string& iri, const SourceSpan& span, std::string_view kind,
            const std::vector<std::string>& known) {
    size_t cut = NamespaceOf(iri).size();
    std::vector<std::string> locals;
    for (const std::string& k : known) locals.push_back(k.substr(cut));
    xml::Advice advice = reader_.DidYouMean(iri.substr(cut), locals, otherwise_);
    if (!advice.right.empty())
      advice.hint = Concat("did you mean ", names_.Iri(Concat(NamespaceOf(iri), advice.right)), "?");
    reader_.Warning(span, Concat("the ontology has no ", kind, " ", names_.Iri(iri)), advice).rule =
        kUndefinedTerm;
  }

  const Document& document_;
  const Environment& environment_;
  xml::ElementReader& reader_;
  IriNames names_;
  std::vector<std::string> operations_;
  std::optional<std::set<std::string>> services_;
  std::optional<Offered> offered_;
  std::map<std::pair<std::string, Kind>, std::vector<std::string>> known_in_;
  std::string otherwise_ = kNeverHolds;  // the hint where no word is near
};

}  // namespace

void CheckAgainst(const Document& document, const Environment& environment, xml::ElementReader* reader,
                  Cancellation* cancellation) {
  EnvironmentChecker(document, environment, reader).Check(cancellation);
}

}  // namespace docent::cawl
