// Values of variables: used where there can be none, or of a type that does not suit.
#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/check/schema.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/link_graph.h"
#include "workflow/cawl/rule_names.h"
#include "workflow/cawl/structure_checks.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::cawl {
namespace {

using Keys = std::set<std::string>;

// What a match of the condition may give a value: ?x, and $x, which is like it until it has one.
Keys MatchedBy(const Condition& condition) {
  Keys out;
  for (const std::string& name : BoundBy(condition)) out.insert(name);
  for (const Context& context : condition.contexts) {
    for (const Rule& rule : context.rules) {
      for (const Constraint& c : rule.constraints) {
        for (const Word* word : {&c.subject, &c.verb, &c.object}) {
          if (word->kind == Word::Kind::kVariable && word->comparison == Word::Comparison::kNone)
            out.insert(word->name);
        }
      }
    }
  }
  return out;
}

void AddInitial(const Scope& scope, Keys* keys) {
  for (const InitialValue& initial : InitialValues(scope)) {
    if (initial.value || keys->contains(initial.copy_of)) keys->insert(initial.key);
  }
}

// What a node gives values to: by its condition when it opens, by its invocations when they are done.
struct NodeValues {
  Keys matched, given;
  bool gives_anything = false;  // an operation or sub-flow of which the results are not known
};

NodeValues ValuesOf(const Node& node, const Environment* environment) {
  NodeValues out;
  if (node.condition) out.matched = MatchedBy(*node.condition);
  for (const Action& action : node.actions) {
    for (const Text& output : action.outputs) out.matched.insert(output.value);
  }
  for (const Invoke& invoke : node.invokes) {
    for (const Output& output : invoke.outputs) out.given.insert(output.variable.value);
    if (!invoke.outputs.empty()) continue;
    std::optional<OperationSignature> operation;
    if (environment != nullptr && !invoke.operation.empty())
      operation = environment->FindOperation(invoke.operation.value);
    if (!operation || operation->of_robot) {
      out.gives_anything = true;
    } else {
      out.given.insert(operation->outputs.begin(), operation->outputs.end());
    }
  }
  return out;
}

// Of the flow that the activator starts: what its runs have values for, and where.
class FlowValues {
 public:
  FlowValues(const Document& document, const Flow& flow, const Environment* environment) : flow_(flow) {
    for (const Link& link : flow.links) links_[link.from.value].insert(link.to.value);
    for (const Node& node : flow.nodes) nodes_.push_back(ValuesOf(node, environment));
    const Scope cawl(document), of_activator(cawl, *document.activator), of_flow(cawl, flow);
    start_ = MatchedBy(document.activator->condition);
    for (const Scope* scope : {&cawl, &of_activator, &of_flow}) AddInitial(*scope, &start_);
  }

  const Keys& at_start() const { return start_; }

  // Whether `key` may have a value when the node opens; `after` also when it is done.
  bool MayHave(const std::string& key, const Node& node, bool after) const {
    if (start_.contains(key)) return true;
    for (size_t i = 0; i < nodes_.size(); ++i) {
      const Node& other = flow_.nodes[i];
      const bool itself = &other == &node;
      if (itself && nodes_[i].matched.contains(key)) return true;
      const bool gives =
          nodes_[i].gives_anything || nodes_[i].given.contains(key) || nodes_[i].matched.contains(key);
      if (gives && ((itself && after) || LeadsTo(other.name.value, node.name.value))) return true;
    }
    return false;
  }

 private:
  // By a way of one link at least.
  bool LeadsTo(const std::string& from, const std::string& to) const {
    const auto [it, is_new] = after_.try_emplace(from);
    if (is_new) {
      const auto first = links_.find(from);
      if (first != links_.end()) {
        for (const std::string& next : first->second) it->second.merge(Reachable(links_, next));
      }
    }
    return it->second.contains(to);
  }

  const Flow& flow_;
  LinkGraph links_;
  std::vector<NodeValues> nodes_;  // in the order of the flow's
  Keys start_;
  mutable std::map<std::string, std::set<std::string>> after_;
};

bool IsComparedVariable(const Word& word) {
  return word.kind == Word::Kind::kVariable && word.comparison != Word::Comparison::kNone;
}

class ValueChecker {
 public:
  ValueChecker(const Document& document, const Environment* environment, xml::ElementReader* reader)
      : document_(document),
        environment_(environment),
        reader_(*reader),
        names_(IriNames::WellKnown()),
        cawl_(document) {
    if (environment != nullptr) schema_ = std::make_unique<Schema>(*environment);
    for (const auto& [prefix, iri] : document.prefixes) names_.Add(prefix, iri);
  }

