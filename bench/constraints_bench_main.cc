// `docent-bench constraints` alone: needs no more of the tree than the constraints.
#include "bench/constraints_bench.h"
#include "graph/base/program_setup.h"

int main(int argc, char** argv) {
  docent::SetMutexChecks();
  return docent::bench::RunConstraintsBench({argv + 1, argv + argc});
}
