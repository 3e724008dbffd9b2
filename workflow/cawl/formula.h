// A condition as a boolean formula over constraints and events, and its disjunctive normal form. Values that point
// into the syntax tree, which must outlive them; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_FORMULA_H_
#define DOCENT_WORKFLOW_CAWL_FORMULA_H_

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "workflow/cawl/ast.h"

namespace docent::cawl {

struct Formula {
  enum class Kind { kConstraint, kEvent, kNot, kAnd, kOr };
  Kind kind = Kind::kAnd;
  const Constraint* constraint = nullptr;
  const Event* event = nullptr;
  std::vector<Formula> children;  // kNot: one. An empty kAnd is true
};

// Expressions over children's names are put in their places; without one, all children.
Formula FormulaOf(const Rule& rule);
Formula FormulaOf(const Context& context);
Formula FormulaOf(const Case& event_case);
// Of a condition with an expression.
Formula FormulaOf(const Condition& condition);

// A formula for each ASK by which the condition is tried: its expression, or each context and case.
std::vector<Formula> PartsOf(const Condition& condition);

// One alternative: everything in it must hold together. A `not` keeps its formula whole, because "no such thing
// exists" may not be pulled apart where its parts share a free variable.
struct Conjunction {
  std::vector<const Constraint*> constraints;
  std::vector<const Event*> events;
  std::vector<Formula> absent;
};

// The disjunctive normal form; `not not` is dropped. INVALID_ARGUMENT beyond the limits condition_alternatives and
// condition_parts.
absl::StatusOr<std::vector<Conjunction>> ToAlternatives(const Formula& formula);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_FORMULA_H_
