// Algebra → plan, first half. Variables become slots (those hidden by a sub-SELECT get their own), constants
// become numbers, filters move to the pattern that binds their variables, adjacent patterns are merged. The
// planner, not this class, orders the joins. One thread.
#ifndef DOCENT_GRAPH_SPARQL_PLAN_LOWERING_H_
#define DOCENT_GRAPH_SPARQL_PLAN_LOWERING_H_

#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"
#include "absl/status/status.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/plan/evaluation_context.h"
#include "graph/sparql/plan/plan.h"
#include "graph/sparql/syntax/name_numbers.h"
#include "graph/sparql/values/function_registry.h"

namespace docent::sparql {

// The constants of a query by number.
using ConstantTerms = absl::InlinedVector<const Term*, 8>;

class Lowering {
 public:
  // `context` counts the plan's memory, and ends the work with its status.
  explicit Lowering(EvaluationContext* context)
      : context_(*context), dictionary_(context->dictionary), functions_(context->functions) {}

  // The slot of a variable of the outermost scope, created if new.
  int SlotOf(const std::string& variable) { return SlotOf(variable, root_); }
  // Slots that have a value before the query begins.
  void SetBound(const SlotSet& bound) { bound_ = bound; }

  // The plan of a whole WHERE with modifiers. Null if status() is not OK: UNIMPLEMENTED or INVALID_ARGUMENT,
  // with line and column; or the context's.
  PlanNodePtr LowerQuery(const Algebra& algebra);
  PlanExpressionPtr LowerExpression(const Expression& expression);

  const absl::Status& status() const { return status_; }
  size_t slots() const { return static_cast<size_t>(next_slot_); }
  // The constants by number, once all is lowered; moves them out.
  ConstantTerms TakeConstants() { return std::move(constants_); }
  int ConstantOf(const Term& term);  // `term` must live as long as the lowered plan
  const SlotSet& bound() const { return bound_; }

 private:
  using Scope = NameNumbers;  // of variables: their slots

  int ConstantOfMany(const Term& term);
  int SlotOf(const std::string& variable, Scope& scope);
  PlanTerm TermOf(const PatternTerm& term, Scope& scope);
  // Counts a part of the plan. False if the work has to end.
  bool Count(size_t bytes);
  PlanNodePtr Lower(const Algebra& a, Scope& scope, const GraphRef& graph, bool top);
  PlanNodePtr LowerNode(const Algebra& a, Scope& scope, const GraphRef& graph, bool top);
  PlanNodePtr LowerBgp(const Algebra& a, Scope& scope, const GraphRef& graph);
  PlanNodePtr LowerJoin(const Algebra& a, Scope& scope, const GraphRef& graph);
  PlanNodePtr LowerFilter(const Algebra& a, Scope& scope, const GraphRef& graph);
  // `open`: the slots of `reads` without a value before the query begins.
  bool PushFilter(PlanNode& node, PlanExpressionPtr& filter, const SlotSet& reads, const SlotSet& open);
  PlanNodePtr LowerLeftJoin(const Algebra& a, Scope& scope, const GraphRef& graph);
  PlanNodePtr LowerGraph(const Algebra& a, Scope& scope);
  PlanNodePtr LowerValues(const Algebra& a, Scope& scope);
  PlanNodePtr LowerGroup(const Algebra& a, Scope& scope, const GraphRef& graph);
  PlanNodePtr LowerProject(const Algebra& a, Scope& scope, const GraphRef& graph, bool top);
  PlanNodePtr LowerPath(const Algebra& a, Scope& scope, const GraphRef& graph);
  PlanExpressionPtr Lower(const Expression& e, Scope& scope, const GraphRef& graph);
  // The slots that an expression reads, with those inside EXISTS; inside GRAPH ?g also the graph's slot.
  SlotSet Reads(const Expression& e, Scope& scope, const GraphRef& graph);
  void CheckFunction(const Expression& e);
  void Fail(absl::StatusCode code, const SourceSpan& span, const std::string& message);

  EvaluationContext& context_;
  const Dictionary& dictionary_;
  const FunctionRegistry* functions_;
  Scope root_;
  SlotSet bound_;
  int next_slot_ = 0;
  SlotSet hidden_;  // slots of blank nodes and of steps of paths: no variables of the query
  ConstantTerms constants_;
  absl::flat_hash_map<Term, int> constant_numbers_;  // used if there are many constants
  absl::Status status_;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_PLAN_LOWERING_H_
