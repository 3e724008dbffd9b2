#include "bench/kb_bench.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "bench/command_line.h"
#include "bench/kb/kb_data.h"
#include "bench/kb/kb_queries.h"
#include "bench/kb/kb_systems.h"
#include "bench/measurement.h"

namespace docent::bench {
namespace {

struct Arguments {
  bool json = false;
  std::vector<size_t> triples = {100000, 1000000};
  size_t instances = 30;
  int budget_ms = 120;
  int timeout_s = 300;
  uint64_t seed = 1;
  std::vector<std::string> only;
  std::string scripts = "bench/kb/peers";
  std::string npm = "build/kb_peers";
};

// Measurements on one graph.
struct Round {
  size_t triples = 0;
  std::vector<KbCase> cases;
  std::vector<KbSystem> systems;
  std::vector<KbRun> runs;  // of each system

  const KbAnswer* Find(size_t system, size_t number, const std::string& mode = "cold") const {
    const auto it = runs[system].answers.find({number, mode});
    return it == runs[system].answers.end() ? nullptr : &it->second;
  }
};

std::string Short(size_t triples) {
  return triples % 1000000 == 0 ? absl::StrCat(triples / 1000000, "M") : absl::StrCat(triples / 1000, "k");
}

// Docent's and the peer's latency over the instances that both ran; nullopt if one has none.
std::optional<std::pair<double, double>> Pair(const Round& round, size_t peer, size_t number) {
  const KbAnswer* ours = round.Find(0, number);
  const KbAnswer* theirs = round.Find(peer, number);
  if (ours == nullptr || theirs == nullptr || ours->us.empty() || theirs->us.empty()) return std::nullopt;
  const size_t both = std::min(ours->us[0].size(), theirs->us[0].size());
  return std::pair(Median(ours->Means(both)), Median(theirs->Means(both)));
}

struct Comparison {
  double geometric_mean = 0;
  double worst = 0;  // peer / docent of the case that is worst for docent
  std::string worst_case;
  int cases = 0;
};

Comparison Compare(const Round& round, size_t peer, const std::string& form) {
  Comparison c;
  double logs = 0;
  for (size_t i = 0; i < round.cases.size(); ++i) {
    const auto pair = Pair(round, peer, i);
    // an ASK has no rows: it counts with the rows
    const std::string& kind = round.cases[i].form == "ask" ? "rows" : round.cases[i].form;
    if (kind != form || !pair) continue;
    const double ratio = pair->second / pair->first;
    logs += std::log(ratio);
    if (c.cases++ == 0 || ratio < c.worst) {
      c.worst = ratio;
      c.worst_case = round.cases[i].name;
    }
  }
  if (c.cases > 0) c.geometric_mean = std::exp(logs / c.cases);
  return c;
}

// Lists the cases in which a peer's answers differ from Docent's; returns their number for Oxigraph.
int CheckAnswers(const Round& round) {
  int wrong = 0;
  for (size_t s = 1; s < round.systems.size(); ++s) {
    for (size_t i = 0; i < round.cases.size(); ++i) {
      const KbAnswer* ours = round.Find(0, i);
      const KbAnswer* theirs = round.Find(s, i);
      if (ours == nullptr || theirs == nullptr) continue;
      for (size_t k = 0; k < std::min(ours->answers.size(), theirs->answers.size()); ++k) {
        if (ours->answers[k] == theirs->answers[k]) continue;
        std::fprintf(stderr, "answers differ: %s (%s) '%s': docent %lld, %s %lld\n",
                     round.cases[i].name.c_str(), round.cases[i].form.c_str(),
                     round.cases[i].parameters[k].c_str(), static_cast<long long>(ours->answers[k]),
                     round.systems[s].name.c_str(), static_cast<long long>(theirs->answers[k]));
        wrong += round.systems[s].name.starts_with("Oxigraph") ? 1 : 0;
        break;
      }
    }
  }
  return wrong;
}

void AddFigures(const Round& round, std::vector<Measurement>* figures) {
  const std::string size = Short(round.triples);
  const double triples = static_cast<double>(round.triples);
  for (size_t s = 0; s < round.systems.size(); ++s) {
    const std::string& name = round.systems[s].name;
    const KbRun& run = round.runs[s];
    const auto add = [&](const std::string& what, const std::string& metric, const std::string& unit,
                         std::vector<double> values, const std::string& reason) {
      figures->push_back(
          {"kb", absl::StrCat(size, " ", what), name, metric, unit, std::move(values), reason});
    };
    if (!run.reason.empty()) {
      add("load", "rate", "triples/s", {}, run.reason);
      continue;
    }
    add("load", "rate", "triples/s", {triples / run.load_s}, "");
    add("load", "resident memory", "B/triple", {run.bytes / triples}, "");
    if (s == 0) {
      add("load", "index", "B/triple", {run.index_bytes / triples}, "");
      add("load", "dictionary", "B/triple", {run.dictionary_bytes / triples}, "");
    }
    for (size_t i = 0; i < round.cases.size(); ++i) {
      const KbCase& c = round.cases[i];
      for (const std::string mode : {"cold", "prepared"}) {
        const KbAnswer* answer = round.Find(s, i, mode);
        if (answer == nullptr && mode == "prepared") continue;
        const bool measured = answer != nullptr && !answer->us.empty();
        add(absl::StrCat(c.name, ", ", c.form), absl::StrCat("latency, ", mode), "us",
            measured ? answer->Means(answer->us[0].size()) : std::vector<double>{},
            measured            ? ""
            : answer != nullptr ? answer->reason
                                : "over the time of the whole run");
      }
    }
    if (s == 0) continue;
    for (const std::string form : {"rows", "count"}) {
      const Comparison c = Compare(round, s, form);
      if (c.cases == 0) continue;
      add(absl::StrCat("all, ", form),
          absl::StrCat("latency as a multiple of docent's, geometric mean of ", c.cases), "x",
          {c.geometric_mean}, "");
      add(absl::StrCat("all, ", form), absl::StrCat("the least of them (", c.worst_case, ")"), "x", {c.worst},
          "");
    }
  }
}

std::string Cell(const KbAnswer* answer) {
  if (answer == nullptr || answer->us.empty()) return "-";
  return absl::StrFormat("%.1f", Median(answer->Means(answer->us[0].size())));
}

void PrintTable(const Round& round) {
  std::printf("%zu triples\n%-46s %9s", round.triples, "us, cold but for 'prepared'", "prepared");
  for (const KbSystem& s : round.systems) std::printf(" %21s", s.name.c_str());
  std::printf("\n");
  for (size_t i = 0; i < round.cases.size(); ++i) {
    std::printf("%-46s %9s", absl::StrCat(round.cases[i].name, ", ", round.cases[i].form).c_str(),
                Cell(round.Find(0, i, "prepared")).c_str());
    for (size_t s = 0; s < round.systems.size(); ++s) std::printf(" %21s", Cell(round.Find(s, i)).c_str());
    std::printf("\n");
  }
  std::vector<Measurement> figures;
  AddFigures(round, &figures);
  std::erase_if(figures, [](const Measurement& m) { return m.metric.starts_with("latency, "); });
  std::printf("\n%s\n", ToTable(figures).c_str());
}

// Docent and the requested peers; empty if a name is unknown.
std::vector<KbSystem> Wanted(const Arguments& arguments) {
  const std::string programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::vector<KbSystem> all = KbSystems(programs, arguments.scripts, arguments.npm);
  if (arguments.only.empty()) return all;
  std::vector<KbSystem> wanted = {all[0]};
  for (const std::string& name : arguments.only) {
    const auto named = std::find_if(all.begin() + 1, all.end(), [&](const KbSystem& system) {
      return absl::StartsWithIgnoreCase(system.name, name);
    });
    if (named == all.end()) {
      const auto say = [](std::string* out, const KbSystem& system) { out->append(system.name); };
      std::fprintf(stderr, "docent-bench: --only %s begins the name of no peer; they are %s\n", name.c_str(),
                   absl::StrJoin(all.begin() + 1, all.end(), ", ", say).c_str());
      return {};
    }
    wanted.push_back(*named);
  }
  return wanted;
}

int Measure(const Arguments& arguments, const std::vector<KbSystem>& systems, size_t triples, Round* round) {
  const std::string folder = std::filesystem::temp_directory_path() / absl::StrCat("docent-kb-", getpid());
  std::filesystem::create_directories(folder);
  const absl::StatusOr<KbCounts> counts = WriteKbData(folder + "/data.nt", triples, arguments.seed);
  if (!counts.ok()) {
    std::fprintf(stderr, "docent-bench: %s\n", std::string(counts.status().message()).c_str());
    return 2;
  }
  round->triples = counts->triples;
  round->cases = MakeKbCases(*counts, arguments.instances, arguments.seed);
  std::ofstream(folder + "/job.json") << ToJobJson(folder + "/data.nt", round->cases, arguments.budget_ms);
  round->systems = systems;
  std::vector<std::unique_ptr<KbProcess>> processes;
  for (const KbSystem& system : systems) {
    std::fprintf(stderr, "%s: loading %zu triples ...\n", system.name.c_str(), round->triples);
    processes.push_back(std::make_unique<KbProcess>(system, folder + "/job.json", arguments.timeout_s));
  }
  for (size_t number = 0; number < round->cases.size(); ++number) {
    std::fprintf(stderr, "case %zu of %zu: %s, %s ...\n", number + 1, round->cases.size(),
                 round->cases[number].name.c_str(), round->cases[number].form.c_str());
    for (const auto& process : processes) process->Measure(number, "cold");
    processes[0]->Measure(number, "prepared");
  }
  for (const auto& process : processes) round->runs.push_back(process->run());
  std::filesystem::remove_all(folder);
  return 0;
}

}  // namespace

int RunKbBench(const std::vector<std::string>& args) {
  CLI::App app{"Loading, memory and query latency beside Oxigraph npm (WASM) and librdf + Rasqal",
               "docent-bench kb"};
  Arguments arguments;
  app.add_flag("--json", arguments.json, "One JSON object a line");
  app.add_option("--triples", arguments.triples, "Sizes of the graph")->capture_default_str()->delimiter(',');
  app.add_option("--instances", arguments.instances, "Parameters drawn for each query")
      ->capture_default_str();
  app.add_option("--budget-ms", arguments.budget_ms,
                 "Time that a system may take for a query, over all its instances")
      ->capture_default_str();
  app.add_option("--timeout-s", arguments.timeout_s, "Time that a system may take in all, its turns together")
      ->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of data and parameters")->capture_default_str();
  app.add_option("--only", arguments.only, "Names of peers, e.g. oxigraph,librdf; default: all")
      ->delimiter(',');
  app.add_option("--scripts", arguments.scripts, "Folder of the peers' scripts")->capture_default_str();
  app.add_option("--npm", arguments.npm, "Folder with node_modules/oxigraph")->capture_default_str();
  if (std::optional<int> code = Parse(&app, args)) return *code;
  const std::vector<KbSystem> systems = Wanted(arguments);
  if (systems.empty()) return 2;
  int code = 0;
  for (const size_t triples : arguments.triples) {
    Round round;
    if (const int failed = Measure(arguments, systems, triples, &round); failed != 0) return failed;
    if (CheckAnswers(round) > 0) code = 1;
    if (!arguments.json) {
      PrintTable(round);
      continue;
    }
    std::vector<Measurement> figures;
    AddFigures(round, &figures);
    Print(figures, true);
  }
  return code;
}

}  // namespace docent::bench
