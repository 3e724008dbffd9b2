// docent-bench NAME [OPTION…]: one benchmark; its options by `docent-bench NAME --help`.
#include <cstdio>
#include <string>
#include <vector>

#include "bench/constraints_bench.h"
#include "bench/kb_bench.h"
#include "bench/load_bench.h"
#include "bench/localisation_bench.h"
#include "bench/notify_bench.h"
#include "bench/poses_bench.h"
#include "bench/reaction_bench.h"
#include "bench/recovery_bench.h"
#include "bench/rules_bench.h"
#include "bench/workflow_bench.h"
#include "bench/writes_bench.h"
#include "graph/base/program_setup.h"

namespace {

struct Benchmark {
  const char* name;
  const char* what;
  int (*run)(const std::vector<std::string>& args);
};

constexpr Benchmark kBenchmarks[] = {
    {"reaction", "from Assert to Invoke, durable", docent::bench::RunReactionBench},
    {"workflow", "100,000 runs that wait, and nodes completed a second, durable",
     docent::bench::RunWorkflowBench},
    {"constraints", "an update with 100 to 100,000 conditions, beside asking again and CLIPS",
     docent::bench::RunConstraintsBench},
    {"notify", "from Assert to the notification of the one subscription of thousands that changes",
     docent::bench::RunNotifyBench},
    {"kb", "loading, memory and SPARQL latency beside Oxigraph npm (WASM) and librdf + Rasqal",
     docent::bench::RunKbBench},
    {"recovery", "a start from a snapshot and the log after it", docent::bench::RunRecoveryBench},
    {"load", "a file of N-Triples into a running server", docent::bench::RunLoadBench},
    {"poses", "memory under a stream of poses", docent::bench::RunPosesBench},
    {"writes", "versions and durable facts a second, and a query's latency beside them",
     docent::bench::RunWritesBench},
    {"rules", "closure, facts and axioms in and out, beside SWI-Prolog and EYE",
     docent::bench::RunRulesBench},
    {"localisation", "error and cost of the localiser beside MRPT's own filters",
     docent::bench::RunLocalisationBench},
};

void PrintUsage(FILE* to) {
  std::fprintf(to, "usage: docent-bench NAME [--json] [--help] [OPTION...]\n");
  for (const Benchmark& benchmark : kBenchmarks)
    std::fprintf(to, "  %-14s %s\n", benchmark.name, benchmark.what);
  std::fprintf(to, "exit code: 0 measured, 1 a target is missed, 2 bad usage or input\n");
}

}  // namespace

int main(int argc, char** argv) {
  docent::SetMutexChecks();
  const std::vector<std::string> args(argv + 1, argv + argc);
  if (!args.empty() && (args[0] == "--help" || args[0] == "-h")) {
    PrintUsage(stdout);
    return 0;
  }
  for (const Benchmark& benchmark : kBenchmarks) {
    if (!args.empty() && args[0] == benchmark.name) return benchmark.run({args.begin() + 1, args.end()});
  }
  if (!args.empty()) std::fprintf(stderr, "docent-bench: there is no benchmark '%s'\n", args[0].c_str());
  PrintUsage(stderr);
  return 2;
}
