// Variables that are used where they can have no value.
#include <algorithm>
#include <string>
#include <utility>

#include "graph/base/text.h"
#include "workflow/cawl/check/flow_values.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/rule_names.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::cawl {
namespace {

bool IsComparedVariable(const Word& word) {
  return word.kind == Word::Kind::kVariable && word.comparison != Word::Comparison::kNone;
}

class ValueChecker {
 public:
  ValueChecker(const Document& document, const Environment* environment, xml::ElementReader* reader)
      : document_(document), environment_(environment), reader_(*reader), cawl_(document) {}

  void Check(Cancellation* cancellation) {
    for (const Flow& flow : document_.flows) {
      const Scope of_flow(cawl_, flow);
      for (const Node& node : flow.nodes) {
        if (IsOver(cancellation)) return;
        CheckNode(Scope(of_flow, node), node);
      }
    }
    if (!document_.activator) return;
    CheckKeys(*document_.activator);
    const Flow* flow = document_.FindFlow(document_.activator->flow.value);
    if (flow != nullptr && flow->nodes.size() <= kMaxPairedNodes) CheckActivated(*flow, cancellation);
  }

 private:
  Diagnostic& Warn(const SourceSpan& span, std::string message, const xml::Advice& advice, const char* rule) {
    Diagnostic& report = reader_.Warning(span, std::move(message), advice);
    report.rule = rule;
    return report;
  }

  void CheckNode(const Scope& scope, const Node& node) {
    for (const Action& action : node.actions) CheckFree(scope, action.computed);
    for (const Invoke& invoke : node.invokes) {
      for (const Input& input : invoke.inputs) CheckFree(scope, input.computed);
    }
    for (const Variable& variable : node.variables) {
      if (variable.initializers.empty()) continue;
      Warn(variable.name.span,
           Concat("variable ", variable.name.value,
                  " never gets its initial value: those of a node's variables have no effect"),
           "declare the variable in the flow", kUnsetVariable);
    }
  }

  // ?name in an expression: only a pattern of EXISTS gives it a value.
  void CheckFree(const Scope& scope, const Computation& computed) {
    for (const auto& [name, span] : computed.without_value) {
      const bool declared = scope.FindVariable(name) != nullptr;
      Diagnostic& report =
          Warn(span, Concat("?", name, " has no value here: nothing binds it in an expression"),
               declared ? Concat("write $", name, " for the value of the variable")
                        : Concat("write $", name, " for a variable of the run, and declare it in the flow"),
               kUnsetVariable);
      if (declared && reader_.source().substr(span.offset, 1) == "?") report.fix = {{span.offset, 1, "$"}};
    }
  }

  // The activator's own variables are there to be bound: they are the key of its runs.
  void CheckKeys(const Activator& activator) {
    Keys declared, bound;
    for (const Variable& variable : activator.variables) declared.insert(variable.name.value);
    for (const std::string& key : MatchedBy(activator.condition)) bound.insert(key.substr(0, key.find('.')));
    std::vector<std::string> meant;  // what the wrong one may stand for
    for (const std::string& name : bound) {
      if (!declared.contains(name)) meant.push_back(name);
    }
    for (const Variable& variable : activator.variables) {
      const std::string& name = variable.name.value;
      if (name.empty() || !variable.initializers.empty() || bound.contains(name) ||
          reader_.full(Diagnostic::Severity::kWarning))
        continue;
      Warn(variable.name.span,
           Concat("variable ", name, " gets no value: the activator's condition does not bind ?", name),
           reader_.DidYouMean(name, meant,
                              meant.empty() ? Concat("bind ?", name, " in the condition, or take it away")
                                            : Concat("it binds ?", xml::ListOf(meant))),
           kUnsetVariable);
    }
  }

  void CheckActivated(const Flow& flow, Cancellation* cancellation) {
    const FlowValues values(document_, flow, environment_);
    const Scope of_flow(cawl_, flow), of_activator(cawl_, *document_.activator);
    for (const Scope* scope : {&cawl_, &of_activator, &of_flow}) CheckCopies(*scope, values);
    for (const Node& node : flow.nodes) {
      if (IsOver(cancellation)) return;
      if (node.condition) CheckComparisons(*node.condition, node, values);
      for (const Invoke& invoke : node.invokes) CheckInputs(Scope(of_flow, node), node, invoke, values);
      for (const Action& action : node.actions) CheckAction(action, node, values);
    }
    for (const Link& link : flow.links) {
      if (!link.while_constraint || !IsComparedVariable(link.while_constraint->object)) continue;
      const Word& limit = link.while_constraint->object;
      const auto from = std::find_if(flow.nodes.begin(), flow.nodes.end(),
                                     [&](const Node& node) { return node.name.value == link.from.value; });
      if (from != flow.nodes.end() && !values.MayHaveAfter(limit.name, *from)) NeverTrue(limit);
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
          if (IsComparedVariable(c.object) && !values.MayHaveBefore(c.object.name, node)) NeverTrue(c.object);
        }
      }
    }
  }

  // What a node tells or takes into a query.
  void CheckAction(const Action& action, const Node& node, const FlowValues& values) {
    const auto check = [&](const std::string& name, const SourceSpan& span) {
      CheckSet(name, span, node, &action, values);
    };
    for (const Constraint& fact : action.facts) {
      for (const Word* word : {&fact.subject, &fact.verb, &fact.object}) {
        if (word->kind == Word::Kind::kVariable) check(word->name, word->span);
      }
    }
    for (const auto& [name, span] : action.uses) check(name, span);
    CheckSet(action.computed, node, &action, values);
  }

  // `action`: of the node; null: of its invokes.
  void CheckSet(const Computation& computed, const Node& node, const Action* action,
                const FlowValues& values) {
    for (size_t i = 0; i < computed.inputs.size(); ++i)
      CheckSet(computed.inputs[i], computed.input_places[i], node, action, values);
  }

  void CheckSet(const std::string& name, const SourceSpan& span, const Node& node, const Action* action,
                const FlowValues& values) {
    if (values.MayHaveIn(name, node, action)) return;
    Warn(span, Concat("variable ", name, " is never set before: the node fails"),
         Concat("initialize it, or bind ?", name, " in a condition before"), kUnsetVariable);
  }

  void NeverTrue(const Word& word) {
    Warn(word.span, Concat("the comparison is never true: variable ", word.name, " is never set before"),
         Concat("initialize it, or bind ?", word.name, " in a condition before"), kUnsetVariable);
  }

  void CheckInputs(const Scope& scope, const Node& node, const Invoke& invoke, const FlowValues& values) {
    for (const Input& input : invoke.inputs) {
      if (!input.variable.empty()) CheckSet(input.variable.value, input.variable.span, node, nullptr, values);
      CheckSet(input.computed, node, nullptr, values);
    }
    if (environment_ == nullptr || invoke.operation.empty()) return;
    const std::optional<OperationSignature> operation = environment_->FindOperation(invoke.operation.value);
    if (!operation || !operation->inputs_known) return;
    for (const std::string& input : operation->inputs) {
      const Variable* variable = scope.FindVariable(input);
      if (invoke.FindInput(input) != nullptr) continue;
      if (variable == nullptr || scope.PartsOf(*variable) != nullptr ||
          values.MayHaveIn(input, node, nullptr))
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

void CheckValues(const Document& document, const Environment* environment, xml::ElementReader* reader,
                 Cancellation* cancellation) {
  ValueChecker(document, environment, reader).Check(cancellation);
}

}  // namespace docent::cawl
