#include "bench/constraint_stage.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <set>
#include <string>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "bench/constraint_mix.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/batch_applier.h"
#include "reasoner/conditions/standing_conditions.h"

namespace docent::bench {
namespace {

using SteadyClock = std::chrono::steady_clock;

double MicrosSince(SteadyClock::time_point start) {
  return std::chrono::duration<double, std::micro>(SteadyClock::now() - start).count();
}

sparql::Query AskOf(size_t i) {
  sparql::ParsedQuery parsed = sparql::ParseQuery(absl::StrCat("ASK { ", ConstraintNumber(i).where, " }"));
  return std::move(parsed.query);
}

// A baseline: prepared queries and their levels; Update runs those that it is told to.
class Rerun {
 public:
  Rerun(size_t constraints, const Dictionary& dictionary, const GraphVersion& version) {
    for (size_t i = 0; i < constraints; ++i) {
      sparql::Query query = AskOf(i);
      for (const sparql::PatternOccurrence& occurrence : sparql::AllTriplePatterns(*query.algebra)) {
        std::optional<TermId> id = dictionary.Find(occurrence.pattern->predicate.term());
        if (id) by_predicate_[*id].insert(i);
      }
      asks_.push_back(*sparql::PreparedQuery::Prepare(query, dictionary));
      levels_.push_back(Evaluate(i, version));
      all_.insert(i);
    }
  }
  size_t UpdateAll(const GraphVersion& version) { return Run(all_, version); }
  size_t UpdateByPredicate(const GraphVersion& version, const Delta& delta) {
    std::set<size_t> affected;
    for (const std::vector<Quad>* quads : {&delta.added, &delta.removed}) {
      for (const Quad& quad : *quads) {
        auto it = by_predicate_.find(quad.predicate);
        if (it != by_predicate_.end()) affected.insert(it->second.begin(), it->second.end());
      }
    }
    return Run(affected, version);
  }

 private:
  bool Evaluate(size_t i, const GraphVersion& version) {
    sparql::RunOptions run;
    run.version = &version;
    return asks_[i]->Ask(run).value();
  }
  // The number of levels that changed.
  size_t Run(const std::set<size_t>& which, const GraphVersion& version) {
    size_t changes = 0;
    for (size_t i : which) {
      bool level = Evaluate(i, version);
      changes += level != levels_[i];
      levels_[i] = level;
    }
    return changes;
  }
  std::vector<std::unique_ptr<sparql::PreparedQuery>> asks_;
  std::vector<bool> levels_;
  std::set<size_t> all_;
  absl::flat_hash_map<TermId, std::set<size_t>> by_predicate_;
};

}  // namespace

bool MeasureConstraintStage(size_t triples, size_t constraints, std::vector<Measurement>* figures) {
  Dictionary dictionary;
  GraphWriter writer(std::make_shared<const GraphVersion>());
  BatchApplier applier(dictionary, Limits{});
  WriteBatch load;
  load.mode = WriteBatch::Mode::kLoad;
  for (const std::vector<TermQuad>& quads : {Background(triples, constraints), StateProperties()}) {
    for (const TermQuad& quad : quads) load.operations.push_back({QuadOperation::Kind::kAdd, quad});
  }
  if (!applier.Apply(load, writer).ok()) return false;
  applier.Commit();
  GraphVersionPtr start = writer.Freeze(Revision(1));

  StandingConditions set(dictionary);
  for (size_t i = 0; i < constraints; ++i) {
    if (!set.Register(AskOf(i), *start).ok()) return false;
  }
  set.Commit();
  Rerun all(constraints, dictionary, *start), by_predicate(constraints, dictionary, *start);

  // every update is taken back by the next one, so that each makes one constraint rise or fall
  constexpr int kUpdates = 2000, kAllUpdates = 40;
  std::vector<double> docent_us, all_us, predicate_us;
  size_t docent_changes = 0, predicate_changes = 0, all_changes = 0, all_expected = 0;
  double docent_sum = 0, all_sum = 0, predicate_sum = 0;
  WriteBatch update;
  update.source = "urn:mix:sensors";
  for (int n = 0; n < kUpdates; ++n) {
    bool retract = n % 2 == 1;
    TermQuad quad = UpdateNumber(static_cast<uint64_t>(n / 2), constraints, triples).add;
    update.operations = {
        {retract ? QuadOperation::Kind::kRemove : QuadOperation::Kind::kAdd, std::move(quad)}};
    auto delta = applier.Apply(update, writer);
    if (!delta.ok()) return false;
    applier.Commit();
    const GraphVersion& graph = writer.current();

    auto t = SteadyClock::now();
    auto changes = set.Update(graph, *delta);
    set.Commit();
    docent_sum += MicrosSince(t);
    if (!changes.ok()) return false;
    docent_changes += changes->size();

    t = SteadyClock::now();
    predicate_changes += by_predicate.UpdateByPredicate(graph, *delta);
    predicate_sum += MicrosSince(t);

    if (n < kAllUpdates) {
      all_expected += changes->size();
      t = SteadyClock::now();
      all_changes += all.UpdateAll(graph);
      all_sum += MicrosSince(t);
    }
  }
  docent_us.push_back(docent_sum / kUpdates);
  predicate_us.push_back(predicate_sum / kUpdates);
  all_us.push_back(all_sum / kAllUpdates);
  std::string name = absl::StrCat("constraint stage, ", constraints, " constraints");
  auto add = [&](const char* system, const char* metric, const char* unit, double value) {
    figures->push_back({"reaction", name, system, metric, unit, {value}, ""});
  };
  add("docent", "per update", "us", docent_us[0]);
  add("re-run every ASK", "per update", "us", all_us[0]);
  add("re-run by predicate", "per update", "us", predicate_us[0]);
  add("docent", "times faster than re-run every ASK", "x", all_us[0] / docent_us[0]);
  add("docent", "times faster than re-run by predicate", "x", predicate_us[0] / docent_us[0]);
  if (docent_changes == predicate_changes && all_changes == all_expected && docent_changes > 0) return true;
  std::fprintf(stderr, "docent-bench: the systems disagree: %zu, %zu, %zu of %zu changes\n", docent_changes,
               predicate_changes, all_changes, all_expected);
  return false;
}

}  // namespace docent::bench
