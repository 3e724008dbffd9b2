// `docent-bench writes`: one-fact versions a second in memory; durable facts a second and their latency from
// many clients in process; and the effect of half that load on the latency of a query.
#ifndef DOCENT_BENCH_WRITES_BENCH_H_
#define DOCENT_BENCH_WRITES_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// Runs the benchmark with the arguments after its name. 0: measured, 1: a target is missed, 2: bad usage.
int RunWritesBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_WRITES_BENCH_H_
