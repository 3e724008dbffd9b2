// Runs SWI-Prolog and EYE as processes, on the same university data and the same ten rules.
#ifndef DOCENT_BENCH_RULES_PEERS_H_
#define DOCENT_BENCH_RULES_PEERS_H_

#include <cstddef>
#include <vector>

#include "bench/measurement.h"

namespace docent::bench {

// Without a value and with a reason if a peer is not installed or exceeds the time limit of the
// benchmark.
std::vector<Measurement> MeasureRulePeers(size_t facts);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_RULES_PEERS_H_
