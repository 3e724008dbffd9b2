// SWI-Prolog and EYE on the same university data and the same ten rules. Runs them as processes.
#ifndef DOCENT_BENCH_RULES_PEERS_H_
#define DOCENT_BENCH_RULES_PEERS_H_

#include <cstddef>
#include <vector>

#include "bench/measurement.h"

namespace docent::bench {

// Without a value and with the reason where a peer is not installed or takes longer than the benchmark gives
// it.
std::vector<Measurement> MeasureRulePeers(size_t facts);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_RULES_PEERS_H_
