// CLIPS on the joins, negations and free variables of the constraints' mix. Runs it as a process.
#ifndef DOCENT_BENCH_CONSTRAINTS_PEERS_H_
#define DOCENT_BENCH_CONSTRAINTS_PEERS_H_

#include <cstddef>
#include <string>
#include <vector>

#include "bench/measurement.h"
#include "bench/worlds/constraint_world.h"

namespace docent::bench {

// Name of the figures, also for Docent's updates: the mean of all shapes, and one shape.
inline constexpr char kPairsNet[] = "pair net, join, negated, free variable";
std::string PairNetOf(ConstraintShape shape);

// Mean cost of an update in microseconds, net of the same loop over facts without rules. Without a value and
// with a reason if CLIPS is not installed or takes too long.
std::vector<Measurement> MeasureConstraintPeers(size_t constraints);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_CONSTRAINTS_PEERS_H_
