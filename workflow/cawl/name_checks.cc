#include <algorithm>
#include <map>
#include <set>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "workflow/cawl/structure_checks.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::cawl {
namespace {

class NameChecker {
 public:
  NameChecker(const Document& document, xml::ElementReader* reader)
      : document_(document), reader_(*reader), cawl_(document) {}

  void Check() {
    CheckScope(cawl_, "the document");
    Unique(document_.flows, "flow", "the document");
    Unique(document_.providers, "serviceProvider", "the document");
    if (document_.activator) CheckActivator(*document_.activator);
    if (document_.flows.empty()) reader_.Error(document_.name.span, "the document has no <flow>");
    for (const Flow& flow : document_.flows) CheckFlow(flow);
  }

 private:
  template <typename T>
  void Unique(const std::vector<T>& things, std::string_view what, std::string_view where) {
    std::map<std::string, int> lines;
    for (const T& thing : things) {
      if (thing.name.empty()) continue;
      auto [it, is_new] = lines.emplace(thing.name.value, thing.name.span.line);
      if (!is_new) {
        reader_.Error(thing.name.span, Concat(what, " ", thing.name.value, " stands twice in ", where),
                      absl::StrCat("the first is in line ", it->second));
      }
    }
  }

  void CheckScope(const Scope& scope, std::string_view where) {
    Unique(scope.messages(), "message", where);
    Unique(scope.variables(), "variable", where);
    for (const Message& message : scope.messages()) {
      Unique(message.parts, "part", Concat("message ", message.name.value));
    }
    for (const Variable& variable : scope.variables()) CheckVariable(scope, variable);
  }

  void CheckVariable(const Scope& scope, const Variable& variable) {
    const Message* message = scope.PartsOf(variable);
    const std::string& type = variable.type.value;
    if (!type.empty() && message == nullptr && type.find(':') == std::string::npos) {
      reader_.Error(variable.type.span,
                    Concat("there is no message ", type, " to type variable ", variable.name.value),
                    reader_.DidYouMean(type, scope.MessageNames(),
                                       "name a message, or a class or datatype as prefix:local"));
    }
    std::set<std::string> initialized;
    for (const Initialize& i : variable.initializers) {
      if (!initialized.insert(i.part.value).second) {
        reader_.Error(i.part.given() ? i.part.span : i.span,
                      Concat("variable ", variable.name.value, i.part.given() ? "." : "", i.part.value,
                             " is initialized twice"));
      }
      if (i.part.given()) CheckPart(scope, variable, i.part);
      if (!i.part.given() && message != nullptr && i.value) {
        reader_.Error(i.from_expression.span,
                      Concat("variable ", variable.name.value, " has parts; one value cannot fill it"),
                      "say which part: <initialize part=\"…\">");
      }
      if (i.from_variable.given()) {
        const Variable* from = Declared(scope, i.from_variable.value, i.from_variable.span);
        if (from != nullptr && i.from_part.given()) CheckPart(scope, *from, i.from_part);
      } else if (!i.copy_of.empty()) {
        CheckUse(scope, i.copy_of, i.from_expression.span);
      }
    }
  }

  void CheckPart(const Scope& scope, const Variable& variable, const Text& part) {
    const Message* message = scope.PartsOf(variable);
    std::vector<std::string> names;
    if (message != nullptr) {
      for (const Part& p : message->parts) names.push_back(p.name.value);
    }
    if (std::find(names.begin(), names.end(), part.value) != names.end()) return;
    if (message == nullptr) {
      reader_.Error(part.span, Concat("variable ", variable.name.value, " has no parts"),
                    "type it with a message to give it parts");
    } else {
      reader_.Error(part.span,
                    Concat("message ", message->name.value, " of variable ", variable.name.value,
                           " has no part ", part.value),
                    reader_.DidYouMean(part.value, names, Concat("its parts: ", xml::ListOf(names))));
    }
  }

  const Variable* Declared(const Scope& scope, std::string_view name, const SourceSpan& span) {
    const Variable* variable = scope.FindVariable(name);
    if (variable == nullptr && !reader_.full(Diagnostic::Severity::kError)) {
      reader_.Error(span, Concat("variable $", name, " is not declared here"),
                    reader_.DidYouMean(name, scope.VariableNames(),
                                       Concat("write <variable name=\"", name, "\"/> in the flow, or ?", name,
                                              " for a free one")));
    }
    return variable;
  }