  void Check() {
    CheckInitialTypes(cawl_);
    if (document_.activator) {
      const Activator& activator = *document_.activator;
      const Scope scope(cawl_, activator);
      CheckInitialTypes(scope);
      const Flow* started = document_.FindFlow(activator.flow.value);
      const Scope of_flow = started == nullptr ? cawl_ : Scope(cawl_, *started);
      CheckBound(activator.condition, {&of_flow, &scope}, "run");
    }
    for (const Flow& flow : document_.flows) {
      const Scope scope(cawl_, flow);
      CheckInitialTypes(scope);
      for (const Node& node : flow.nodes) {
        CheckNode(scope, node);
        const Scope of_node(scope, node);
        if (node.condition) CheckBound(*node.condition, {&of_node}, "node");
      }
    }
    if (!document_.activator) return;
    const Flow* flow = document_.FindFlow(document_.activator->flow.value);
    if (flow != nullptr && flow->nodes.size() <= kMaxPairedNodes) CheckActivated(*flow);
  }

 private:
  Diagnostic& Warn(const SourceSpan& span, std::string message, const xml::Advice& advice, const char* rule) {
    Diagnostic& report = reader_.Warning(span, std::move(message), advice);
    report.rule = rule;
    return report;
  }

  void CheckNode(const Scope& flow_scope, const Node& node) {
    for (const Variable& variable : node.variables) {
      if (variable.initializers.empty()) continue;
      Warn(variable.name.span,
           Concat("variable ", variable.name.value,
                  " never gets its initial value: those of a node's variables have no effect"),
           "declare the variable in the flow", kUnsetVariable);
    }
    const Scope scope(flow_scope, node);
    for (const Invoke& invoke : node.invokes) CheckInputTypes(scope, invoke);
  }

  // ---- values that there are not

  void CheckActivated(const Flow& flow) {
    const FlowValues values(document_, flow, environment_);
    const Scope of_flow(cawl_, flow), of_activator(cawl_, *document_.activator);
    for (const Scope* scope : {&cawl_, &of_activator, &of_flow}) CheckCopies(*scope, values);
    for (const Node& node : flow.nodes) {
      if (node.condition) CheckComparisons(*node.condition, node, values);
      for (const Invoke& invoke : node.invokes) CheckInputs(Scope(of_flow, node), node, invoke, values);
      for (const Action& action : node.actions) CheckAction(action, node, values);
    }
    for (const Link& link : flow.links) {
      if (!link.while_constraint || !IsComparedVariable(link.while_constraint->object)) continue;
      const Word& limit = link.while_constraint->object;
      const auto from = std::find_if(flow.nodes.begin(), flow.nodes.end(),
                                     [&](const Node& node) { return node.name.value == link.from.value; });
      if (from != flow.nodes.end() && !values.MayHave(limit.name, *from, true)) NeverTrue(limit);
    }
  }

  void CheckCopies(const Scope& scope, const FlowValues& values) {
    for (const Variable& variable : scope.variables()) {
      for (const Initialize& i : variable.initializers) {
        if (i.copy_of.empty() || values.at_start().contains(i.copy_of)) continue;
        const std::string whole = i.copy_of + ".";
        const auto part = values.at_start().lower_bound(whole);
        if (part != values.at_start().end() && part->starts_with(whole)) continue;
        Warn(i.from_variable.given() ? i.from_variable.span : i.from_expression.span,
             Concat("variable ", variable.name.value, " is not set: $", i.copy_of,
                    " has no value when the activator starts the flow"),
             Concat("initialize ", i.copy_of, " before, or let the activator's condition bind it"),
             kUnsetVariable);
      }
    }
  }

  void CheckComparisons(const Condition& condition, const Node& node, const FlowValues& values) {
    for (const Context& context : condition.contexts) {
      for (const Rule& rule : context.rules) {
        for (const Constraint& c : rule.constraints) {
          if (IsComparedVariable(c.object) && !values.MayHave(c.object.name, node, false))
            NeverTrue(c.object);
        }
      }
    }
  }

