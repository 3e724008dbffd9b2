#include "graph/store/graph_version.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <random>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "graph/store/graph_writer.h"

namespace docent {
namespace {

TermId Id(uint64_t n) {
  return TermId::Make(TermId::Tag::kIri, n);
}
Quad Q(uint64_t s, uint64_t p, uint64_t o, uint64_t g = 1) {
  return {Id(s), Id(p), Id(o), Id(g)};
}

std::vector<Quad> Found(const GraphVersion& version, const QuadPattern& pattern) {
  std::vector<Quad> found;
  version.ForEach(pattern, [&found](const Quad& quad) {
    found.push_back(quad);
    return true;
  });
  return found;
}

TEST(GraphVersionTest, EmptyGraph) {
  GraphVersion version;
  EXPECT_EQ(version.size(), 0u);
  EXPECT_EQ(version.revision(), Revision(0));
  EXPECT_FALSE(version.Scan({}).Valid());
  EXPECT_EQ(version.Count({}), 0u);
  EXPECT_TRUE(version.graphs().empty());
  EXPECT_FALSE(version.Contains(Q(1, 2, 3)));
}

// Every combination of bound positions against a plain list, with exact counts where promised.
TEST(GraphVersionTest, EveryPatternFindsWhatItMatches) {
  std::mt19937_64 random(5);
  std::set<Quad> model;
  GraphWriter writer(nullptr);
  for (int i = 0; i < 3000; ++i) {
    Quad quad = Q(random() % 20, random() % 6, random() % 25, random() % 4 + 1);
    EXPECT_EQ(writer.Add(quad), model.insert(quad).second);
  }
  const GraphVersion& version = writer.current();
  version.CheckInvariants();
  for (int mask = 0; mask < 16; ++mask) {
    for (int i = 0; i < 30; ++i) {
      Quad q = Q(random() % 20, random() % 6, random() % 25, random() % 5 + 1);
      QuadPattern pattern{(mask & 1) ? q.subject : TermId(), (mask & 2) ? q.predicate : TermId(),
                          (mask & 4) ? q.object : TermId(), (mask & 8) ? q.graph : TermId()};
      std::vector<Quad> expected;
      for (const Quad& quad : model) {
        if (pattern.Matches(quad)) expected.push_back(quad);
      }
      std::vector<Quad> found = Found(version, pattern);
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, expected) << "mask " << mask;
      bool exact = (mask & 8) == 0 || mask == 8 || mask == 9 || mask == 11 || mask == 15;
      ASSERT_EQ(version.ContainsMatch(pattern), !expected.empty()) << "mask " << mask;
      if (exact)
        ASSERT_EQ(version.Count(pattern), expected.size()) << "mask " << mask;
      else
        ASSERT_GE(version.Count(pattern), expected.size()) << "mask " << mask;
      std::set<std::array<TermId, 3>> triples;
      for (const Quad& quad : expected) triples.insert({quad.subject, quad.predicate, quad.object});
      // Only a graph with some but not all other words is in no order as one run.
      ASSERT_EQ(version.Scan(pattern).filters(), !exact) << "mask " << mask;
      if (exact) {
        ASSERT_EQ(version.Scan(pattern).CountRest(false), expected.size()) << "mask " << mask;
        ASSERT_EQ(version.Scan(pattern).CountRest(true), triples.size()) << "mask " << mask;
      }
      for (int order = 0; order < kIndexOrders; ++order) {
        size_t count = 0;
        for (QuadCursor c = version.ScanInOrder(pattern, IndexOrder(order)); c.Valid(); c.Next()) ++count;
        ASSERT_EQ(count, expected.size()) << "mask " << mask << " order " << order;
      }
    }
  }
}

class OddSubjects final : public HiddenTriples {
 public:
  bool MayHide(const QuadPattern& pattern) const override { return pattern.predicate != Id(0); }
  bool Hides(const Quad& quad) const override {
    return quad.predicate != Id(0) && quad.subject.bits() % 2 == 1;
  }
};

TEST(GraphVersionTest, HiddenTriplesMatchNoPattern) {
  std::mt19937_64 random(6);
  std::set<Quad> all, shown;
  GraphWriter writer(nullptr);
  const OddSubjects hidden;
  for (int i = 0; i < 2000; ++i) {
    const Quad quad = Q(random() % 10, random() % 4, random() % 20, random() % 3 + 1);
    writer.Add(quad);
    all.insert(quad);
    if (!hidden.Hides(quad)) shown.insert(quad);
  }
  const auto expect = [&](const GraphVersion& version, const std::set<Quad>& model) {
    for (int mask = 0; mask < 15; ++mask) {
      for (int i = 0; i < 20; ++i) {
        const Quad q = Q(random() % 10, random() % 4, random() % 20, random() % 4 + 1);
        const QuadPattern pattern{(mask & 1) ? q.subject : TermId(), (mask & 2) ? q.predicate : TermId(),
                                  (mask & 4) ? q.object : TermId(), (mask & 8) ? q.graph : TermId()};
        std::set<Quad> expected;
        std::set<std::array<TermId, 3>> triples;
        for (const Quad& quad : model) {
          if (!pattern.Matches(quad)) continue;
          expected.insert(quad);
          triples.insert({quad.subject, quad.predicate, quad.object});
        }
        const std::vector<Quad> found = Found(version, pattern);
        ASSERT_EQ(std::set<Quad>(found.begin(), found.end()), expected) << "mask " << mask;
        ASSERT_EQ(found.size(), expected.size());
        ASSERT_EQ(version.ContainsMatch(pattern), !expected.empty()) << "mask " << mask;
        ASSERT_GE(version.Count(pattern), expected.size());
        if ((mask & 8) != 0) continue;
        size_t walked = 0;
        for (QuadCursor c = version.Scan(pattern); c.Valid(); c.NextTriple()) ++walked;
        ASSERT_EQ(walked, triples.size()) << "mask " << mask;
      }
    }
    for (const Quad& quad : all) ASSERT_TRUE(version.Contains(quad));
  };
  expect(*writer.current().Without(hidden), shown);
  {
    const GraphWriter::Hiding hiding(writer, hidden);
    expect(writer.current(), shown);
    EXPECT_TRUE(writer.AddAll({all.begin(), all.end()}).empty()) << "what is hidden is there";
  }
  expect(writer.current(), all);
  expect(*writer.Freeze(Revision(1)), all);
}

TEST(GraphVersionTest, CopiesOfATripleAreAdjacent) {
  GraphWriter writer(nullptr);
  for (uint64_t i = 0; i < 50; ++i) {
    writer.Add(Q(i % 7, i % 3, i, 1));
    writer.Add(Q(i % 7, i % 3, i, 2));
  }
  for (const QuadPattern& pattern :
       {QuadPattern{}, QuadPattern{Id(3), {}, {}, {}}, QuadPattern{{}, Id(2), {}, {}}}) {
    std::vector<Quad> found = Found(writer.current(), pattern);
    ASSERT_EQ(found.size() % 2, 0u);
    for (size_t i = 0; i < found.size(); i += 2) {
      EXPECT_EQ(found[i].object, found[i + 1].object);
      EXPECT_NE(found[i].graph, found[i + 1].graph);
    }
  }
}

// Over many leaves: of one graph, of several, and copies on both sides of a leaf's end.
TEST(GraphVersionTest, TheRestIsCountedFromAnyMatch) {
  GraphWriter writer(nullptr);
  for (uint64_t i = 0; i < 4000; ++i) {
    writer.Add(Q(i / 10, i % 10, i, 1));
    if (i > 2000) writer.Add(Q(i / 10, i % 10, i, 2));
    if (i > 3000) writer.Add(Q(i / 10, i % 10, i, 3));
  }
  for (const QuadPattern& pattern :
       {QuadPattern{}, QuadPattern{{}, Id(3), {}, {}}, QuadPattern{{}, {}, {}, Id(2)}}) {
    uint64_t left = writer.current().Count(pattern), triples = 0;
    Quad last;
    const auto copy = [&last](const Quad& q) {
      return q.subject == last.subject && q.predicate == last.predicate && q.object == last.object;
    };
    for (QuadCursor c = writer.current().Scan(pattern); c.Valid(); c.Next()) {
      triples += !copy(c.quad());
      last = c.quad();
    }
    last = {};
    for (QuadCursor c = writer.current().Scan(pattern); c.Valid(); c.Next(), --left) {
      const bool first = !copy(c.quad());
      last = c.quad();
      if (left % 7 == 0) {
        ASSERT_EQ(QuadCursor(c).CountRest(false), left);
        ASSERT_EQ(QuadCursor(c).CountRest(true), first ? triples : triples + 1);
      }
      triples -= first;
    }
    EXPECT_EQ(left, 0u);
  }
}

TEST(GraphVersionTest, SeekGoesForwardWithinTheMatches) {
  GraphWriter writer(nullptr);
  for (uint64_t o = 0; o < 2000; o += 2) writer.Add(Q(1, 2, o));
  writer.Add(Q(2, 2, 5));
  QuadCursor cursor = writer.current().Scan({Id(1), Id(2), {}, {}});
  cursor.Seek(Q(1, 2, 701, 0));
  ASSERT_TRUE(cursor.Valid());
  EXPECT_EQ(cursor.quad().object, Id(702));
  cursor.Seek(Q(1, 2, 3, 0));  // behind: stays
  EXPECT_EQ(cursor.quad().object, Id(702));
  cursor.Seek(Q(1, 2, 1998, 1));
  EXPECT_EQ(cursor.quad().object, Id(1998));
  cursor.Seek(Q(2, 0, 0, 0));
  EXPECT_FALSE(cursor.Valid());  // the pattern ends before
}

TEST(GraphVersionTest, GraphsComeAndGo) {
  GraphWriter writer(nullptr);
  for (uint64_t g = 10; g > 0; --g) {
    for (uint64_t i = 0; i < 300; ++i) writer.Add(Q(i, 1, 1, g));
  }
  std::vector<TermId> graphs = writer.current().graphs();
  EXPECT_EQ(graphs.size(), 10u);
  EXPECT_TRUE(std::is_sorted(graphs.begin(), graphs.end()));
  for (uint64_t i = 0; i < 300; ++i) writer.Remove(Q(i, 1, 1, 4));
  graphs = writer.current().graphs();
  EXPECT_EQ(graphs.size(), 9u);
  EXPECT_EQ(std::count(graphs.begin(), graphs.end(), Id(4)), 0);
}

// The newest version, which one thread sets and others take.
class Newest {
 public:
  explicit Newest(GraphVersionPtr version) : version_(std::move(version)) {}
  GraphVersionPtr Get() {
    absl::MutexLock lock(&mutex_);
    return version_;
  }
  // The old version is destroyed outside the lock.
  void Set(GraphVersionPtr version) {
    absl::MutexLock lock(&mutex_);
    version_.swap(version);
  }

