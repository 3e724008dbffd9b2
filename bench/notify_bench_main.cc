// `docent-bench notify` alone: needs no more of the tree than the server.
#include "bench/notify_bench.h"

int main(int argc, char** argv) {
  return docent::bench::RunNotifyBench({argv + 1, argv + argc});
}
