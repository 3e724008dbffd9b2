// The operators that run a plan: pull iterators over rows of slots. One thread.
#ifndef DOCENT_GRAPH_SPARQL_RUN_OPERATORS_H_
#define DOCENT_GRAPH_SPARQL_RUN_OPERATORS_H_

#include <cstdint>
#include <memory>

#include "graph/sparql/plan/evaluation_context.h"
#include "graph/sparql/plan/plan.h"

namespace docent::sparql {

// Gives the solutions of its plan node that are compatible with an input row, merged with it. After an error
// of the context (cancelled, limit) Next returns false soon; whoever pulls looks at context.status before it
// believes the end.
class Operator {
 public:
  virtual ~Operator() = default;
  // Begins anew with `in`, a row of all slots; copied. May be called at any time.
  virtual void Start(const TermId* in) = 0;
  // The next solution into `out`, a row of all slots. False: there is none; `out` then has no meaning.
  virtual bool Next(TermId* out) = 0;
  // How many solutions are still to come; then there are none. `scratch` is a row of all slots.
  virtual uint64_t Count(TermId* scratch) {
    uint64_t count = 0;
    while (Next(scratch)) ++count;
    return count;
  }
  // The run has ended, or another begins: what was kept must go, and its memory with it.
  virtual void Forget() {}
};

// What building needs. `base` is the row that begins the plan this operator belongs to: the initial bindings,
// or the row for which EXISTS is asked. Operators that run an operand once and keep its rows begin it with
// that row.
struct BuildContext {
  EvaluationContext* context;
  size_t slots;
  const TermId* base;
  bool measure = false;  // count rows and time of each node, for Explain
};

std::unique_ptr<Operator> BuildOperator(PlanNode& node, const BuildContext& build);

// One file a family; BuildOperator chooses.
std::unique_ptr<Operator> BuildBgp(PlanNode& node, const BuildContext& build);
std::unique_ptr<Operator> BuildJoin(PlanNode& node, const BuildContext& build);
std::unique_ptr<Operator> BuildHashJoin(PlanNode& node, const BuildContext& build);
std::unique_ptr<Operator> BuildMinus(PlanNode& node, const BuildContext& build);
std::unique_ptr<Operator> BuildGraph(PlanNode& node, const BuildContext& build);
std::unique_ptr<Operator> BuildGroup(PlanNode& node, const BuildContext& build);
std::unique_ptr<Operator> BuildOrderBy(PlanNode& node, const BuildContext& build);
std::unique_ptr<Operator> BuildSimple(PlanNode& node, const BuildContext& build);
std::unique_ptr<Operator> BuildPath(PlanNode& node, const BuildContext& build);
// Builds the operators of the EXISTS in an expression.
void PrepareExpression(PlanExpression& e, const BuildContext& build);
// A new run: they forget what they kept of the run before, which may have been on another version.
void ForgetExpression(PlanExpression& e);

// True if the two rows agree wherever both are bound at `slots`; then `out` (a copy of `a`) gets what `b` has
// besides.
bool MergeCompatible(const std::vector<int>& slots, const TermId* a, const TermId* b, TermId* out);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_OPERATORS_H_