  // What a node tells or takes into a query.
  void CheckAction(const Action& action, const Node& node, const FlowValues& values) {
    const auto check = [&](const std::string& name, const SourceSpan& span) {
      if (values.MayHave(name, node, action.when_done)) return;
      Warn(span, Concat("variable ", name, " is never set before: the node fails"),
           Concat("initialize it, or bind ?", name, " in a condition before"), kUnsetVariable);
    };
    for (const Constraint& fact : action.facts) {
      for (const Word* word : {&fact.subject, &fact.verb, &fact.object}) {
        if (word->kind == Word::Kind::kVariable) check(word->name, word->span);
      }
    }
    for (const auto& [name, span] : action.uses) check(name, span);
    if (action.kind == Action::Kind::kNotify) return;  // a value that there is not is null
    for (size_t i = 0; i < action.inputs.size(); ++i) check(action.inputs[i], action.input_places[i]);
  }

  void NeverTrue(const Word& word) {
    Warn(word.span, Concat("the comparison is never true: variable ", word.name, " is never set before"),
         Concat("initialize it, or bind ?", word.name, " in a condition before"), kUnsetVariable);
  }

  void CheckInputs(const Scope& scope, const Node& node, const Invoke& invoke, const FlowValues& values) {
    if (environment_ == nullptr || invoke.operation.empty()) return;
    const std::optional<OperationSignature> operation = environment_->FindOperation(invoke.operation.value);
    if (!operation || !operation->inputs_known) return;
    for (const std::string& input : operation->inputs) {
      const Variable* variable = scope.FindVariable(input);
      if (variable == nullptr || scope.PartsOf(*variable) != nullptr || values.MayHave(input, node, false))
        continue;
      Warn(invoke.operation.span,
           Concat("operation ", operation->name, " needs ", input, ", and variable ", input,
                  " is never set before"),
           Concat("initialize it, or bind ?", input, " in a condition before"), kUnsetVariable);
    }
  }

  // ---- types

  // A class or datatype that a declaration names; empty: none.
  static std::string TypeOf(const std::optional<Term>& type) {
    return type && type->IsIri() ? type->lexical : std::string();
  }

  void CheckInitialTypes(const Scope& scope) {
    for (const Variable& variable : scope.variables()) {
      const Message* message = scope.PartsOf(variable);
      for (const Initialize& i : variable.initializers) {
        std::string type = TypeOf(variable.type_term);
        if (message != nullptr) {
          const auto part = std::find_if(message->parts.begin(), message->parts.end(),
                                         [&](const Part& p) { return p.name.value == i.part.value; });
          type = part == message->parts.end() ? "" : TypeOf(part->type_term);
        }
        if (!type.empty() && i.value) CheckValue(*i.value, type, i.from_expression.span);
      }
    }
  }

  // What a match of the condition gives to variables that declare a type. `scopes`: where they are looked for, one after the
  // other. `fails`: what does where a value is of another type.
  void CheckBound(const Condition& condition, const std::vector<const Scope*>& scopes,
                  std::string_view fails) {
    const auto type_of = [&](const Word& word) -> std::string {
      if (word.kind != Word::Kind::kFree && word.kind != Word::Kind::kVariable) return "";
      if (word.comparison != Word::Comparison::kNone) return "";
      for (const Scope* scope : scopes) {
        const Variable* variable = scope->FindVariable(word.name);
        if (variable != nullptr)
          return scope->PartsOf(*variable) == nullptr ? TypeOf(variable->type_term) : "";
      }
      return "";
    };
    for (const Context& context : condition.contexts) {
      for (const Rule& rule : context.rules) {
        for (const Constraint& constraint : rule.constraints) {
          if (constraint.time != Constraint::Time::kNone) continue;
          for (const Word* word : {&constraint.subject, &constraint.object}) {
            const std::string type = type_of(*word);
            if (!type.empty()) CheckBound(constraint, *word, type, fails);
          }
        }
      }
    }
  }

