// `docent-bench reaction`: time from sending an Assert to the resulting Invoke at the adapter.
#ifndef DOCENT_BENCH_REACTION_BENCH_H_
#define DOCENT_BENCH_REACTION_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// Exit code as in docent-bench. Starts `docent serve` (beside this program) on loopback with a durable log in
// a folder of its own, 100,000 triples, 1,000 deployed workflows with waiting conditions, and an adapter that
// answers at once.
int RunReactionBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_REACTION_BENCH_H_
