// The order of the patterns of a basic graph pattern, by cost. Each pattern is a level of nested lookups (operator_bgp.cc);
// the cost of an order is what its levels look up and give.
//
// The number of matches of a pattern's constants is exact (subtree counts of the index). How many values a variable has in
// them is that number where nothing else is open, else a power of it, or, where the query looks expensive enough to afford
// it, estimated from a few sampled matches and their exact counts. Rows of a join: the product over the larger number of
// values of each shared variable (Selinger et al., SIGMOD 1979). Orders are tried greedily, and by dynamic programming over
// sets of patterns (left-deep) where that pays. One thread.
#ifndef DOCENT_GRAPH_SPARQL_PLAN_JOIN_ORDER_H_
#define DOCENT_GRAPH_SPARQL_PLAN_JOIN_ORDER_H_

#include <array>
#include <cstdint>
#include <vector>

#include "absl/container/inlined_vector.h"
#include "graph/sparql/plan/evaluation_context.h"
#include "graph/sparql/plan/plan.h"

namespace docent::sparql {

class JoinOrder {
 public:
  // The patterns and filters of `bgp`, where the slots `bound` have a value before it begins. Reads counts from
  // context.version, and keeps them in the patterns.
  JoinOrder(PlanNode& bgp, const SlotSet& bound, const EvaluationContext& context);

  // The rows that the best quick order gives for one start. Changes nothing.
  double Rows();
  // Puts the patterns of the node into order, sets their estimates, and returns the rows. Not `reorder`: as they stand.
  double Arrange(bool reorder);

 private:
  static constexpr size_t kMaxVariables = 32;
  static constexpr size_t kMaxProgrammed = 10;  // patterns that dynamic programming orders

  struct Use {
    int variable;   // number within this BGP
    int position;   // 0 to 3: subject, predicate, object, graph
    double values;  // known where the variable is `shared_`; nobody asks elsewhere
  };
  struct Pattern {
    double matches = 0;
    const Use* begin() const { return uses.data(); }
    const Use* end() const { return uses.data() + used; }
    std::array<Use, 4> uses;
    int used = 0;            // so many of them
    bool one_open = false;   // each of its values makes one triple, or few where several graphs have it
    uint64_t variables = 0;  // as bits
  };
  struct Filter {
    uint64_t variables = 0;
    double selectivity = 1;
    double cost = 0;  // of one evaluation
  };
  struct Step {
    double cost = 0;  // about microseconds
    double rows = 1;
  };
  // After some of the patterns.
  struct State : Step {
    uint64_t bound = 0;
    std::array<float, kMaxVariables> values;  // of each bound variable
  };
  // Patterns by number, with the rows after each.
  struct Place {
    size_t pattern;
    double rows;
  };
  using Order = absl::InlinedVector<Place, 8>;

  int VariableOf(int slot);
  void Count(PlanPattern& pattern, Pattern* out);
  void Refine(const PlanPattern& pattern, Pattern* out) const;
  QuadPattern Constants(const PlanPattern& pattern) const;
  void Begin(State* state) const;
  // What comes to with `pattern` after `state`.
  Step Estimate(const State& state, const Pattern& pattern) const;
  // Takes that step.
  void Extend(const Pattern& pattern, const Step& step, State* state) const;
  Order AsWritten() const;
  Order Greedy(State* end) const;
  Order Programmed() const;
  // Sets the rows of an order.
  void Follow(Order* order) const;

  PlanNode& bgp_;
  const EvaluationContext& context_;
  uint64_t initial_ = 0;
  uint64_t variables_ = 0,
           shared_ = 0;  // those used, and those whose number of values matters: used twice, or initial
  absl::InlinedVector<int, 8> slots_;  // of the variables
  absl::InlinedVector<Pattern, 8> patterns_;
  absl::InlinedVector<Filter, 4> filters_;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_PLAN_JOIN_ORDER_H_
