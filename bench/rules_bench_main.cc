// `docent-bench rules` alone: needs no more of the tree than the rules.
#include "bench/rules_bench.h"

int main(int argc, char** argv) {
  return docent::bench::RunRulesBench({argv + 1, argv + argc});
}