  void CheckBound(const Constraint& constraint, const Word& word, const std::string& type,
                  std::string_view fails) {
    const auto warn = [&](const std::string& what) {
      Warn(word.span,
           Concat("variable ", word.name, " is of ", names_.Iri(type), ", and ", what, ": the ", fails,
                  " fails"),
           "correct the type of the variable, or the constraint", kTypeClash);
    };
    // Of $x, what is a resource and what a literal is told with the condition.
    const bool told = word.kind == Word::Kind::kVariable && schema_ != nullptr;
    const bool datatype = IsDatatype(type);
    if (&word == &constraint.subject) {
      if (datatype && !told) warn("a subject is a resource");
      return;
    }
    std::set<std::string> others;
    if (word.type_term && word.type_term->IsIri()) others.insert(word.type_term->lexical);
    if (others.empty() && schema_ != nullptr && constraint.verb.kind == Word::Kind::kTerm)
      others = schema_->Ranges(constraint.verb.term.lexical);
    for (const std::string& other : others) {
      if (other == Concat(kRdfsNs, "Resource") || !Clash(type, other)) continue;
      if (told && (!datatype || !IsDatatype(other))) continue;
      return warn(Concat("a match gives it one of ", names_.Iri(other)));
    }
  }

  bool IsDatatype(const std::string& type) const {
    return schema_ != nullptr ? schema_->IsDatatype(type) : type.starts_with(kXsdNs);
  }

  void CheckValue(const Term& value, const std::string& type, const SourceSpan& span) {
    const bool datatype = IsDatatype(type);
    const std::string wanted = names_.Iri(type);
    if (datatype != value.IsLiteral()) {
      Warn(span,
           Concat("the value is a ", value.IsLiteral() ? "literal" : "resource", ", and the type ", wanted,
                  datatype ? " is a datatype" : " is a class"),
           datatype ? "write a literal" : "write prefix:local or <iri>", kTypeClash);
      return;
    }
    if (datatype) {
      const ValueFamily given =
          FamilyOf(value.language.empty() ? value.datatype : std::string(kRdfLangString));
      const ValueFamily family = FamilyOf(type);
      if (type.starts_with(kXsdNs) && family != ValueFamily::kUnknown && given != ValueFamily::kUnknown &&
          given != family)
        Warn(span, Concat("the value is not of the type ", wanted), Concat("e.g. \"…\"^^", wanted),
             kTypeClash);
      return;
    }
    if (schema_ == nullptr) return;
    for (const std::string& cls : schema_->TypesOf(value.lexical)) {
      if (!schema_->Disjoint(cls, type)) continue;
      Warn(span, Concat("the value is in ", names_.Iri(cls), ", which is disjoint with the type ", wanted),
           "correct the value or the type", kTypeClash);
      return;
    }
  }

  // The types of variables against those of the parts of a robot service.
  void CheckInputTypes(const Scope& scope, const Invoke& invoke) {
    if (environment_ == nullptr || invoke.operation.empty()) return;
    const std::optional<OperationSignature> operation = environment_->FindOperation(invoke.operation.value);
    if (!operation) return;
    for (const auto& [input, wanted] : operation->input_types) {
      const Variable* variable = scope.FindVariable(input);
      const std::string given = variable != nullptr ? TypeOf(variable->type_term) : std::string();
      if (given.empty() || !Clash(given, wanted)) continue;
      Warn(invoke.operation.span,
           Concat("operation ", operation->name, " takes ", input, " of ", names_.Iri(wanted),
                  ", and variable ", input, " is of ", names_.Iri(given)),
           "no value is of both; correct the type of the variable, or invoke another operation", kTypeClash);
    }
  }

  bool Clash(const std::string& a, const std::string& b) const {
    const bool of_values = IsDatatype(a);
    if (of_values != IsDatatype(b)) return true;
    if (!of_values) return schema_ != nullptr && schema_->Disjoint(a, b);
    const ValueFamily one = FamilyOf(a), other = FamilyOf(b);
    return a.starts_with(kXsdNs) && b.starts_with(kXsdNs) && one != ValueFamily::kUnknown &&
           other != ValueFamily::kUnknown && one != other;
  }

  const Document& document_;
  const Environment* environment_;
  xml::ElementReader& reader_;
  IriNames names_;
  const Scope cawl_;
  std::unique_ptr<Schema> schema_;
};

}  // namespace

void CheckValues(const Document& document, const Environment* environment, xml::ElementReader* reader) {
  ValueChecker(document, environment, reader).Check();
}

}  // namespace docent::cawl
