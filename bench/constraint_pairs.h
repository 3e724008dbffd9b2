// The updates that CLIPS is asked for, on Docent, measured in the same way (constraints_peers.h): of one shape after the
// other, a fact that makes a constraint drawn by lot begin or cease to hold is asserted and retracted; net of the same
// loop over a predicate that no constraint looks at. The two loops take turns, a few milliseconds each, and the median
// of their differences counts: what disturbs the machine meanwhile is in both or in few.
#ifndef DOCENT_BENCH_CONSTRAINT_PAIRS_H_
#define DOCENT_BENCH_CONSTRAINT_PAIRS_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "bench/worlds/constraint_world.h"

namespace docent::bench {

inline constexpr int kPairBlocks = 127;  // and one before them to warm up
inline constexpr int kPairsInBlock = 2000;
// What part of the mix without thresholds a shape is.
inline constexpr std::array<double, kConstraintShapes> kPartOfPairs = {0, 0.5, 0.25, 0.25};

// Net cost of an update in microseconds, by shape; 0 for thresholds. Ends the program where an update does not change
// exactly one constraint, or none in the other loop.
std::array<double, kConstraintShapes> MeasurePairs(size_t constraints, uint32_t seed);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_CONSTRAINT_PAIRS_H_
