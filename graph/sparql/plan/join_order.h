// Cost-based order of the patterns of a basic graph pattern. Each pattern is a level of nested lookups
// (operator_bgp.cc); the cost of an order is the number of lookups and rows of its levels.
//
// The number of matches of a pattern's constants is exact (subtree counts of the index). The number of values
// of a variable among them is that number if nothing else is open, else a power of it; or, if the query looks
// expensive enough, an estimate from a few sampled matches and their exact counts. Rows of a join: the
// product over the larger number of values of each shared variable (Selinger et al., SIGMOD 1979). Orders are
// searched greedily, and by dynamic programming over sets of patterns (left-deep) if that pays; of very many patterns only
// those that share a variable are looked at, so that the time grows with their number, not its square. One thread.
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
  // The patterns and filters of `bgp`; the slots `bound` have a value before it begins. Reads counts from
  // context.version and stores them in the patterns.
  // Ends early where the context's status is no longer OK. `bound` must outlive it.
  JoinOrder(PlanNode& bgp, const SlotSet& bound, EvaluationContext& context);

  // Estimated rows of the greedy order for one start. Changes nothing.
  double Rows();
  // Orders the patterns of the node, sets their estimates, and returns the estimated rows. `reorder` false
  // keeps the order.
  double Arrange(bool reorder);

 private:
  static constexpr size_t kMaxVariables = 32;
  static constexpr size_t kMaxProgrammed = 10;  // patterns that dynamic programming orders
  static constexpr size_t kMaxGreedy = 64;      // patterns that are compared with each other at each step

  struct Use {
    int variable;   // number within this BGP
    int position;   // 0 to 3: subject, predicate, object, graph
    double values;  // set only if the variable is `shared_`
  };
  struct Pattern {
    double matches = 0;
    const Use* begin() const { return uses.data(); }
    const Use* end() const { return uses.data() + used; }
    std::array<Use, 4> uses;
    int used = 0;            // number of uses
    bool one_open = false;   // one open position: one triple for each value, or a few with several graphs
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
  // State after some of the patterns.
  struct State : Step {
    uint64_t bound = 0;
    std::array<float, kMaxVariables> values;  // of each bound variable
  };
  // A pattern by number, with the rows after it.
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
  // The cost and rows of adding `pattern` after `state`.
  Step Estimate(const State& state, const Pattern& pattern) const;
  // Adds that step to the state.
  void Extend(const Pattern& pattern, const Step& step, State* state) const;
  Order AsWritten() const;
  Order Greedy(State* end) const;
  // The rarest pattern first, then always the rarest that shares a variable with those before, if one does.
  Order Connected() const;
  Order Programmed() const;
  // Computes the rows of an order.
  void Follow(Order* order, State* end) const;

  PlanNode& bgp_;
  const SlotSet& bound_;
  EvaluationContext& context_;
  uint64_t initial_ = 0;
  uint64_t variables_ = 0,
           shared_ = 0;  // those used, and those whose number of values matters: used twice, or initial
  absl::InlinedVector<int, 8> slots_;  // of the variables
  absl::InlinedVector<Pattern, 8> patterns_;
  absl::InlinedVector<Filter, 4> filters_;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_PLAN_JOIN_ORDER_H_
