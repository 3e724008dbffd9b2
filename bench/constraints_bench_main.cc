// `docent-bench constraints` alone: needs no more of the tree than the constraints.
#include "bench/constraints_bench.h"

int main(int argc, char** argv) {
  return docent::bench::RunConstraintsBench({argv + 1, argv + argc});
}
