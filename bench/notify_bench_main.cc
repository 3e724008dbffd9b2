// `docent-bench notify` alone: needs no more of the tree than the server.
#include "bench/notify_bench.h"
#include "graph/base/program_setup.h"

int main(int argc, char** argv) {
  docent::SetMutexChecks();
  return docent::bench::RunNotifyBench({argv + 1, argv + argc});
}
