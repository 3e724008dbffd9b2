// `docent-bench rules` alone: needs no more of the tree than the rules.
#include "bench/rules_bench.h"
#include "graph/base/program_setup.h"

int main(int argc, char** argv) {
  docent::SetMutexChecks();
  return docent::bench::RunRulesBench({argv + 1, argv + argc});
}
