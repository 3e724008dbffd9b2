// What one update costs with 100 … 100,000 standing constraints of a hard mix, and what it would cost to run
// again every constraint, or those whose predicates occur in the update (prepared once, by our own
// evaluator).
//
//   docent_constraints_bench [--json] [COUNT…]
//
// The mix: a third compare one shared predicate with a number of their own; a third join two patterns through
// a booth that many visitors pass; a sixth are negated; a sixth follow the bindings of a free variable. The
// world: 1,000 robots with a battery, 2,000 visitors, 500 booths in 50 areas. An update moves a visitor,
// changes a battery to a value not seen before, opens or closes a booth, or changes a wish: one fact out, one
// in.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "bench/measurement.h"
#include "kb_server/rdf/dictionary.h"
#include "kb_server/rdf/vocabulary.h"
#include "kb_server/sparql/evaluator.h"
#include "kb_server/sparql/parser.h"
#include "kb_server/store/graph_writer.h"
#include "reasoner/constraints/constraint_set.h"

namespace docent {
namespace {

constexpr int kRobots = 1000;
constexpr int kVisitors = 2000;
constexpr int kBooths = 500;
constexpr int kAreas = 50;
constexpr int kWarmUp = 200;
constexpr int kUpdates = 5000;

double Micros(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double, std::micro>(d).count();
}

std::string Ask(int i) {
  const int n = i / 6;
  switch (i % 6) {
    case 0:
    case 1:  // no two with the same number
      return absl::StrCat("ASK { ?r :battery ?b FILTER(?b < 0.", 100000 + i, ") }");
    case 2:  // someone in an area, through whatever booth
      return absl::StrCat("ASK { ?v :at ?booth . ?booth :reservedFor :group", n, " }");
    case 3:  // two that meet
      return absl::StrCat("ASK { :visitor", n % kVisitors, " :at ?booth . :robot", n % kRobots,
                          " :at ?booth . :robot", n % kRobots, " :serves :group", n, " }");
    case 4:
      return absl::StrCat("ASK { :visitor", n % kVisitors, " :wants :service", n,
                          " . FILTER NOT EXISTS { :robot", n % kRobots, " :closed ?why } }");
    default:
      return absl::StrCat("ASK { ?v :at ?booth . ?booth :show :show", n, " . FILTER(?v != :visitor0) }");
  }
}

class World {
 public:
  World() : writer_(std::make_shared<const GraphVersion>()), random_(11) {
    graph_ = dictionary_.InternIri(kDefaultGraph);
    std::vector<Quad> quads;
    for (int i = 0; i < kRobots; ++i) {
      batteries_.push_back(NewBattery());
      quads.push_back(QuadOf("robot", i, "battery", batteries_.back()));
      quads.push_back(QuadOf("robot", i, "at", Iri("booth", i % kBooths)));
    }
    for (int i = 0; i < kVisitors; ++i) {
      places_.push_back(i % kBooths);
      wishes_.push_back(i);
      quads.push_back(QuadOf("visitor", i, "at", Iri("booth", i % kBooths)));
      quads.push_back(QuadOf("visitor", i, "wants", Iri("service", i)));
    }
    for (int i = 0; i < kBooths; ++i) {
      quads.push_back(QuadOf("booth", i, "partOf", Iri("area", i % kAreas)));
      quads.push_back(QuadOf("booth", i, "show", Iri("show", i)));
      quads.push_back(QuadOf("booth", i, "reservedFor", Iri("group", i)));
    }
    writer_.Apply(quads, {});
  }

  // One fact out, one in.
  Delta Change() {
    const int kind = static_cast<int>(random_() % 4);
    if (kind == 0) {
      const int robot = Pick(kRobots);
      const TermId old_battery = std::exchange(batteries_[robot], NewBattery());
      return Replace("robot", robot, "battery", old_battery, batteries_[robot]);
    }
    const int visitor = Pick(kVisitors);
    if (kind == 3) {
      const int old_wish = std::exchange(wishes_[visitor], Pick(kVisitors));
      return Replace("visitor", visitor, "wants", Iri("service", old_wish), Iri("service", wishes_[visitor]));
    }
    const int old_place = std::exchange(places_[visitor], Pick(kBooths));
    return Replace("visitor", visitor, "at", Iri("booth", old_place), Iri("booth", places_[visitor]));
  }