 private:
  absl::Mutex mutex_;
  GraphVersionPtr version_;
};

// Readers walk versions while the writer makes and drops others: a version held by a reader never changes.
TEST(GraphVersionTest, ReadersBesideTheWriter) {
  std::atomic<bool> stop{false}, wrong{false};
  GraphWriter writer(nullptr);
  for (uint64_t i = 0; i < 2000; ++i) writer.Add(Q(i, 1, 0));
  Newest newest(writer.Freeze(Revision(1)));
  auto read = [&] {
    while (!stop) {
      const GraphVersionPtr version = newest.Get();
      // In every version each subject has exactly one value, which is the revision that set it.
      uint64_t count = 0;
      version->ForEach({{}, Id(1), {}, {}}, [&](const Quad& quad) {
        ++count;
        if (quad.object.payload() > version->revision().value()) wrong = true;
        return true;
      });
      if (count != 2000 || version->size() != 2000 || version->graphs().size() != 1) wrong = true;
    }
  };
  std::thread first(read), second(read);
  std::vector<uint64_t> value(2000, 0);
  std::mt19937_64 random(9);
  for (uint64_t revision = 2; revision < 600; ++revision) {
    for (int i = 0; i < 5; ++i) {
      uint64_t s = random() % 2000;
      writer.Remove(Q(s, 1, value[s]));
      writer.Add(Q(s, 1, revision));
      value[s] = revision;
    }
    newest.Set(writer.Freeze(Revision(revision)));
  }
  stop = true;
  first.join();
  second.join();
  EXPECT_FALSE(wrong);
}

// Writers that start from the newest version on threads of their own change it one by one and in bulk, and
// drop it again beside the writer that makes the versions. Shared nodes are counted correctly: none is freed
// too early or leaked.
TEST(GraphVersionTest, OtherWritersBesideTheWriter) {
  constexpr uint64_t kSubjects = 5000;
  std::atomic<bool> stop{false}, wrong{false};
  std::atomic<int> branches{0};
  GraphWriter writer(nullptr);
  for (uint64_t i = 0; i < kSubjects; ++i) writer.Add(Q(i, 1, 0));
  Newest newest(writer.Freeze(Revision(1)));
  const auto branch = [&](uint64_t seed) {
    std::mt19937_64 random(seed);
    while (!stop) {
      const GraphVersionPtr start = newest.Get();
      GraphWriter own(start);
      std::vector<Quad> many;
      for (int i = 0; i < 200; ++i) many.push_back(Q(random() % kSubjects, 2 + seed, i));
      const size_t added = own.AddAll(many).size();
      const GraphVersionPtr first = own.Freeze(Revision(start->revision().value() + 1));
      for (uint64_t s = 0; s < 40; ++s) own.Add(Q(s * 100, 9, seed));
      own.Rollback();
      for (uint64_t s = 0; s < 1200; ++s) own.RemoveAll({own.current().Scan({Id(s), Id(1), {}, {}}).quad()});
      if (first->size() != start->size() + added || own.current().size() != first->size() - 1200)
        wrong = true;
      own.current().CheckInvariants();
      start->CheckInvariants();
      ++branches;
    }
  };
  std::thread first(branch, 1), second(branch, 2);
  std::mt19937_64 random(9);
  std::vector<uint64_t> value(kSubjects, 0);
  for (uint64_t revision = 2; revision < 3000 || branches < 8; ++revision) {
    const uint64_t s = random() % kSubjects;
    writer.Remove(Q(s, 1, value[s]));
    writer.Add(Q(s, 1, revision));
    value[s] = revision;
    newest.Set(writer.Freeze(Revision(revision)));
  }
  stop = true;
  first.join();
  second.join();
  EXPECT_FALSE(wrong);
  newest.Get()->CheckInvariants();
}

// The extra memory of an earlier version is known without a walk over its nodes.
TEST(GraphVersionTest, TheCostOfKeepingAVersionIsKnown) {
  GraphWriter writer(nullptr);
  std::vector<Quad> quads;
  for (uint64_t i = 0; i < 3000; ++i) quads.push_back(Q(i, i % 7, i * 31 % 1000));
  writer.AddAll(quads);
  const GraphVersionPtr first = writer.Freeze(Revision(1));
  EXPECT_EQ(first->replaced_bytes(), 0u);

  writer.Add(Q(1, 1, 5000));
  const GraphVersionPtr second = writer.Freeze(Revision(2));
  const size_t one_change = second->replaced_bytes() - first->replaced_bytes();
  EXPECT_GT(one_change, 0u);
  EXPECT_LT(one_change, second->bytes() / 4);

  for (const Quad& quad : quads) writer.Remove(quad);
  writer.Remove(Q(1, 1, 5000));
  const GraphVersionPtr third = writer.Freeze(Revision(3));
  EXPECT_EQ(third->replaced_bytes() - second->replaced_bytes(), second->bytes()) << "nothing of it is shared";

  writer.AddAll(quads);
  const GraphVersionPtr fourth = writer.Freeze(Revision(4));
  for (Quad& quad : quads) quad.graph = Id(2);
  writer.AddAll(quads);
  const GraphVersionPtr fifth = writer.Freeze(Revision(5));
  const size_t many = fifth->replaced_bytes() - fourth->replaced_bytes();
  EXPECT_GT(many, fourth->bytes() / 2) << "many at once change most leaves";
  EXPECT_LE(many, fourth->bytes());
}

}  // namespace
}  // namespace docent
