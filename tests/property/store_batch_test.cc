// The batch applier against a naive model of a batch: random asserts, loads, removals, lifetimes, ticks,
// readings of a state, and rolled back turns.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <string>
#include <tuple>

#include "graph/rdf/vocabulary.h"
#include "graph/store/batch_applier.h"

namespace docent {
namespace {

using Fact =
    std::tuple<std::string, std::string, std::string, std::string>;  // subject predicate object graph
using Facts = std::map<Fact, TimeMicros>;  // → when its lifetime ends; 0: it stays

std::string E(const char* kind, uint64_t n) {
  return std::string("http://e/") + kind + std::to_string(n);
}

// Literal implementation of the documented behaviour, without an index.
struct Model {
  Facts facts;

  bool IsState(const std::string& property) const {
    for (const auto& [fact, end] : facts) {
      if (std::get<0>(fact) == property && std::get<1>(fact) == kRdfType &&
          std::get<2>(fact) == DocentIri("StateProperty")) {
        return true;
      }
    }
    return false;
  }

  void Apply(const WriteBatch& batch) {
    std::erase_if(facts, [&](const auto& f) { return f.second != 0 && f.second <= batch.time_us; });
    std::set<std::string> state;
    for (uint64_t p = 0; p < 4; ++p) {
      if (state_before.contains(E("p", p))) state.insert(E("p", p));
    }
    for (const QuadOperation& operation : batch.operations) {
      const TermQuad& q = operation.quad;
      std::string graph = !q.graph.lexical.empty() ? q.graph.lexical
                          : batch.source.empty()   ? std::string(kDefaultGraph)
                                                   : batch.source;
      Fact fact{q.subject.lexical, q.predicate.lexical, q.object.lexical, graph};
      if (operation.kind == QuadOperation::Kind::kRemove) {
        facts.erase(fact);
        continue;
      }
      bool asserts = batch.mode == WriteBatch::Mode::kAssert;
      if (asserts && state.contains(q.predicate.lexical)) {
        std::erase_if(facts, [&](const auto& f) {
          return std::get<0>(f.first) == q.subject.lexical && std::get<1>(f.first) == q.predicate.lexical &&
                 std::get<3>(f.first) == graph && f.first != fact;
        });
      }
      facts[fact] = asserts && batch.lifetime_ms > 0
                        ? batch.time_us + static_cast<TimeMicros>(batch.lifetime_ms) * 1000
                        : 0;
    }
  }

  std::set<std::string> state_before;  // state properties when the batch came
};

class StoreBatchProperty : public testing::TestWithParam<uint64_t> {};

TEST_P(StoreBatchProperty, EqualsTheModel) {
  SCOPED_TRACE(testing::Message() << "seed " << GetParam());
  std::mt19937_64 random(GetParam());
  Dictionary dictionary;
  BatchApplier applier(dictionary, Limits());
  GraphWriter writer(nullptr);
  Model model;
  TimeMicros now_us = 1;

  auto random_batch = [&] {
    WriteBatch batch;
    now_us += static_cast<TimeMicros>(random() % 300) * 1000;
    batch.time_us = now_us;
    if (random() % 8 == 0) return batch;  // a tick
    batch.mode = random() % 4 == 0 ? WriteBatch::Mode::kLoad : WriteBatch::Mode::kAssert;
    batch.lifetime_ms = random() % 3 == 0 ? random() % 1000 : 0;
    if (random() % 2 == 0) batch.source = E("g", random() % 3);
    for (uint64_t i = random() % 8; i > 0; --i) {
      QuadOperation operation;
      operation.kind = random() % 4 == 0 ? QuadOperation::Kind::kRemove : QuadOperation::Kind::kAdd;
      operation.quad = {Term::Iri(E("s", random() % 3)), Term::Iri(E("p", random() % 4)),
                        Term::Iri(E("o", random() % 4)), Term()};
      if (random() % 6 == 0) {
        operation.quad.subject = Term::Iri(E("p", random() % 4));
        operation.quad.predicate = Term::Iri(std::string(kRdfType));
        operation.quad.object = Term::Iri(DocentIri("StateProperty"));
      }
      if (random() % 4 == 0) operation.quad.graph = Term::Iri(E("g", random() % 3));
      batch.operations.push_back(std::move(operation));
    }
    return batch;
  };
  auto graph = [&] {
    std::set<Fact> facts;
    writer.current().ForEach({}, [&](const Quad& quad) {
      auto text = [&](TermId id) { return std::string(dictionary.Lexical(id)); };
      return facts.insert({text(quad.subject), text(quad.predicate), text(quad.object), text(quad.graph)})
          .second;
    });
    return facts;
  };

  for (int turn = 0; turn < 300; ++turn) {
    Model before = model;
    std::set<Fact> graph_before = graph();
    WriteBatch batch = random_batch();
    model.state_before.clear();
    for (uint64_t p = 0; p < 4; ++p) {
      if (model.IsState(E("p", p))) model.state_before.insert(E("p", p));
    }
    model.Apply(batch);
    absl::StatusOr<Delta> delta = applier.Apply(batch, writer);
    ASSERT_TRUE(delta.ok()) << delta.status();
    std::set<Fact> expected;
    for (const auto& [fact, end] : model.facts) expected.insert(fact);
    ASSERT_EQ(graph(), expected) << "turn " << turn;
    // The delta is the difference, without repeats.
    size_t added = 0, removed = 0;
    for (const Fact& fact : expected) added += graph_before.contains(fact) ? 0 : 1;
    for (const Fact& fact : graph_before) removed += expected.contains(fact) ? 0 : 1;
    ASSERT_EQ(delta->added.size(), added) << "turn " << turn;
    ASSERT_EQ(delta->removed.size(), removed) << "turn " << turn;
    for (const Quad& quad : delta->added) ASSERT_TRUE(writer.current().Contains(quad));
    for (const Quad& quad : delta->removed) ASSERT_FALSE(writer.current().Contains(quad));

    if (random() % 4 == 0) {
      applier.Rollback();
      writer.Rollback();
      model = before;
      ASSERT_EQ(graph(), graph_before);
    } else {
      applier.Commit();
      writer.Freeze(Revision(static_cast<uint64_t>(turn) + 1));
    }
    TimeMicros next_us = 0;
    for (const auto& [fact, end] : model.facts) {
      if (end != 0 && (next_us == 0 || end < next_us)) next_us = end;
    }
    ASSERT_EQ(applier.NextDeadline().value_or(0), next_us) << "turn " << turn;
    if (turn % 50 == 0) writer.current().CheckInvariants();
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, StoreBatchProperty, testing::Range<uint64_t>(1, 21));

}  // namespace
}  // namespace docent
