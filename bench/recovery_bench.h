// `docent-bench recovery`: duration of a start after a crash, from a snapshot and the log after it.
#ifndef DOCENT_BENCH_RECOVERY_BENCH_H_
#define DOCENT_BENCH_RECOVERY_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// Exit code: 0 measured, 1 the target is missed, 2 bad usage or an error.
int RunRecoveryBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_RECOVERY_BENCH_H_
