// The queries of `docent-bench kb`, and the job file for every measured system. One thread.
#ifndef DOCENT_BENCH_KB_KB_QUERIES_H_
#define DOCENT_BENCH_KB_KB_QUERIES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "bench/kb/kb_data.h"

namespace docent::bench {

// One query in one form. `@P@` in the text (as <http://bench.example/@P@> or "@P@") stands for a parameter;
// without parameters `parameters` is {""}.
struct KbCase {
  std::string name;  // "shop: friends of friends"
  std::string form;  // "rows", "count" (COUNT(*) of the same pattern) or "ask"
  std::string text;
  std::vector<std::string> parameters;
};

// `instances`: parameters for each case. They are drawn from 10,000 values, a tenth of which are not in the
// graph.
std::vector<KbCase> MakeKbCases(const KbCounts& counts, size_t instances, uint64_t seed);

// The job as JSON: data file, cases, the time budget of a case in milliseconds, and the maximum number of
// passes.
std::string ToJobJson(const std::string& data_file, const std::vector<KbCase>& cases, int budget_ms);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_KB_KB_QUERIES_H_