  // A use as "name" or "name.part".
  void CheckUse(const Scope& scope, const std::string& key, const SourceSpan& span) {
    size_t dot = key.find('.');
    const Variable* variable = Declared(scope, key.substr(0, dot), span);
    if (variable == nullptr) return;
    if (dot != std::string::npos) {
      CheckPart(scope, *variable, {key.substr(dot + 1), span});
    } else if (scope.PartsOf(*variable) != nullptr) {
      reader_.Error(span, Concat("variable $", key, " has parts"),
                    Concat("write $", scope.Keys(*variable).empty() ? key : scope.Keys(*variable)[0]));
    }
  }

  void CheckConstraint(const Scope& scope, const Constraint& constraint) {
    for (const Word* word : {&constraint.subject, &constraint.verb, &constraint.object}) {
      if (word->kind == Word::Kind::kVariable) CheckUse(scope, word->name, word->span);
    }
  }

  // `target`: what one of them alone may give a value.
  template <typename Target>
  void CheckOutputs(const Scope& scope, const std::vector<Output>& outputs, const Target& target) {
    std::set<std::string> given;
    for (const Output& output : outputs) {
      if (output.variable.empty()) continue;
      CheckUse(scope, output.variable.value, output.variable.span);
      const Text& name = target(output);
      if (!given.insert(name.value).second)
        reader_.Error(name.span, Concat("two <output> give ", name.value), "take one of them away");
    }
  }

  void CheckInputs(const Scope& scope, const Computation& computed) {
    for (size_t i = 0; i < computed.inputs.size(); ++i)
      CheckUse(scope, computed.inputs[i], computed.input_places[i]);
  }

  void CheckInputs(const Scope& scope, const Invoke& invoke) {
    std::set<std::string> given;
    for (const Input& input : invoke.inputs) {
      if (!input.variable.empty()) CheckUse(scope, input.variable.value, input.variable.span);
      CheckInputs(scope, input.computed);
      if (!input.part.empty() && !given.insert(input.part.value).second)
        reader_.Error(input.part.span, Concat("two <input> give ", input.part.value),
                      "take one of them away");
    }
  }

  // What is told has a value in each place: ?name is what the node's condition binds.
  void CheckAction(const Scope& scope, const Node& node, const Action& action) {
    const std::vector<std::string> bound =
        node.condition ? BoundBy(*node.condition) : std::vector<std::string>();
    CheckInputs(scope, action.computed);
    for (const Text& variable : action.data) CheckUse(scope, variable.value, variable.span);
    for (const auto& [name, span] : action.uses) CheckUse(scope, name, span);
    for (const Text& output : action.computed.outputs) CheckUse(scope, output.value, output.span);
    for (const Constraint& fact : action.facts) {
      CheckConstraint(scope, fact);
      if (action.kind != Action::Kind::kTell && action.kind != Action::Kind::kReserve &&
          action.kind != Action::Kind::kRelease)
        continue;
      for (const Word* word : {&fact.subject, &fact.verb, &fact.object}) {
        if (word->kind != Word::Kind::kFree ||
            std::find(bound.begin(), bound.end(), word->name) != bound.end())
          continue;
        reader_.Error(word->span, Concat("the node's condition does not bind ?", word->name),
                      reader_.DidYouMean(word->name, bound,
                                         Concat("write $", word->name, " for a variable of the run")));
      }
    }
  }

  // Each name of the expression is a child; a child that it leaves out is not looked at, which is worth a warning.
  void CheckExpression(const std::optional<Expression>& expression, const std::vector<const Text*>& children,
                       std::string_view what) {
    if (!expression) return;
    std::vector<std::string> names;
    for (const Text* t : children) {
      if (!t->empty()) names.push_back(t->value);
    }
    std::set<std::string> used;
    for (const Expression* e : NamesIn(*expression)) {
      used.insert(e->name);
      if (std::find(names.begin(), names.end(), e->name) != names.end() ||
          reader_.full(Diagnostic::Severity::kError))
        continue;
      reader_.Error(
          e->span, Concat("the expression names ", e->name, ", but there is no ", what, " of that name here"),
          AdviceOnName(*e, names,
                       names.empty() ? Concat("give each ", what, " a name")
                                     : Concat("there are: ", xml::ListOf(names)),
                       reader_));
    }
    for (const Text* t : children) {
      if (!t->empty() && !used.contains(t->value)) {
        reader_.Warning(t->span,
                        Concat(what, " ", t->value, " is not in the expression and will not be looked at"));
      }
    }
  }