  sparql::Query Parse(const std::string& text) const {
    sparql::ParseOptions options;
    options.prefixes = {{"", "http://example.org/"}};
    sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
    if (!parsed.ok()) {
      std::fprintf(stderr, "%s", Render(parsed.diagnostics, text).c_str());
      std::exit(1);
    }
    return std::move(parsed.query);
  }
  Dictionary& dictionary() { return dictionary_; }
  const GraphVersion& version() const { return writer_.current(); }

 private:
  int Pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  TermId Iri(const char* name, int n) {
    return dictionary_.InternIri(absl::StrCat("http://example.org/", name, n));
  }
  TermId NewBattery() {
    // Between 0.1 and 0.3: some thresholds lie below, most of what moves flips one or none.
    return dictionary_.Intern(
        Term::Literal(absl::StrCat("0.", 100001 + Pick(200000), 1 + Pick(9)), std::string(kXsdDecimal)));
  }
  Quad QuadOf(const char* name, int n, const char* predicate, TermId object) {
    return {Iri(name, n), dictionary_.InternIri(absl::StrCat("http://example.org/", predicate)), object,
            graph_};
  }
  Delta Replace(const char* name, int n, const char* predicate, TermId before, TermId after) {
    return writer_.Apply({QuadOf(name, n, predicate, after)}, {QuadOf(name, n, predicate, before)});
  }

