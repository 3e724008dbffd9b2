// Evaluation of planned expressions over rows. One thread.
#ifndef DOCENT_GRAPH_SPARQL_RUN_EXPRESSION_EVALUATOR_H_
#define DOCENT_GRAPH_SPARQL_RUN_EXPRESSION_EVALUATOR_H_

#include "graph/sparql/plan/evaluation_context.h"
#include "graph/sparql/plan/plan.h"

namespace docent::sparql {

// The value of `e` on `row`, or an error value. `e` changes inside (EXISTS operators, compiled regular
// expressions).
Value Evaluate(PlanExpression& e, const TermId* row, EvaluationContext& context);
// The id of the value, kNone if it is an error.
TermId EvaluateToId(PlanExpression& e, const TermId* row, EvaluationContext& context);
// The effective boolean value; nullopt is an error.
std::optional<bool> EvaluateBoolean(PlanExpression& e, const TermId* row, EvaluationContext& context);
// The value for FILTER: an error is false.
inline bool Passes(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  return EvaluateBoolean(e, row, context).value_or(false);
}
// One of the functions of section 17.4 on evaluated arguments; not BOUND, COALESCE, IF, which evaluate their
// arguments themselves.
Value CallBuiltin(PlanExpression& e, const std::vector<Value>& arguments, EvaluationContext& context);
// Fast path of CONTAINS, STRSTARTS or STRENDS for two plain strings of moderate length in the query or the
// dictionary; it makes no values. nullopt: not such a call.
std::optional<bool> TestPlainTexts(const PlanExpression& e, const TermId* row, EvaluationContext& context);
// The groups of builtins, one file each.
Value CallStringBuiltin(PlanExpression& e, const std::vector<Value>& arguments, EvaluationContext& context);
Value CallTermBuiltin(PlanExpression& e, const std::vector<Value>& arguments, EvaluationContext& context);
Value CallTimeBuiltin(Builtin builtin, const Value& argument);
Value CallHashBuiltin(Builtin builtin, const Value& argument);
Value CallRegexBuiltin(PlanExpression& e, const std::vector<Value>& arguments, EvaluationContext& context);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_EXPRESSION_EVALUATOR_H_
