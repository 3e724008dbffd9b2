// `docent-bench load`: loads a file of N-Triples into a running server, as `docent load` does: checked, sent
// in parts, parsed, applied, durable.
#ifndef DOCENT_BENCH_LOAD_BENCH_H_
#define DOCENT_BENCH_LOAD_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// Runs the benchmark with the arguments after its name. 0: measured, 1: a target is missed, 2: bad usage.
int RunLoadBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_LOAD_BENCH_H_
