// What the work of rules and standing conditions costs, in the steps of Cancellation: one is a row that a join looks at.
//
// The limits steps_per_turn and steps_per_fact stand for seconds, so each kind of work is counted as what it takes, about 10 ns
// a step (measured on an Intel Xeon at 2.6 GHz, 2026-11-25). Counted, not timed: every machine takes and refuses the same.
#ifndef DOCENT_GRAPH_BASE_STEP_COSTS_H_
#define DOCENT_GRAPH_BASE_STEP_COSTS_H_

#include <cstdint>

namespace docent {

inline constexpr uint64_t kStepsOfLookup = 8;       // where an index has to be gone down
inline constexpr uint64_t kStepsOfExpression = 16;  // that the evaluator of expressions computes
inline constexpr uint64_t kStepsOfHead = 3;         // a triple that a rule makes, new or not
inline constexpr uint64_t kStepsOfHeadAmongMany =
    15;  // the same where so many were made that the cache does not hold them
inline constexpr uint64_t kStepsOfCandidate = 10;  // one that was not made before in the turn
inline constexpr uint64_t kStepsOfFact = 60;       // one that goes into the graph or out of it
inline constexpr uint64_t kStepsOfInstance = 120;  // a rule specialised to axioms

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_STEP_COSTS_H_
