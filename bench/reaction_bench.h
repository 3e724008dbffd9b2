// docent-bench reaction: from an Assert that was sent to the Invoke that it leads to at the adapter.
#ifndef DOCENT_BENCH_REACTION_BENCH_H_
#define DOCENT_BENCH_REACTION_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// Exit code as in docent-bench. Starts `docent serve` (beside this program) on loopback with a durable log in a folder of
// its own, 100,000 triples and 1,000 deployed workflows whose conditions wait; an adapter that answers at once.
int RunReactionBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_REACTION_BENCH_H_
