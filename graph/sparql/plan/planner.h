// Algebra → plan, second half: the order of patterns and joins, and each join's method, from exact counts of
// one graph version. For patterns see join_order.h. Other operands are ordered greedily: the one with the
// fewest rows for the variables bound so far comes next; very many are ordered by the rows of each alone. One thread.
#ifndef DOCENT_GRAPH_SPARQL_PLAN_PLANNER_H_
#define DOCENT_GRAPH_SPARQL_PLAN_PLANNER_H_

#include <string>

#include "graph/sparql/plan/evaluation_context.h"
#include "graph/sparql/plan/plan.h"

namespace docent::sparql {

struct PlannerOptions {
  bool reorder = true;  // false: as written
};

// Arranges `node` and everything inside it, also the plans of EXISTS. `bound`: slots that have a value
// before the plan begins (initial bindings). Reads counts from context.version and ids from
// context.constants.
// Ends early, with a plan that must not run, where context.status is no longer OK.
void ArrangePlan(PlanNodePtr& node, const SlotSet& bound, EvaluationContext& context,
                 const PlannerOptions& options);
void ArrangeExpression(PlanExpression& expression, const SlotSet& bound, EvaluationContext& context,
                       const PlannerOptions& options);

// True if evaluating `node` with the slots `outer` already bound gives exactly its solutions that are
// compatible with them. Section 18.6 evaluates operands on their own. Most operands may see the other side's
// bindings; exceptions are a FILTER on a variable from outside, an OPTIONAL whose right side shares a
// variable with outside, LIMIT, and groups.
bool IsSafeWithBound(const PlanNode& node, const SlotSet& outer);

// For people: one line for each node, indented, with estimated rows; `measured`: also with the actual rows
// and times.
std::string ExplainPlan(const PlanNode& node, bool measured);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_PLAN_PLANNER_H_
