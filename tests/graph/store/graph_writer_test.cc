#include "graph/store/graph_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "graph/store/delta_sum.h"

namespace docent {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TermId Id(uint64_t n) {
  return TermId::Make(TermId::Tag::kIri, n);
}
Quad Q(uint64_t s, uint64_t p, uint64_t o, uint64_t g = 1) {
  return {Id(s), Id(p), Id(o), Id(g)};
}

TEST(GraphWriterTest, AddAndRemoveTellWhetherTheGraphChanged) {
  GraphWriter writer(nullptr);
  EXPECT_TRUE(writer.Add(Q(1, 2, 3)));
  EXPECT_FALSE(writer.Add(Q(1, 2, 3)));
  EXPECT_TRUE(writer.Add(Q(1, 2, 3, 2)));  // another graph, another quad
  EXPECT_TRUE(writer.Remove(Q(1, 2, 3)));
  EXPECT_FALSE(writer.Remove(Q(1, 2, 3)));
  EXPECT_EQ(writer.current().size(), 1u);
}

TEST(GraphWriterTest, ApplyGivesTheNetChange) {
  GraphWriter writer(nullptr);
  writer.Add(Q(1, 1, 1));
  Delta delta =
      writer.Apply({Q(1, 1, 1), Q(1, 1, 2), Q(1, 1, 3), Q(1, 1, 2)}, {Q(1, 1, 3), Q(1, 1, 1), Q(1, 1, 9)});
  EXPECT_THAT(delta.added, ElementsAre(Q(1, 1, 2)));
  EXPECT_THAT(delta.removed, ElementsAre(Q(1, 1, 1)));
}

TEST(GraphWriterTest, FrozenVersionsStayAsTheyAre) {
  GraphWriter writer(nullptr);
  writer.Add(Q(1, 1, 1));
  GraphVersionPtr one = writer.Freeze(Revision(1));
  writer.Add(Q(1, 1, 2));
  writer.Remove(Q(1, 1, 1));
  GraphVersionPtr two = writer.Freeze(Revision(2));
  writer.Add(Q(1, 1, 3));
  EXPECT_EQ(one->size(), 1u);
  EXPECT_TRUE(one->Contains(Q(1, 1, 1)));
  EXPECT_FALSE(two->Contains(Q(1, 1, 1)));
  EXPECT_TRUE(two->Contains(Q(1, 1, 2)));
  EXPECT_FALSE(two->Contains(Q(1, 1, 3)));
  EXPECT_EQ(two->revision(), Revision(2));
}

TEST(GraphWriterTest, RollbackGoesToTheLastFrozenVersion) {
  GraphWriter writer(nullptr);
  writer.Add(Q(1, 1, 1));
  GraphVersionPtr one = writer.Freeze(Revision(1));
  for (uint64_t i = 2; i < 1000; ++i) writer.Add(Q(1, 1, i));
  writer.Remove(Q(1, 1, 1));
  writer.Rollback();
  EXPECT_EQ(writer.current().size(), 1u);
  EXPECT_TRUE(writer.current().Contains(Q(1, 1, 1)));
  writer.Add(Q(1, 1, 5));
  GraphVersionPtr two = writer.Freeze(Revision(2));
  EXPECT_EQ(two->size(), 2u);
  EXPECT_EQ(one->size(), 1u);
}

// Random turns, one by one or many quads at a time, each committed, frozen or rolled back.
TEST(GraphWriterTest, RollbackGoesToTheLastCommit) {
  std::mt19937 random(11);
  GraphWriter writer(nullptr);
  std::set<Quad> expected;
  GraphVersionPtr frozen = writer.Freeze(Revision(1));
  std::set<Quad> of_frozen;
  for (uint64_t turn = 2; turn < 400; ++turn) {
    std::set<Quad> changed = expected;
    for (auto change = random() % 4; change > 0; --change) {
      std::vector<Quad> quads;
      for (auto count = random() % 3 == 0 ? 60u : random() % 3; count > 0; --count) {
        quads.push_back(Q(random() % 12, random() % 4, random() % 12));
      }
      switch (random() % 4) {
        case 0:
          writer.AddAll(quads);
          changed.insert(quads.begin(), quads.end());
          break;
        case 1:
          writer.RemoveAll(quads);
          for (const Quad& quad : quads) changed.erase(quad);
          break;
        case 2:
          for (const Quad& quad : quads) EXPECT_EQ(writer.Add(quad), changed.insert(quad).second);
          break;
        default:
          for (const Quad& quad : quads) EXPECT_EQ(writer.Remove(quad), changed.erase(quad) == 1);
      }
    }
    switch (random() % 4) {
      case 0:
        writer.Rollback();
        break;
      case 1:
        frozen = writer.Freeze(Revision(turn));
        of_frozen = expected = changed;
        break;
      default:
        writer.Commit();
        expected = changed;
    }
    writer.current().CheckInvariants();
    const auto quads_of = [](const GraphVersion& version) {
      std::set<Quad> quads;
      version.ForEach({}, [&quads](const Quad& quad) { return quads.insert(quad).second; });
      return quads;
    };
    ASSERT_EQ(quads_of(writer.current()), expected) << turn;
    ASSERT_EQ(quads_of(*frozen), of_frozen) << turn;
  }
}

TEST(GraphWriterTest, SeveralWritersFromOneVersion) {
  GraphWriter base(nullptr);
  for (uint64_t i = 0; i < 1000; ++i) base.Add(Q(i, 1, 1));
  GraphVersionPtr start = base.Freeze(Revision(1));
  GraphWriter a(start), b(start);
  a.Add(Q(5, 2, 2));
  b.Remove(Q(5, 1, 1));
  EXPECT_TRUE(a.current().Contains(Q(5, 1, 1)));
  EXPECT_FALSE(b.current().Contains(Q(5, 2, 2)));
  EXPECT_EQ(start->size(), 1000u);
}

TEST(GraphWriterTest, AddingManyAtOnceEqualsAddingEach) {
  std::mt19937_64 random(2);
  GraphWriter bulk(nullptr), one_by_one(nullptr);
  uint64_t revision = 0;
  std::vector<GraphVersionPtr> versions;
  for (size_t count : {20000u, 1u, 300u, 5000u, 0u, 3u, 9000u}) {
    std::vector<Quad> quads, expected;
    for (size_t i = 0; i < count; ++i) {
      quads.push_back(Q(random() % 500, random() % 9, random() % 900, random() % 3 + 1));
      if (i % 7 == 0) quads.push_back(quads[random() % quads.size()]);
    }
    for (const Quad& quad : quads) {
      if (one_by_one.Add(quad)) expected.push_back(quad);
    }
    EXPECT_EQ(bulk.AddAll(quads), expected) << count;
    bulk.current().CheckInvariants();
    ASSERT_EQ(bulk.current().size(), one_by_one.current().size());
    for (const Quad& quad : quads) ASSERT_TRUE(bulk.current().Contains(quad));
    if (count % 2 == 0) versions.push_back(bulk.Freeze(Revision(++revision)));
  }
  EXPECT_TRUE(bulk.Add(Q(1000, 1, 1)));
  bulk.current().CheckInvariants();
  for (const GraphVersionPtr& version : versions) version->CheckInvariants();
}

TEST(GraphWriterTest, AddingManyAtOnceCountsWhatOnlyTheEarlierVersionHolds) {
  GraphWriter writer(nullptr);
  std::vector<Quad> even, odd;
  for (uint64_t i = 0; i < 5000; ++i) (i % 2 == 0 ? even : odd).push_back(Q(i, 1, i));
  writer.AddAll(even);
  const GraphVersionPtr before = writer.Freeze(Revision(1));
  writer.AddAll(odd);  // into every leaf
  const GraphVersionPtr after = writer.Freeze(Revision(2));
  EXPECT_EQ(after->replaced_bytes() - before->replaced_bytes(), before->bytes());
}

// Few and many quads compared with the existing ones: one by one, and in the order of each index.
TEST(GraphWriterTest, AddAllAndRemoveAllEqualOneByOne) {
  std::mt19937_64 random(3);
  for (const size_t already : {0u, 100u, 20000u}) {
    for (const size_t count : {3u, 300u, 4000u}) {
      GraphWriter many(nullptr), one_by_one(nullptr);
      const auto quads = [&](size_t n) {
        std::vector<Quad> out;
        for (size_t i = 0; i < n; ++i)
          out.push_back(Q(random() % 500, random() % 9, random() % 70000, random() % 3 + 1));
        return out;
      };
      const std::vector<Quad> there = quads(already), more = quads(count);
      for (const Quad& quad : there) one_by_one.Add(quad);
      many.AddAll(there);
      many.Freeze(Revision(1));
      size_t added = 0, removed = 0;
      for (const Quad& quad : more) added += one_by_one.Add(quad) ? 1 : 0;
      EXPECT_EQ(many.AddAll(more).size(), added);
      many.current().CheckInvariants();
      std::vector<Quad> less(more.begin(), more.begin() + static_cast<std::ptrdiff_t>(more.size() / 2));
      less.push_back(Q(1, 1, 1));
      for (const Quad& quad : less) removed += one_by_one.Remove(quad) ? 1 : 0;
      EXPECT_EQ(many.RemoveAll(less), removed);
      many.current().CheckInvariants();
      ASSERT_EQ(many.current().size(), one_by_one.current().size());
      one_by_one.current().ForEach({}, [&](const Quad& quad) {
        EXPECT_TRUE(many.current().Contains(quad));
        return true;
      });
    }
  }
}

TEST(DeltaSumTest, WhatWasUndoneDidNotHappen) {
  DeltaSum sum;
  sum.Added(Q(1, 1, 3));
  sum.Added(Q(1, 1, 1));
  sum.Removed(Q(1, 1, 2));
  sum.Removed(Q(1, 1, 1));
  sum.Added(Q(1, 1, 2));
  sum.Add({{Q(1, 1, 1)}, {Q(1, 1, 4), Q(1, 1, 2)}});
  Delta net = sum.Net();
  EXPECT_THAT(net.added, ElementsAre(Q(1, 1, 3), Q(1, 1, 1)));
  EXPECT_THAT(net.removed, ElementsAre(Q(1, 1, 2), Q(1, 1, 4)));
}

TEST(DeltaSumTest, OneKindOfChangeKeepsItsOrder) {
  DeltaSum sum;
  EXPECT_TRUE(sum.Net().empty());
  sum.Removed(Q(9, 1, 1));
  sum.Removed(Q(2, 1, 1));
  EXPECT_THAT(sum.Net().removed, ElementsAre(Q(9, 1, 1), Q(2, 1, 1)));
  EXPECT_THAT(sum.Net().added, IsEmpty());
}

}  // namespace
}  // namespace docent
