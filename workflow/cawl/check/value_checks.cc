// Variables that are used where they can have no value.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "graph/base/text.h"
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
    for (const Text& output : action.computed.outputs) out.matched.insert(output.value);
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
      : document_(document), environment_(environment), reader_(*reader), cawl_(document) {}

  void Check() {
    for (const Flow& flow : document_.flows) {
      for (const Node& node : flow.nodes) CheckNode(node);
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

  void CheckNode(const Node& node) {
    for (const Variable& variable : node.variables) {
      if (variable.initializers.empty()) continue;
      Warn(variable.name.span,
           Concat("variable ", variable.name.value,
                  " never gets its initial value: those of a node's variables have no effect"),
           "declare the variable in the flow", kUnsetVariable);
    }
  }

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
      CheckSet(name, span, node, action.when_done, values);
    };
    for (const Constraint& fact : action.facts) {
      for (const Word* word : {&fact.subject, &fact.verb, &fact.object}) {
        if (word->kind == Word::Kind::kVariable) check(word->name, word->span);
      }
    }
    for (const auto& [name, span] : action.uses) check(name, span);
    CheckSet(action.computed, node, action.when_done, values);
  }

  void CheckSet(const Computation& computed, const Node& node, bool when_done, const FlowValues& values) {
    for (size_t i = 0; i < computed.inputs.size(); ++i)
      CheckSet(computed.inputs[i], computed.input_places[i], node, when_done, values);
  }

  void CheckSet(const std::string& name, const SourceSpan& span, const Node& node, bool when_done,
                const FlowValues& values) {
    if (values.MayHave(name, node, when_done)) return;
    Warn(span, Concat("variable ", name, " is never set before: the node fails"),
         Concat("initialize it, or bind ?", name, " in a condition before"), kUnsetVariable);
  }

  void NeverTrue(const Word& word) {
    Warn(word.span, Concat("the comparison is never true: variable ", word.name, " is never set before"),
         Concat("initialize it, or bind ?", word.name, " in a condition before"), kUnsetVariable);
  }

  void CheckInputs(const Scope& scope, const Node& node, const Invoke& invoke, const FlowValues& values) {
    for (const Input& input : invoke.inputs) {
      if (!input.variable.empty()) CheckSet(input.variable.value, input.variable.span, node, false, values);
      CheckSet(input.computed, node, false, values);
    }
    if (environment_ == nullptr || invoke.operation.empty()) return;
    const std::optional<OperationSignature> operation = environment_->FindOperation(invoke.operation.value);
    if (!operation || !operation->inputs_known) return;
    for (const std::string& input : operation->inputs) {
      const Variable* variable = scope.FindVariable(input);
      if (invoke.FindInput(input) != nullptr) continue;
      if (variable == nullptr || scope.PartsOf(*variable) != nullptr || values.MayHave(input, node, false))
        continue;
      Warn(invoke.operation.span,
           Concat("operation ", operation->name, " needs ", input, ", and variable ", input,
                  " is never set before"),
           Concat("initialize it, or bind ?", input, " in a condition before"), kUnsetVariable);
    }
  }

  const Document& document_;
  const Environment* environment_;
  xml::ElementReader& reader_;
  const Scope cawl_;
};

}  // namespace

void CheckValues(const Document& document, const Environment* environment, xml::ElementReader* reader) {
  ValueChecker(document, environment, reader).Check();
}

}  // namespace docent::cawl
