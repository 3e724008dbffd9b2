#include "bench/constraints_bench.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "bench/command_line.h"
#include "bench/constraint_pairs.h"
#include "bench/constraints_peers.h"
#include "bench/measurement.h"
#include "bench/worlds/constraint_graph.h"
#include "bench/worlds/constraint_world.h"
#include "graph/sparql/run/evaluator.h"
#include "reasoner/conditions/standing_conditions.h"

namespace docent::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kWarmUp = 20000;
constexpr int kUpdates = 100000;
constexpr int kRuns = 3;

double Micros(Clock::duration d) {
  return std::chrono::duration<double, std::micro>(d).count();
}

// Cost of reading the clock twice, in microseconds.
double ClockCost() {
  std::vector<double> costs;
  for (int i = 0; i < 1001; ++i) {
    const Clock::time_point start = Clock::now();
    costs.push_back(Micros(Clock::now() - start));
  }
  return Median(costs);
}

// Updates of a graph whose terms have ids already.
struct Update {
  ConstraintShape shape;
  bool add;
  Quad quad;
  size_t constraint;
};

std::vector<Update> EncodedUpdates(size_t count, uint32_t seed, int updates, ConstraintGraph& graph) {
  ConditionUpdates source(count, seed);
  std::vector<Update> encoded;
  for (int i = 0; i < updates; ++i) {
    const ConditionUpdates::Update next = source.Next();
    encoded.push_back({next.shape, next.add, graph.Encode(next.fact), next.constraint});
  }
  return encoded;
}

struct Sum {
  double us = 0;
  int count = 0;
  double mean() const { return count == 0 ? 0 : us / count; }
};

class ConstraintsBench {
 public:
  ConstraintsBench(std::vector<size_t> counts, bool peers) : counts_(std::move(counts)), peers_(peers) {}

  int Run() {
    for (const size_t count : counts_) {
      name_ = absl::StrCat(count, " constraints");
      Figures figures;
      for (int run = 0; run < kRuns; ++run) Measure(count, static_cast<uint32_t>(run + 1), figures);
      Tell(count, figures);
      RunAgain(std::min<size_t>(count, 10000), count);
      if (peers_) Peers(count);
    }
    Flat();
    return missed_ ? 1 : 0;
  }

  std::vector<Measurement> measurements;

 private:
  struct Figures {
    std::vector<double> registered_s, mean, p50, p99, turn, store, evaluations;
    std::array<std::vector<double>, kConstraintShapes> shapes;
  };

  void Note(const std::string& system, const std::string& metric, const std::string& unit,
            std::vector<double> runs) {
    measurements.push_back({"constraints", name_, system, metric, unit, std::move(runs), ""});
  }
  void Require(bool met, const char* what) {
    if (!met) std::fprintf(stderr, "%s: missed: %s\n", name_.c_str(), what);
    missed_ = missed_ || !met;
  }

