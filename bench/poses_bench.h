// `docent-bench poses`: memory under a stream of poses from a hundred robots; each position and time is a new
// value.
#ifndef DOCENT_BENCH_POSES_BENCH_H_
#define DOCENT_BENCH_POSES_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// Runs the benchmark with the arguments after its name. 0: measured, 1: a target is missed, 2: bad usage.
int RunPosesBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_POSES_BENCH_H_
