#include "reasoner/matching/pattern_index.h"

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/rdf/term.h"

namespace docent::matching {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TermId Id(uint64_t n) {
  return n == 0 ? TermId() : TermId::Make(TermId::Tag::kIri, n);
}
TermId Number(int n) {
  return InlineLiteral(Term::Integer(n)).value();
}
MatchPattern Pattern(uint64_t s, uint64_t p, uint64_t o, uint64_t g = 0) {
  return {{Id(s), Id(p), Id(o), Id(g)}, 0, {}};
}

std::vector<uint32_t> Owners(const PatternIndex& index, const Quad& quad) {
  std::vector<uint32_t> owners;
  index.ForEachMatch(quad, [&](PatternIndex::Reference r) { owners.push_back(r.owner); });
  std::sort(owners.begin(), owners.end());
  return owners;
}

TEST(PatternIndex, FindsEveryShapeThatMatches) {
  PatternIndex index;
  index.Add(Pattern(0, 2, 0), {1, 0});
  index.Add(Pattern(1, 2, 0), {2, 0});
  index.Add(Pattern(0, 2, 3), {3, 0});
  index.Add(Pattern(1, 2, 3), {4, 0});
  index.Add(Pattern(0, 0, 0), {5, 0});
  index.Add(Pattern(1, 2, 4), {6, 0});
  index.Add(Pattern(9, 2, 0), {7, 0});
  EXPECT_THAT(Owners(index, {Id(1), Id(2), Id(3), Id(8)}), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(Owners(index, {Id(7), Id(7), Id(7), Id(8)}), ElementsAre(5));
}

TEST(PatternIndex, ARepeatedVariableHoldsPositionsEqual) {
  PatternIndex index;
  MatchPattern knows_itself = Pattern(0, 2, 0);
  knows_itself.equal = MatchPattern::kSubjectObject;
  index.Add(knows_itself, {1, 0});
  EXPECT_THAT(Owners(index, {Id(1), Id(2), Id(3), Id(8)}), IsEmpty());
  EXPECT_THAT(Owners(index, {Id(1), Id(2), Id(1), Id(8)}), ElementsAre(1));
}

TEST(PatternIndex, TheGraphIsCheckedWhereItIsGiven) {
  PatternIndex index;
  index.Add(Pattern(0, 2, 0, 8), {1, 0});
  EXPECT_THAT(Owners(index, {Id(1), Id(2), Id(3), Id(8)}), ElementsAre(1));
  EXPECT_THAT(Owners(index, {Id(1), Id(2), Id(3), Id(9)}), IsEmpty());
}

TEST(PatternIndex, GuardsAreReachedOnlyByNumbersBeyondThem) {
  PatternIndex index;
  for (uint32_t bound = 0; bound < 100; ++bound) {
    MatchPattern above = Pattern(0, 2, 0);
    above.object_guard = NumberGuard{Comparison::kGreater, static_cast<double>(bound)};
    index.Add(above, {bound, 0});
    MatchPattern below = Pattern(0, 2, 0);
    below.object_guard = NumberGuard{Comparison::kLessOrEqual, static_cast<double>(bound)};
    index.Add(below, {1000 + bound, 0});
  }
  // The bound itself is visited in both directions: the guard is necessary, not sufficient.
  EXPECT_THAT(Owners(index, {Id(1), Id(2), Number(2), Id(8)}).size(), 3u + 98u);
  EXPECT_EQ(Owners(index, {Id(1), Id(2), Number(-1), Id(8)}).size(), 100u);
  EXPECT_THAT(Owners(index, {Id(1), Id(2), Id(3), Id(8)}), IsEmpty()) << "an IRI is no number";
  EXPECT_EQ(Owners(index, {Id(1), Id(2), TermId::Make(TermId::Tag::kLiteral, 5), Id(8)}).size(), 200u)
      << "a literal of the dictionary may be one";
}

// Against a list of patterns that are tried one by one, with removals in between.
// Rules are tried in their order.
TEST(PatternIndex, ThoseOfTheSameConstantsComeInTheOrderInWhichTheyWereAdded) {
  PatternIndex index;
  std::vector<PatternIndex::Handle> handles;
  for (uint32_t i = 0; i < 6; ++i) handles.push_back(index.Add(Pattern(0, 2, 3), {i, 0}));
  const auto in_order = [&] {
    std::vector<uint32_t> owners;
    index.ForEachMatch({Id(1), Id(2), Id(3), Id(4)},
                       [&](PatternIndex::Reference r) { owners.push_back(r.owner); });
    return owners;
  };
  EXPECT_THAT(in_order(), ElementsAre(0, 1, 2, 3, 4, 5));
  index.Remove(handles[0]);
  index.Remove(handles[3]);
  index.Remove(handles[5]);
  EXPECT_THAT(in_order(), ElementsAre(1, 2, 4));
  index.Add(Pattern(0, 2, 3), {6, 0});
  EXPECT_THAT(in_order(), ElementsAre(1, 2, 4, 6));
  for (const int i : {4, 1, 2}) index.Remove(handles[static_cast<size_t>(i)]);
  EXPECT_THAT(in_order(), ElementsAre(6));
}

TEST(PatternIndex, AgreesWithTryingEveryPattern) {
  std::mt19937 random(7);
  const auto pick = [&](int n) { return static_cast<uint64_t>(random() % n); };
  PatternIndex index;
  struct Known {
    PatternIndex::Handle handle;
    uint32_t owner;
    MatchPattern pattern;
  };
  std::vector<Known> known;
  uint32_t next_owner = 0;
  for (int step = 0; step < 4000; ++step) {
    if (known.size() > 200 || (!known.empty() && pick(3) == 0)) {
      const size_t victim = pick(static_cast<int>(known.size()));
      index.Remove(known[victim].handle);
      known.erase(known.begin() + static_cast<std::ptrdiff_t>(victim));
    } else {
      MatchPattern pattern = Pattern(pick(3), pick(3), pick(3), pick(6) == 0 ? 1 + pick(2) : 0);
      if (pick(4) == 0 && pattern.constants.subject.IsNone() && pattern.constants.object.IsNone()) {
        pattern.equal = MatchPattern::kSubjectObject;
      } else if (pick(3) == 0 && pattern.constants.object.IsNone()) {
        pattern.object_guard = NumberGuard{static_cast<Comparison>(pick(4)), static_cast<double>(pick(5))};
      }
      known.push_back({index.Add(pattern, {next_owner, 0}), next_owner, pattern});
      ++next_owner;
    }
    const TermId object = pick(2) == 0 ? Number(static_cast<int>(pick(5))) : Id(1 + pick(3));
    const Quad quad = {Id(1 + pick(3)), Id(1 + pick(3)), object, Id(1 + pick(2))};
    std::vector<uint32_t> expected;
    for (const Known& k : known) {
      if (k.pattern.Matches(quad)) expected.push_back(k.owner);
    }
    ASSERT_EQ(Owners(index, quad), expected) << "step " << step;
  }
  EXPECT_EQ(index.size(), known.size());
}

// The table grows, and slots move up after removals.
TEST(PatternIndex, ManyKeysComeAndGo) {
  std::mt19937 random(11);
  PatternIndex index;
  std::vector<std::pair<uint64_t, PatternIndex::Handle>> known;  // subject, which is the owner as well
  uint64_t next = 1;
  for (const size_t wanted : {3000, 10, 500, 0, 40}) {
    while (known.size() != wanted) {
      if (known.size() < wanted && random() % 3 != 0) {
        known.emplace_back(next, index.Add(Pattern(next, 2, 0), {static_cast<uint32_t>(next), 0}));
        ++next;
      } else if (!known.empty()) {
        std::swap(known[random() % known.size()], known.back());
        index.Remove(known.back().second);
        known.pop_back();
      }
    }
    EXPECT_EQ(index.size(), wanted);
    size_t found = 0;
    for (uint64_t subject = 1; subject < next; ++subject)
      found += Owners(index, {Id(subject), Id(2), Id(3), Id(4)}).size();
    EXPECT_EQ(found, wanted);
    for (const auto& [subject, handle] : known) {
      ASSERT_THAT(Owners(index, {Id(subject), Id(2), Id(3), Id(4)}),
                  ElementsAre(static_cast<uint32_t>(subject)));
    }
  }
}

}  // namespace
}  // namespace docent::matching