  // Matching only, each update timed on its own; without prefetching, whose cost would be outside the timed
  // part.
  void Measure(size_t count, uint32_t seed, Figures& figures) {
    ConstraintGraph graph(count);
    const std::vector<Update> updates = EncodedUpdates(count, seed, kWarmUp + kUpdates, graph);
    conditions::StandingConditions set(graph.dictionary());
    const ConstraintQueries queries = ParseConstraints(count);
    const Clock::time_point begin = Clock::now();
    const std::vector<conditions::ConditionId> ids = RegisterAll(queries, graph, set);
    figures.registered_s.push_back(Micros(Clock::now() - begin) / 1e6);
    const double clock_us = ClockCost();
    std::vector<double> times;
    std::array<Sum, kConstraintShapes> shapes;
    uint64_t evaluations = 0;
    for (int i = 0; i < kWarmUp + kUpdates; ++i) {
      const Update& update = updates[static_cast<size_t>(i)];
      if (i == kWarmUp) evaluations = set.counters().evaluations;
      const Delta delta = graph.Apply(update.add, update.quad);
      const Clock::time_point start = Clock::now();
      const auto changes = set.Update(graph.version(), delta);
      set.Commit();
      const double us = Micros(Clock::now() - start) - clock_us;
      graph.Freeze();
      if (!changes.ok() || changes->size() != 1 || (*changes)[0].id != ids[update.constraint]) {
        std::fprintf(stderr, "update %d flips %zu constraints, not constraint %zu alone\n", i,
                     changes.ok() ? changes->size() : 0, update.constraint);
        std::exit(1);
      }
      if (i < kWarmUp) continue;
      times.push_back(us);
      Sum& sum = shapes[static_cast<size_t>(update.shape)];
      sum.us += us;
      ++sum.count;
    }
    double total = 0;
    for (const double t : times) total += t;
    figures.mean.push_back(total / kUpdates);
    std::sort(times.begin(), times.end());
    figures.p50.push_back(times[times.size() / 2]);
    figures.p99.push_back(times[times.size() * 99 / 100]);
    figures.evaluations.push_back(static_cast<double>(set.counters().evaluations - evaluations) / kUpdates);
    for (size_t s = 0; s < shapes.size(); ++s) figures.shapes[s].push_back(shapes[s].mean());
    // All updates are done: a further round undoes them.
    std::vector<Update> back(updates.rbegin(), updates.rend());
    for (Update& update : back) update.add = !update.add;
    figures.turn.push_back(Turns(back, graph, &set));
    ConstraintGraph alone(count);
    figures.store.push_back(Turns(EncodedUpdates(count, seed, kWarmUp + kUpdates, alone), alone, nullptr));
  }

  // Turns from the fact to the immutable version, with or without the constraints; microseconds each.
  static double Turns(const std::vector<Update>& updates, ConstraintGraph& graph,
                      conditions::StandingConditions* set) {
    Clock::time_point start;
    for (size_t i = 0; i < updates.size(); ++i) {
      if (i == kWarmUp) start = Clock::now();
      const Delta delta = graph.Apply(updates[i].add, updates[i].quad);
      if (set != nullptr) {
        if (!set->Update(graph.version(), delta).ok()) std::exit(1);
        set->Commit();
      }
      graph.Freeze();
    }
    return Micros(Clock::now() - start) / kUpdates;
  }

  void Tell(size_t count, const Figures& f) {
    Note("docent", "registered", "s", f.registered_s);
    Note("docent", "update: matching, mean", "us", f.mean);
    for (int s = 0; s < kConstraintShapes; ++s) {
      Note("docent", absl::StrCat("update: matching, ", NameOf(static_cast<ConstraintShape>(s))), "us",
           f.shapes[static_cast<size_t>(s)]);
    }
    Note("docent", "update: matching, p50", "us", f.p50);
    Note("docent", "update: matching, p99", "us", f.p99);
    Note("docent", "evaluations an update", "", f.evaluations);
    Note("docent", "turn: store, matching, version", "us", f.turn);
    Note("docent", "turn: store and version alone", "us", f.store);
    turns_.push_back(Median(f.turn));
    Require(count != 100000 || Median(f.registered_s) < 1, "100,000 registered in under 1 s");
    Require(count != 10000 || Median(f.mean) < 0.5, "matching under 0.5 us at 10,000");
    Require(count != 100000 || Median(f.mean) < 1, "matching under 1 us at 100,000");
    Require(Median(f.turn) <= 1.5 * Median(f.store), "turn at most 1.5 times the store's own");
  }

