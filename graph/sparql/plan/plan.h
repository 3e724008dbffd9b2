// Query plan: variables are slots of a row, constants are numbers of a table, joins have an order and a
// method. The planner makes it for one size of graph; the operators are built from it and keep the state of
// one evaluation in its nodes. One thread.
#ifndef DOCENT_GRAPH_SPARQL_PLAN_PLAN_H_
#define DOCENT_GRAPH_SPARQL_PLAN_PLAN_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graph/sparql/plan/slot_set.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/sparql/values/value.h"

namespace docent::sparql {

struct PlanNode;
class Operator;
class Regex;

// A slot, or a constant, or (both negative) a wildcard.
struct PlanTerm {
  int slot = -1;
  int constant = -1;
};

// The graph that a pattern is matched in.
struct GraphRef {
  enum class Kind : uint8_t { kDefault, kNamed };
  Kind kind = Kind::kDefault;
  PlanTerm name;  // kNamed
};

struct PlanPattern {
  PlanTerm terms[3];  // subject, predicate, object
  GraphRef graph;
  const TriplePattern* source = nullptr;  // as written, for Explain; lives as long as the query
  double matches = -1;                    // triples that fit its constants; negative: not counted yet
  double estimate = 0;                    // estimated rows for each row before it
  uint64_t rows = 0;                      // actual rows, over all runs of this plan
  bool hashed = false;                    // its last lookups used a hash table (operator_bgp.cc)
};

// An expression with its variables resolved. EXISTS holds its own plan and, once built, its operator.
struct PlanExpression {
  const Expression* source = nullptr;  // as written, for Explain; lives as long as the query
  Expression::Kind kind = Expression::Kind::kTerm;
  Builtin builtin = Builtin::kStr;
  int slot = -1;
  Value constant;
  Term term;  // kTerm as written; kFunction: the IRI
  std::vector<std::unique_ptr<PlanExpression>> arguments;
  std::vector<Value> values;  // kBuiltin: of the arguments, at the last call; constants keep theirs
  std::unique_ptr<PlanNode> exists;
  std::unique_ptr<Operator> exists_operator;
  std::vector<TermId> exists_base, exists_row;
  // REGEX and REPLACE: the last compiled expression, and its pattern and flags.
  std::shared_ptr<Regex> regex;
  std::string regex_source;
  size_t regex_bytes = 0;  // counted of it, as memory of the plan

  PlanExpression();
  ~PlanExpression();
};
using PlanExpressionPtr = std::unique_ptr<PlanExpression>;

// Semantics of a node: given an input row `in` whose slots may be bound from outside, it gives the solutions
// that are compatible with `in`, each merged with `in`.
struct PlanNode {
  enum class Kind : uint8_t {
    kBgp,           // patterns in order, filters after them
    kJoin,          // children in order; each gets the rows of the one before (index nested loop)
    kHashJoin,      // children[1] once, into a hash table
    kLeftJoin,      // as kJoin with expression
    kHashLeftJoin,  // as kHashJoin with expression
    kFilter,
    kUnion,
    kMinus,      // children[1] for each row
    kHashMinus,  // children[1] once
    kGraph,      // children[0] for each graph, in slot `graph_slot`; then name
    kExtend,
    kValues,
    kGroup,
    kOrderBy,
    kProject,  // clears the slots that are not `columns`
    kDistinct,
    kSlice,
    kPath,
  };
  struct AggregatePlan {
    Aggregate::Function function;
    bool distinct;
    PlanExpressionPtr expression;  // null: COUNT(*)
    std::string separator;
    int result;
  };

  explicit PlanNode(Kind kind) : kind(kind) {}

  Kind kind;
  const Algebra* source = nullptr;  // kPath, kExtend, kValues: as written; lives as long as the query
  std::vector<std::unique_ptr<PlanNode>> children;
  SlotSet certain;       // bound in every solution
  SlotSet possible;      // bound in some solution; both without slots bound from outside
  SlotSet mentions;      // possible, and the slots that expressions inside read
  bool barrier = false;  // contains a group, slice, sort or distinct: run once rather than for each row
  double estimate = 1;   // rows for each start
  uint64_t starts = 0, rows_made = 0;  // actual starts and rows, if measured
  double seconds = 0;                  // time, with all nodes beneath, if measured

  std::vector<PlanPattern> patterns;
  std::vector<PlanExpressionPtr> filters;  // kBgp: all; kFilter: the conjuncts
  std::vector<SlotSet> filter_slots;       // what each filter, or `expression`, reads
  PlanExpressionPtr expression;            // kLeftJoin, kHashLeftJoin (may be null), kExtend
  int slot = -1;                           // kExtend
  int graph_slot = -1;                     // kGraph
  PlanTerm name;                           // kGraph
  std::vector<int> columns;                // kValues, kProject, kDistinct; kGroup: of COUNT(DISTINCT *)
  const std::vector<std::vector<std::optional<Term>>>* rows = nullptr;  // kValues: as in `source`
  std::vector<std::pair<int, PlanExpressionPtr>> keys;                  // kGroup
  std::vector<AggregatePlan> aggregates;                                // kGroup
  std::vector<std::pair<PlanExpressionPtr, bool>> order;                // kOrderBy: expression, descending
  uint64_t offset = 0;
  std::optional<uint64_t> limit;   // kSlice; kOrderBy: the number of rows needed
  PlanTerm subject, object;        // kPath
  Term subject_term, object_term;  // kPath, where they are constants: a path of length zero needs no triple
  const Path* path = nullptr;
  std::vector<int> path_constants;  // kPath: the numbers of its IRIs, in order of occurrence
  GraphRef graph;                   // kPath
};
using PlanNodePtr = std::unique_ptr<PlanNode>;

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_PLAN_PLAN_H_