  Dictionary dictionary_;
  GraphWriter writer_;
  std::mt19937 random_;
  TermId graph_;
  std::vector<TermId> batteries_;
  std::vector<int> places_;
  std::vector<int> wishes_;
};

struct Result {
  double register_us = 0;  // each
  double mean_us = 0, p50_us = 0, p99_us = 0;
  double candidates = 0, evaluations = 0, changes = 0;  // each update
  double all_us = 0, by_predicate_us = 0;
};

// Each distinct ASK prepared once; those that name the predicate of an update, and all of them.
void MeasureBaselines(int count, Result& result) {
  World world;
  struct Prepared {
    std::unique_ptr<sparql::PreparedQuery> query;
    std::set<TermId> predicates;
  };
  std::vector<Prepared> prepared;
  for (int i = 0; i < count; ++i) {
    const sparql::Query query = world.Parse(Ask(i));
    Prepared p;
    for (const sparql::PatternOccurrence& o : sparql::AllTriplePatterns(*query.algebra)) {
      p.predicates.insert(world.dictionary().Intern(o.pattern->predicate.term));
      world.dictionary().Intern(o.pattern->subject.IsVariable() ? o.pattern->predicate.term
                                                                : o.pattern->subject.term);
      world.dictionary().Intern(o.pattern->object.IsVariable() ? o.pattern->predicate.term
                                                               : o.pattern->object.term);
    }
    auto made = sparql::PreparedQuery::Prepare(query, world.dictionary());
    if (!made.ok()) std::exit(1);
    p.query = *std::move(made);
    prepared.push_back(std::move(p));
  }
  const int updates = std::clamp(200000 / count, 4, 200);
  double all = 0, some = 0;
  int held = 0;
  for (int u = 0; u < updates; ++u) {
    const Delta delta = world.Change();
    const sparql::RunOptions run{.version = &world.version()};
    auto start = std::chrono::steady_clock::now();
    for (Prepared& p : prepared) held += p.query->Ask(run).value_or(false);
    all += Micros(std::chrono::steady_clock::now() - start);
    start = std::chrono::steady_clock::now();
    for (Prepared& p : prepared) {
      bool touched = false;
      for (const Quad& q : delta.added) touched = touched || p.predicates.contains(q.predicate);
      for (const Quad& q : delta.removed) touched = touched || p.predicates.contains(q.predicate);
      if (touched) held += p.query->Ask(run).value_or(false);
    }
    some += Micros(std::chrono::steady_clock::now() - start);
  }
  if (held < 0) std::exit(1);
  result.all_us = all / updates;
  result.by_predicate_us = some / updates;
}

Result Measure(int count) {
  Result result;
  World world;
  ConstraintSet set(world.dictionary());
  std::vector<sparql::Query> queries;
  for (int i = 0; i < count; ++i) queries.push_back(world.Parse(Ask(i)));
  auto start = std::chrono::steady_clock::now();
  for (const sparql::Query& query : queries) {
    if (const auto id = set.Register(query, world.version()); !id.ok()) {
      std::fprintf(stderr, "%s\n", id.status().ToString().c_str());
      std::exit(1);
    }
  }
  set.Commit();
  result.register_us = Micros(std::chrono::steady_clock::now() - start) / count;
  std::vector<double> times;
  ConstraintSet::Counters before;
  for (int u = 0; u < kWarmUp + kUpdates; ++u) {
    if (u == kWarmUp) before = set.counters();
    const Delta delta = world.Change();
    start = std::chrono::steady_clock::now();
    const auto changes = set.Update(world.version(), delta);
    set.Commit();
    if (!changes.ok()) std::exit(1);
    if (u >= kWarmUp) times.push_back(Micros(std::chrono::steady_clock::now() - start));
  }
  for (const double t : times) result.mean_us += t / kUpdates;
  std::sort(times.begin(), times.end());
  result.p50_us = times[times.size() / 2];
  result.p99_us = times[times.size() * 99 / 100];
  result.candidates = static_cast<double>(set.counters().candidates - before.candidates) / kUpdates;
  result.evaluations = static_cast<double>(set.counters().evaluations - before.evaluations) / kUpdates;
  result.changes = static_cast<double>(set.counters().changes - before.changes) / kUpdates;
  MeasureBaselines(count, result);
  return result;
}

void Print(int count, const Result& r, bool json) {
  const std::string name = absl::StrCat(count, " constraints");
  const std::vector<bench::Measurement> lines = {
      {"constraints", name, "docent", "register one", "us", {r.register_us}, ""},
      {"constraints", name, "docent", "update, mean", "us", {r.mean_us}, ""},
      {"constraints", name, "docent", "update, p50", "us", {r.p50_us}, ""},
      {"constraints", name, "docent", "update, p99", "us", {r.p99_us}, ""},
      {"constraints", name, "docent", "candidates an update", "", {r.candidates}, ""},
      {"constraints", name, "docent", "evaluations an update", "", {r.evaluations}, ""},
      {"constraints", name, "docent", "changes an update", "", {r.changes}, ""},
      {"constraints", name, "run all again", "update, mean", "us", {r.all_us}, ""},
      {"constraints", name, "run by predicate", "update, mean", "us", {r.by_predicate_us}, ""},
  };
  if (json) {
    for (const bench::Measurement& line : lines) std::printf("%s\n", bench::ToJsonLine(line).c_str());
    return;
  }
  std::printf("%7d  %9.2f  %8.2f %8.2f %8.2f  %7.2f %7.2f %7.2f  %12.1f %7.0fx  %12.1f %7.0fx\n", count,
              r.register_us, r.mean_us, r.p50_us, r.p99_us, r.candidates, r.evaluations, r.changes, r.all_us,
              r.all_us / r.mean_us, r.by_predicate_us, r.by_predicate_us / r.mean_us);
  std::fflush(stdout);
}

}  // namespace
}  // namespace docent

int main(int argc, char** argv) {
  bool json = false;
  std::vector<int> counts;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--json") {
      json = true;
    } else if (const int count = std::atoi(argv[i]); count > 0) {
      counts.push_back(count);
    } else {
      std::fprintf(stderr, "usage: docent_constraints_bench [--json] [COUNT...]\n");
      return 2;
    }
  }
  if (counts.empty()) counts = {100, 1000, 10000, 100000};
  if (!json) {
    std::printf(
        "constrai-  register    update us                    an update                 run all again         "
        " by predicate\n"
        "    nts      us each      mean      p50      p99     cand.   eval. changes        us/update   ratio "
        "    us/update   ratio\n");
  }
  for (const int count : counts) docent::Print(count, docent::Measure(count), json);
  return 0;
}
