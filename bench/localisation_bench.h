// `docent-bench localisation`: error of the localiser and cost of an update, and the same for MRPT's own
// filters in the same run. Also makes the reference of scenario s02.
#ifndef DOCENT_BENCH_LOCALISATION_BENCH_H_
#define DOCENT_BENCH_LOCALISATION_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// `args` without the program's and the benchmark's name; --help lists them.
// Exit code: 0; 1 a target is missed (RMSE of s01 above 22 mm or 0.3 degrees); 2 bad usage or input.
int RunLocalisationBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_LOCALISATION_BENCH_H_
