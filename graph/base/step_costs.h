// Costs of rule and condition work, in the steps of Cancellation; one step is a row that a join looks at.
//
// The limits steps_per_turn and steps_per_fact stand for seconds, so each kind of work counts by its time:
// 10 ns a step (measured on an Intel Xeon at 2.6 GHz, 2026-11-25). A count gives the same verdict on every machine.
#ifndef DOCENT_GRAPH_BASE_STEP_COSTS_H_
#define DOCENT_GRAPH_BASE_STEP_COSTS_H_

#include <cstdint>

namespace docent {

inline constexpr uint64_t kStepsOfLookup = 8;       // descent into an index
inline constexpr uint64_t kStepsOfExpression = 16;  // computed by the evaluator of expressions
inline constexpr uint64_t kStepsOfHead = 3;         // a triple that a rule makes, new or not
inline constexpr uint64_t kStepsOfHeadAmongMany =
    15;  // the same once so many were made that the cache does not hold them
inline constexpr uint64_t kStepsOfCandidate = 10;  // a triple that is new in the turn
inline constexpr uint64_t kStepsOfFact = 60;       // a triple inserted into the graph or removed from it
inline constexpr uint64_t kStepsOfInstance = 120;  // a rule specialised to axioms

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_STEP_COSTS_H_
