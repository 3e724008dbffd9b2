// ?name where the run has a value of that name: it may match anything, and most often $name was meant.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "graph/base/text.h"
#include "workflow/cawl/structure_checks.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::cawl {
namespace {

// The names of an expression that do not stand under a `not`.
void PositiveNames(const Expression& expression, std::set<std::string>* out) {
  if (expression.kind == Expression::Kind::kNot) return;
  if (expression.kind == Expression::Kind::kName) out->insert(expression.name);
  for (const Expression& child : expression.children) PositiveNames(child, out);
}

bool Counts(const std::optional<Expression>& expression, const Text& name) {
  if (!expression) return true;
  std::set<std::string> names;
  PositiveNames(*expression, &names);
  return names.contains(name.value);
}

void AddFreeWords(const Constraint& constraint, std::vector<const Word*>* out) {
  for (const Word* word : {&constraint.subject, &constraint.verb, &constraint.object}) {
    if (word->kind != Word::Kind::kFree || word->comparison != Word::Comparison::kNone) continue;
    if (std::none_of(out->begin(), out->end(), [&](const Word* known) { return known->name == word->name; }))
      out->push_back(word);
  }
}

std::vector<const Word*> FreeWords(const Constraint& constraint) {
  std::vector<const Word*> out;
  AddFreeWords(constraint, &out);
  return out;
}

// The free variables outside of `not`, where each stands first.
std::vector<const Word*> FreeWords(const Condition& condition) {
  std::vector<const Word*> out;
  for (const Context& context : condition.contexts) {
    if (!Counts(condition.expression, context.name)) continue;
    for (const Rule& rule : context.rules) {
      for (const Constraint& constraint : rule.constraints) {
        if (!Counts(rule.expression, constraint.name)) continue;
        AddFreeWords(constraint, &out);
      }
    }
  }
  return out;
}

class FreeNameChecker {
 public:
  FreeNameChecker(const Document& document, const Flow& flow, xml::ElementReader* reader)
      : document_(document), flow_(flow), reader_(*reader) {
    if (document.activator && document.activator->flow.value == flow.name.value)
      activated_ = BoundBy(document.activator->condition);
  }

  void Check() {
    const Scope cawl(document_), of_flow(cawl, flow_);
    for (const Node& node : flow_.nodes) {
      const Scope scope(of_flow, node);
      if (node.condition) Check(scope, FreeWords(*node.condition));
      if (node.hold) Check(scope, FreeWords(*node.hold));
    }
    for (const Link& link : flow_.links) {
      if (link.while_constraint) Check(of_flow, FreeWords(*link.while_constraint));
    }
  }

 private:
  void Check(const Scope& scope, const std::vector<const Word*>& words) {
    for (const Word* word : words) {
      const Variable* variable = scope.FindVariable(word->name);
      const bool initialized = variable != nullptr && !variable->initializers.empty();
      if (!initialized && std::find(activated_.begin(), activated_.end(), word->name) == activated_.end())
        continue;
      Diagnostic& report = reader_.Warning(
          word->span,
          Concat("?", word->name, " may match another value than the one that ",
                 initialized ? "the variable begins with" : "the activator bound"),
          Concat(
              "write $", word->name, " for the run's own",
              variable != nullptr ? "" : Concat(", and <variable name=\"", word->name, "\"/> in the flow")));
      if (variable != nullptr && reader_.source().substr(word->span.offset, 1) == "?")
        report.fix = {{word->span.offset, 1, "$"}};
    }
  }

  const Document& document_;
  const Flow& flow_;
  xml::ElementReader& reader_;
  std::vector<std::string> activated_;  // what the activator's condition binds
};

}  // namespace

std::vector<std::string> BoundBy(const Condition& condition) {
  std::vector<std::string> out;
  for (const Word* word : FreeWords(condition)) out.push_back(word->name);
  return out;
}

void CheckFreeNames(const Document& document, xml::ElementReader* reader) {
  for (const Flow& flow : document.flows) FreeNameChecker(document, flow, reader).Check();
}

}  // namespace docent::cawl
