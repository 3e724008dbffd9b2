// Docent's side of the comparison with CLIPS, measured in the same way (constraints_peers.h). One shape after
// the other, a fact that starts or ends a random constraint is asserted and retracted. The cost of the same
// loop over a predicate without constraints is subtracted. The two loops alternate every few milliseconds,
// and the median of their differences counts: a disturbance of the machine is in both loops or in few
// differences.
#ifndef DOCENT_BENCH_CONSTRAINT_PAIRS_H_
#define DOCENT_BENCH_CONSTRAINT_PAIRS_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "bench/worlds/constraint_world.h"

namespace docent::bench {

inline constexpr int kPairBlocks = 127;  // measured, after one warm-up block
inline constexpr int kPairsInBlock = 2000;
// Share of each shape in the mix without thresholds.
inline constexpr std::array<double, kConstraintShapes> kPartOfPairs = {0, 0.5, 0.25, 0.25};

// Net cost of an update in microseconds, by shape; 0 for thresholds. Ends the program if an update does not
// change exactly one constraint, or changes one in the other loop.
std::array<double, kConstraintShapes> MeasurePairs(size_t constraints, uint32_t seed);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_CONSTRAINT_PAIRS_H_