  // Evaluates each constraint whose predicates occur in the update again; `asked` of them, scaled to `count`.
  void RunAgain(size_t asked, size_t count) {
    constexpr size_t kUpdatesAgain = 40;
    ConstraintGraph graph(count);
    struct Prepared {
      std::unique_ptr<sparql::PreparedQuery> query;
      std::set<TermId> predicates;
    };
    std::vector<Prepared> prepared;
    for (size_t i = 0; i < asked; ++i) {
      const sparql::Query query = ParseConstraint(StandingConstraintNumber(i).ask);
      Prepared p;
      for (const sparql::PatternOccurrence& o : sparql::AllTriplePatterns(*query.algebra)) {
        p.predicates.insert(graph.dictionary().Intern(o.pattern->predicate.term()));
        if (!o.pattern->object.IsVariable()) graph.dictionary().Intern(o.pattern->object.term());
      }
      auto made = sparql::PreparedQuery::Prepare(query, graph.dictionary());
      if (!made.ok()) std::exit(1);
      p.query = *std::move(made);
      prepared.push_back(std::move(p));
    }
    Clock::duration took{};
    for (const Update& update : EncodedUpdates(count, 1, kUpdatesAgain, graph)) {
      graph.Apply(update.add, update.quad);
      const sparql::RunOptions run{.version = &graph.version()};
      const Clock::time_point start = Clock::now();
      for (Prepared& p : prepared) {
        if (p.predicates.contains(update.quad.predicate)) p.query->Ask(run).IgnoreError();
      }
      took += Clock::now() - start;
    }
    const double scale = static_cast<double>(count) / static_cast<double>(asked);
    Note("evaluated again by predicate", asked < count ? "update, scaled from 10,000" : "update", "us",
         {Micros(took) / kUpdatesAgain * scale});
  }

  // Docent and CLIPS in turn, in the same loops (constraint_pairs.h).
  void Peers(size_t count) {
    std::vector<double> mean;
    std::map<std::string, std::vector<double>> shapes;  // by metric
    std::vector<Measurement> theirs;
    for (int run = 0; run < kRuns; ++run) {
      const std::array<double, kConstraintShapes> net = MeasurePairs(count, static_cast<uint32_t>(run + 1));
      mean.push_back(0);
      for (size_t s = 0; s < net.size(); ++s) {
        mean.back() += kPartOfPairs[s] * net[s];
        shapes[PairNetOf(static_cast<ConstraintShape>(s))].push_back(net[s]);
      }
      for (Measurement& m : MeasureConstraintPeers(count)) {
        const auto same = std::find_if(theirs.begin(), theirs.end(),
                                       [&](const auto& known) { return known.metric == m.metric; });
        if (same == theirs.end()) {
          theirs.push_back(std::move(m));
        } else {
          same->runs.insert(same->runs.end(), m.runs.begin(), m.runs.end());
        }
      }
    }
    for (Measurement& m : theirs) {
      const bool whole = m.metric == kPairsNet;
      Note("docent", m.metric, "us", whole ? mean : shapes[m.metric]);
      Require(!whole || m.runs.empty() || Median(mean) <= Median(m.runs) / 2, "at most half of CLIPS");
      measurements.push_back(std::move(m));
    }
  }

  void Flat() {
    if (turns_.size() < 2) return;
    name_ = "all sizes";
    const double ratio =
        *std::max_element(turns_.begin(), turns_.end()) / *std::min_element(turns_.begin(), turns_.end());
    Note("docent", "turn, dearest against cheapest", "times", {ratio});
    Require(ratio <= 1.5, "flat within 1.5 times");
  }

  const std::vector<size_t> counts_;
  const bool peers_;
  std::string name_;
  std::vector<double> turns_;
  bool missed_ = false;
};

}  // namespace

int RunConstraintsBench(const std::vector<std::string>& args) {
  bool json = false, peers = true;
  std::vector<size_t> counts;
  CLI::App app{"An update beside standing constraints of a hard mix, asking again and CLIPS",
               "docent-bench constraints"};
  app.add_flag("--json", json, "One JSON object a line");
  app.add_flag("!--no-peers", peers, "Without CLIPS");
  app.add_option("COUNT", counts, "How many constraints")
      ->default_str("100 1000 10000 100000")
      ->check(CLI::Range(96, 10000000));
  if (std::optional<int> code = Parse(&app, args)) return *code;
  if (counts.empty()) counts = {100, 1000, 10000, 100000};
  ConstraintsBench bench(counts, peers);
  const int code = bench.Run();
  Print(bench.measurements, json);
  return code;
}

}  // namespace docent::bench