  void CheckCondition(const Scope& scope, const Condition& condition) {
    std::vector<const Text*> children;
    for (const Context& context : condition.contexts) {
      children.push_back(&context.name);
      for (const Rule& rule : context.rules) {
        std::vector<const Text*> constraints;
        for (const Constraint& constraint : rule.constraints) {
          CheckConstraint(scope, constraint);
          constraints.push_back(&constraint.name);
        }
        Unique(rule.constraints, "constraint",
               rule.name.empty() ? "its rule" : Concat("rule ", rule.name.value));
        CheckExpression(rule.expression, constraints, "constraint");
      }
      Unique(context.rules, "rule",
             context.name.empty() ? "its context" : Concat("context ", context.name.value));
    }
    Unique(condition.contexts, "context", "the condition");
    for (const Case& c : condition.cases) {
      children.push_back(&c.name);
      std::vector<const Text*> events;
      for (const Event& event : c.events) events.push_back(&event.operation);
      CheckExpression(c.expression, events, "event");
      for (const Context& context : condition.contexts) {
        if (!c.name.empty() && c.name.value == context.name.value) {
          reader_.Error(c.name.span, Concat("case ", c.name.value, " has the name of a context"));
        }
      }
    }
    CheckExpression(condition.expression, children, "context or case");
  }

  void CheckActivator(const Activator& activator) {
    Scope scope(cawl_, activator);
    CheckScope(scope, "the activator");
    CheckCondition(scope, activator.condition);
    if (activator.flow.empty() || document_.FindFlow(activator.flow.value) != nullptr) return;
    std::vector<std::string> flows;
    for (const Flow& flow : document_.flows) flows.push_back(flow.name.value);
    reader_.Error(activator.flow.span, Concat("there is no flow ", activator.flow.value, " to activate"),
                  reader_.DidYouMean(activator.flow.value, flows, Concat("flows: ", xml::ListOf(flows))));
  }

  void CheckFlow(const Flow& flow) {
    Scope flow_scope(cawl_, flow);
    CheckScope(flow_scope, Concat("flow ", flow.name.value));
    Unique(flow.nodes, "node", Concat("flow ", flow.name.value));
    std::set<std::string> assigned;
    for (const Node& node : flow.nodes) {
      for (const Action& action : node.actions) {
        for (const Text& output : action.computed.outputs) assigned.insert(output.value);
      }
    }
    for (const Node& node : flow.nodes) {
      if (!node.name.empty() &&
          (node.name.value == flow.source.value || node.name.value == flow.sink.value)) {
        reader_.Error(node.name.span, Concat("node ", node.name.value, " has the name of the flow's ",
                                             node.name.value == flow.source.value ? "source" : "sink"));
      }
      Scope scope(flow_scope, node);
      CheckScope(scope, Concat("node ", node.name.value));
      if (node.condition) CheckCondition(scope, *node.condition);
      if (node.hold) CheckConstraint(scope, *node.hold);
      for (const Action& action : node.actions) CheckAction(scope, node, action);
      for (const Invoke& invoke : node.invokes) {
        CheckInputs(scope, invoke);
        CheckOutputs(scope, invoke.outputs,
                     [](const Output& output) -> const Text& { return output.variable; });
      }
      CheckForEach(node, assigned);
    }
    CheckOutputs(flow_scope, flow.outputs, [](const Output& output) -> const Text& {
      return output.part.given() ? output.part : output.variable;
    });
    for (const Link& link : flow.links) {
      if (link.while_constraint) CheckConstraint(flow_scope, *link.while_constraint);
    }
  }

  // `assigned`: what nodes of the flow give a value.
  void CheckForEach(const Node& node, const std::set<std::string>& assigned) {
    if (node.for_each.empty()) return;
    std::vector<std::string> bound = node.condition ? BoundBy(*node.condition) : std::vector<std::string>();
    for (const std::string& name : node.for_each) {
      if (assigned.contains(name) || std::find(bound.begin(), bound.end(), name) != bound.end()) continue;
      if (reader_.full(Diagnostic::Severity::kError)) return;
      bound.insert(bound.end(), assigned.begin(), assigned.end());
      reader_.Error(
          node.for_each_text.span, Concat("forEach: the node's condition does not bind ?", name),
          reader_.DidYouMean(name, bound,
                             bound.empty() ? "it binds nothing" : Concat("it binds ?", xml::ListOf(bound))));
    }
  }

  const Document& document_;
  xml::ElementReader& reader_;
  Scope cawl_;
};

}  // namespace

void CheckNames(const Document& document, xml::ElementReader* reader) {
  NameChecker(document, reader).Check();
}

}  // namespace docent::cawl
