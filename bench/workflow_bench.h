// `docent-bench workflow`: runs that wait, and nodes that are completed, durably.
#ifndef DOCENT_BENCH_WORKFLOW_BENCH_H_
#define DOCENT_BENCH_WORKFLOW_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// Exit code as in docent-bench. Starts `docent serve` (beside this program) on loopback with a durable log, and an adapter
// in this process that answers at once. Measures
//   waiting   the server's memory with 100,000 runs that wait for a fact each, and the time from a fact to the command of the
//             run that it frees
//   nodes     flows of ten nodes, each a command: nodes completed a second, and the time from the end of a node's command to
//             the command of the next node (hand-over)
int RunWorkflowBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_WORKFLOW_BENCH_H_
