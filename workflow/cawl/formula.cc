#include "workflow/cawl/formula.h"

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"

namespace docent::cawl {
namespace {

using Leaf = std::function<Formula(const std::string& name)>;

Formula FromExpression(const Expression& expression, const Leaf& leaf) {
  if (expression.kind == Expression::Kind::kName) return leaf(expression.name);
  Formula out;
  out.kind = expression.kind == Expression::Kind::kNot   ? Formula::Kind::kNot
             : expression.kind == Expression::Kind::kAnd ? Formula::Kind::kAnd
                                                         : Formula::Kind::kOr;
  for (const Expression& child : expression.children) out.children.push_back(FromExpression(child, leaf));
  return out;
}

// The children joined by their expression, or all of them. Names that are not children were reported as errors
// and count as true.
Formula Combine(const std::optional<Expression>& expression, const std::vector<const Text*>& names,
                const std::vector<Formula>& children) {
  if (!expression) {
    Formula all;
    all.children = children;
    return all;
  }
  return FromExpression(*expression, [&](const std::string& name) {
    for (size_t i = 0; i < names.size(); ++i) {
      if (names[i]->value == name) return children[i];
    }
    return Formula();
  });
}

absl::Status TooMany(std::string_view what, std::string_view limit, size_t value) {
  return absl::InvalidArgumentError(absl::StrCat("the condition has more than ", value, " ", ToAbsl(what),
                                                 " when its `or`s are carried to the outside; the limit ",
                                                 ToAbsl(limit), " is ", value));
}

size_t Leaves(const Formula& formula) {
  size_t leaves = formula.children.empty() ? 1 : 0;
  for (const Formula& child : formula.children) leaves += Leaves(child);
  return leaves;
}

size_t Parts(const Conjunction& conjunction) {
  size_t parts = conjunction.constraints.size() + conjunction.events.size();
  for (const Formula& absent : conjunction.absent) parts += Leaves(absent);
  return parts;
}

size_t Parts(const std::vector<Conjunction>& alternatives) {
  size_t parts = 0;
  for (const Conjunction& alternative : alternatives) parts += Parts(alternative);
  return parts;
}

void Append(const Conjunction& from, Conjunction* to) {
  for (const Constraint* c : from.constraints) {
    if (std::find(to->constraints.begin(), to->constraints.end(), c) == to->constraints.end())
      to->constraints.push_back(c);
  }
  for (const Event* e : from.events) {
    if (std::find(to->events.begin(), to->events.end(), e) == to->events.end()) to->events.push_back(e);
  }
  to->absent.insert(to->absent.end(), from.absent.begin(), from.absent.end());
}

// Each of `left` with each of `right`.
absl::Status Multiply(std::vector<Conjunction>* left, const std::vector<Conjunction>& right) {
  if (left->size() * right.size() > kWorkflowLimits.condition_alternatives)
    return TooMany("alternatives", "condition_alternatives", kWorkflowLimits.condition_alternatives);
  if (Parts(*left) * right.size() + Parts(right) * left->size() > kWorkflowLimits.condition_parts)
    return TooMany("constraints and events", "condition_parts", kWorkflowLimits.condition_parts);
  if (right.size() == 1) {
    for (Conjunction& l : *left) Append(right[0], &l);
    return absl::OkStatus();
  }
  std::vector<Conjunction> product;
  product.reserve(left->size() * right.size());
  for (const Conjunction& l : *left) {
    for (const Conjunction& r : right) {
      product.push_back(l);
      Append(r, &product.back());
    }
  }
  *left = std::move(product);
  return absl::OkStatus();
}

}  // namespace

Formula FormulaOf(const Rule& rule) {
  std::vector<const Text*> names;
  std::vector<Formula> children;
  for (const Constraint& constraint : rule.constraints) {
    names.push_back(&constraint.name);
    Formula leaf;
    leaf.kind = Formula::Kind::kConstraint;
    leaf.constraint = &constraint;
    children.push_back(std::move(leaf));
  }
  return Combine(rule.expression, names, children);
}

Formula FormulaOf(const Context& context) {
  Formula all;
  for (const Rule& rule : context.rules) all.children.push_back(FormulaOf(rule));
  return all;
}

Formula FormulaOf(const Case& event_case) {
  std::vector<const Text*> names;
  std::vector<Formula> children;
  for (const Event& event : event_case.events) {
    names.push_back(&event.operation);
    Formula leaf;
    leaf.kind = Formula::Kind::kEvent;
    leaf.event = &event;
    children.push_back(std::move(leaf));
  }
  return Combine(event_case.expression, names, children);
}

Formula FormulaOf(const Condition& condition) {
  std::vector<const Text*> names;
  std::vector<Formula> children;
  for (const Context& context : condition.contexts) {
    names.push_back(&context.name);
    children.push_back(FormulaOf(context));
  }
  for (const Case& c : condition.cases) {
    names.push_back(&c.name);
    children.push_back(FormulaOf(c));
  }
  return Combine(condition.expression, names, children);
}

std::vector<Formula> PartsOf(const Condition& condition) {
  if (condition.expression) return {FormulaOf(condition)};
  std::vector<Formula> parts;
  for (const Context& context : condition.contexts) parts.push_back(FormulaOf(context));
  for (const Case& c : condition.cases) parts.push_back(FormulaOf(c));
  return parts;
}

absl::StatusOr<std::vector<Conjunction>> ToAlternatives(const Formula& formula) {
  std::vector<Conjunction> out;
  switch (formula.kind) {
    case Formula::Kind::kConstraint:
      out.emplace_back().constraints.push_back(formula.constraint);
      return out;
    case Formula::Kind::kEvent:
      out.emplace_back().events.push_back(formula.event);
      return out;
    case Formula::Kind::kNot:
      if (formula.children[0].kind == Formula::Kind::kNot)
        return ToAlternatives(formula.children[0].children[0]);
      out.emplace_back().absent.push_back(formula.children[0]);
      return out;
    case Formula::Kind::kOr:
      for (const Formula& child : formula.children) {
        absl::StatusOr<std::vector<Conjunction>> part = ToAlternatives(child);
        if (!part.ok()) return part.status();
        out.insert(out.end(), part->begin(), part->end());
        if (out.size() > kWorkflowLimits.condition_alternatives)
          return TooMany("alternatives", "condition_alternatives", kWorkflowLimits.condition_alternatives);
      }
      return out;
    case Formula::Kind::kAnd:
      out.emplace_back();
      for (const Formula& child : formula.children) {
        absl::StatusOr<std::vector<Conjunction>> part = ToAlternatives(child);
        if (!part.ok()) return part.status();
        if (absl::Status status = Multiply(&out, *part); !status.ok()) return status;
      }
      return out;
  }
  return out;
}

}  // namespace docent::cawl
