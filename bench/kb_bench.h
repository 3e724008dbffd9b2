// `docent-bench kb`: loading, memory and query latency of the store and SPARQL engine, compared with
// Oxigraph's npm build (WASM) and stock librdf trees with Rasqal. Each system is a process of its own
// with the same data file and the same queries (see kb_docent_main.cc for its output), one after the
// other.
#ifndef DOCENT_BENCH_KB_BENCH_H_
#define DOCENT_BENCH_KB_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

int RunKbBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_KB_BENCH_H_
