// Operators that run a plan: pull iterators over rows of slots. One thread.
#ifndef DOCENT_GRAPH_SPARQL_RUN_OPERATORS_H_
#define DOCENT_GRAPH_SPARQL_RUN_OPERATORS_H_

#include <cstdint>
#include <memory>

#include "graph/sparql/plan/evaluation_context.h"
#include "graph/sparql/plan/plan.h"

namespace docent::sparql {

// Gives the solutions of its plan node that are compatible with an input row, merged with it. After an error
// of the context (cancelled, limit) Next soon returns false; the caller checks context.status before it takes
// that as the end.
class Operator {
 public:
  virtual ~Operator() = default;
  // Restarts with `in`, a row of all slots; copied. May be called at any time.
  virtual void Start(const TermId* in) = 0;
  // The next solution into `out`, a row of all slots. False: there is none; `out` then has no meaning.
  virtual bool Next(TermId* out) = 0;
  // Number of remaining solutions; consumes them. `scratch` is a row of all slots.
  virtual uint64_t Count(TermId* scratch) {
    uint64_t count = 0;
    while (Next(scratch)) ++count;
    return count;
  }
  // Called when the run ends or another begins: drops kept rows and releases their memory.
  virtual void Forget() {}
};

// Arguments of building. `base` is the row that begins the plan of this operator: the initial bindings, or
// the row on which EXISTS is evaluated. Operators that run an operand once and keep its rows start it with
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
// A new run begins: drops rows kept from the run before, which may have been on another version.
void ForgetExpression(PlanExpression& e);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_OPERATORS_H_
