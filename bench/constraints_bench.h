// `docent-bench constraints`: cost of one update with 100 to 100,000 standing constraints, compared with
// evaluating them again and with CLIPS.
#ifndef DOCENT_BENCH_CONSTRAINTS_BENCH_H_
#define DOCENT_BENCH_CONSTRAINTS_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// Exit code: 0 measured, 1 a target is missed, 2 bad usage.
int RunConstraintsBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_CONSTRAINTS_BENCH_H_
