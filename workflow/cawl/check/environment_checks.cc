#include "workflow/cawl/check/environment_checks.h"

#include <algorithm>
#include <set>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/function_registry.h"
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
        operations_(environment.OperationNames()) {}

  void Check() {
    for (const ServiceProvider& provider : document_.providers) {
      for (const Service& service : provider.services) CheckOperation(service.operation);
    }
    CheckTypes(document_);
    if (document_.activator) {
      CheckTypes(*document_.activator);
      CheckCondition(document_.activator->condition);
    }
    for (const Flow& flow : document_.flows) CheckFlow(flow);
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
        CheckWord(type->lexical, span, "class", &Environment::IsClass, &Environment::Classes);
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
    if (!found && environment_.KnowsServices() && !reader_.full()) {
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

  void CheckCapability(const Invoke& invoke) {
    const std::string& quoted = invoke.operation.value;
    if (quoted.size() < 2) return;  // a mistake that is reported already
    const std::string wanted = quoted.substr(1, quoted.size() - 2);
    otherwise_ = "an invoke of it waits until a robot joins that offers an operation of this class";
    CheckWord(wanted, invoke.operation.span, "class", &Environment::IsClass, &Environment::Classes);
    otherwise_ = kNeverHolds;
    const std::optional<std::vector<std::string>> offered = environment_.OfferedCapabilities();
    if (!offered || reader_.full()) return;
    std::vector<std::string> shown;
    for (const std::string& iri : *offered) {
      if (WithSuperclasses(iri).contains(wanted)) return;
      shown.push_back(ToDisplay(Term::Iri(iri)));
    }
    const std::string known = shown.empty() ? "no robot describes what class its operations are of"
                                            : Concat("there are: ", xml::ListOf(shown));
    reader_
        .Warning(invoke.operation.span,
                 Concat("no robot offers an operation of class ", ToDisplay(Term::Iri(wanted)), " now"),
                 Concat("an invoke of it waits until a robot joins that offers one; ", known))
        .rule = kUnknownOperation;
  }

  void CheckSubflow(const Text& name) {
    if (name.empty() || document_.FindFlow(name.value) != nullptr || reader_.full()) return;
    if (!environment_.KnowsServices()) return;
    std::vector<std::string> known = environment_.ApplicationServices();
    if (std::find(known.begin(), known.end(), name.value) != known.end()) return;
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

  void CheckFlow(const Flow& flow) {
    CheckTypes(flow);
    std::set<std::string> keys = KeysOf(flow);
    for (const Node& node : flow.nodes) {
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
    if (environment_.Functions() == nullptr || reader_.full()) return;
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
      if (input.part.empty() || input.part.value == "robot" || reader_.full() ||
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
      CheckWord(constraint.verb.term.lexical, constraint.verb.span, "property", &Environment::IsProperty,
                &Environment::Properties);
    }
    bool types = constraint.verb.kind == Word::Kind::kTerm && constraint.verb.term.lexical == kRdfType;
    for (const Word* word : {&constraint.subject, &constraint.object}) {
      if (word->type_term && word->type_term->IsIri()) {
        CheckWord(word->type_term->lexical, word->type.span, "class", &Environment::IsClass,
                  &Environment::Classes);
      }
      if (word->kind != Word::Kind::kTerm || !word->term.IsIri()) continue;
      if (types && word == &constraint.object) {
        CheckWord(word->term.lexical, word->span, "class", &Environment::IsClass, &Environment::Classes);
      } else {
        CheckResource(word->term.lexical, word->span);
      }
    }
  }

  // Only in namespaces of which the ontology describes words of this kind.
  void CheckWord(const std::string& iri, const SourceSpan& span, std::string_view kind,
                 bool (Environment::*is_known)(const std::string&) const,
                 std::vector<std::string> (Environment::*list)(std::string_view) const) {
    std::string_view space = NamespaceOf(iri);
    if (space == kXsdNs || space == kRdfNs || (environment_.*is_known)(iri) || reader_.full()) return;
    std::vector<std::string> known = (environment_.*list)(space);
    if (known.empty()) return;
    Warn(iri, span, kind, known);
  }

  // An individual: only where its namespace is an ontology's own (it defines classes or properties).
  void CheckResource(const std::string& iri, const SourceSpan& span) {
    std::string_view space = NamespaceOf(iri);
    if (environment_.IsKnown(iri) || reader_.full()) return;
    if (environment_.Classes(space).empty() && environment_.Properties(space).empty()) return;
    Warn(iri, span, "word", environment_.Words(space));
  }

  void Warn(const std::string& iri, const SourceSpan& span, std::string_view kind,
            const std::vector<std::string>& known) {
    size_t cut = NamespaceOf(iri).size();
    std::vector<std::string> locals;
    for (const std::string& k : known) locals.push_back(k.substr(cut));
    reader_
        .Warning(span, Concat("the ontology has no ", kind, " ", ToDisplay(Term::Iri(iri))),
                 reader_.DidYouMean(iri.substr(cut), locals, otherwise_))
        .rule = kUndefinedTerm;
  }

  const Document& document_;
  const Environment& environment_;
  xml::ElementReader& reader_;
  std::vector<std::string> operations_;
  std::string otherwise_ = kNeverHolds;  // the hint where no word is near
};

}  // namespace

void CheckAgainst(const Document& document, const Environment& environment, xml::ElementReader* reader) {
  EnvironmentChecker(document, environment, reader).Check();
}

}  // namespace docent::cawl
