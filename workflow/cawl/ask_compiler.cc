#include "workflow/cawl/ask_compiler.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "workflow/cawl/ask_writer.h"
#include "workflow/cawl/formula.h"
#include "workflow/cawl/lasting_rules.h"

namespace docent::cawl {
namespace {

CompiledAsk Written(AskWriter writer, std::string name, int priority) {
  CompiledAsk out;
  out.name = std::move(name);
  out.priority = priority;
  out.ask = writer.Text();
  out.free_variables = writer.free_variables();
  out.unset = writer.unset();
  out.event_variables = writer.event_variables();
  return out;
}

absl::StatusOr<CompiledAsk> Compile(const Document& document, const Formula& formula,
                                    const VariableValues& values, std::string name, int priority) {
  absl::StatusOr<std::vector<Conjunction>> alternatives = ToAlternatives(formula);
  if (!alternatives.ok()) return alternatives.status();
  AskWriter writer(document, values);
  absl::Status status = writer.Write(*alternatives);
  if (!status.ok()) return status;
  return Written(std::move(writer), std::move(name), priority);
}

std::string NameOr(const Text& name, std::string otherwise) {
  return name.empty() ? otherwise : name.value;
}

// The rules of `context` that must have held for some time become parts of `ask`, and its text says so.
absl::Status AddLasting(const Document& document, const Context& context, const VariableValues& values,
                        CompiledAsk* ask) {
  std::string notes;
  for (size_t i = 0; i < context.rules.size(); ++i) {
    const Rule& rule = context.rules[i];
    if (!rule.at_least_ms) continue;
    absl::StatusOr<CompiledAsk> part = Compile(document, FormulaOf(rule), values, "", 0);
    if (!part.ok()) return part.status();
    LastingAsk lasting{std::move(part->ask), {}, *rule.at_least_ms};
    const std::set<std::string> bound = CertainVariables(rule);
    std::copy_if(part->free_variables.begin(), part->free_variables.end(),
                 std::back_inserter(lasting.variables),
                 [&bound](const std::string& name) { return bound.contains(name); });
    ask->lasting.push_back(std::move(lasting));
    absl::StrAppend(&notes, "# ", absl::StrCat("rule ", NameOr(rule.name, absl::StrCat(i + 1))),
                    ": for at least ", rule.for_text.value, "\n");
  }
  ask->ask = notes + ask->ask;
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<CompiledAsk>> CompileCondition(const Document& document,
                                                          const Condition& condition,
                                                          const VariableValues& values) {
  std::vector<CompiledAsk> out;
  if (condition.expression) {
    absl::StatusOr<CompiledAsk> ask =
        Compile(document, FormulaOf(condition), values, ToText(*condition.expression), 0);
    if (!ask.ok()) return ask.status();
    out.push_back(*std::move(ask));
    return out;
  }
  std::vector<const Context*> contexts;
  for (const Context& context : condition.contexts) contexts.push_back(&context);
  std::stable_sort(contexts.begin(), contexts.end(),
                   [](const Context* a, const Context* b) { return a->priority < b->priority; });
  for (const Context* context : contexts) {
    absl::StatusOr<CompiledAsk> ask =
        Compile(document, FormulaOf(*context), values,
                NameOr(context->name, absl::StrCat("context ", out.size() + 1)), context->priority);
    if (!ask.ok()) return ask.status();
    absl::Status lasting = AddLasting(document, *context, values, &*ask);
    if (!lasting.ok()) return lasting;
    out.push_back(*std::move(ask));
  }
  for (const Case& c : condition.cases) {
    absl::StatusOr<CompiledAsk> ask = Compile(document, FormulaOf(c), values, NameOr(c.name, "case"), 0);
    if (!ask.ok()) return ask.status();
    out.push_back(*std::move(ask));
  }
  return out;
}

absl::StatusOr<CompiledAsk> CompileConstraint(const Document& document, const Constraint& constraint,
                                              const VariableValues& values) {
  Formula formula;
  formula.kind = Formula::Kind::kConstraint;
  formula.constraint = &constraint;
  return Compile(document, formula, values, NameOr(constraint.name, "while"), 0);
}

std::vector<std::string> KeyVariables(const Activator& activator, const CompiledAsk& ask) {
  std::vector<std::string> out = ask.event_variables;
  for (const std::string& name : ask.free_variables) {
    bool own = std::any_of(activator.variables.begin(), activator.variables.end(),
                           [&](const Variable& v) { return v.name.value == name; });
    if (own || activator.variables.empty()) out.push_back(name);
  }
  return out;
}

std::vector<ConditionText> ConditionTexts(const Document& document) {
  std::vector<ConditionText> out;
  VariableValues none = [](const std::string&) { return std::nullopt; };
  SourceSpan span;
  auto add = [&](const std::string& place, const absl::StatusOr<CompiledAsk>& ask, const std::string& what) {
    if (!ask.ok()) {
      out.push_back({place, absl::StrCat("# cannot be compiled: ", ask.status().message()), span});
      return;
    }
    std::string notes;
    for (const std::string& name : ask->unset)
      absl::StrAppend(&notes, "# ?", name, " is the value of $", name, " at run time\n");
    bool says_so = absl::StartsWith(ask->name, what);  // "context 2"
    out.push_back({absl::StrCat(place, " / ", says_so ? "" : what + " ", ask->name), notes + ask->ask, span});
  };
  auto add_condition = [&](const std::string& place, const Condition& condition) {
    span = condition.span;
    absl::StatusOr<std::vector<CompiledAsk>> asks = CompileCondition(document, condition, none);
    if (!asks.ok()) return add(place, asks.status(), "");
    for (const CompiledAsk& ask : *asks)
      add(place, ask, condition.expression ? "condition" : ask.by_event() ? "case" : "context");
  };
  if (document.activator) {
    add_condition(document.activator->name.empty()
                      ? "activator"
                      : absl::StrCat("activator ", document.activator->name.value),
                  document.activator->condition);
  }
  for (const Flow& flow : document.flows) {
    std::string flow_place = absl::StrCat("flow ", flow.name.value);
    for (const Node& node : flow.nodes) {
      if (node.condition)
        add_condition(absl::StrCat(flow_place, " / node ", node.name.value), *node.condition);
    }
    for (const Link& link : flow.links) {
      if (!link.while_constraint) continue;
      span = link.while_text.span;
      add(absl::StrCat(flow_place, " / link ", link.from.value, " → ", link.to.value),
          CompileConstraint(document, *link.while_constraint, none), "while");
    }
  }
  return out;
}

}  // namespace docent::cawl
