// A QuadTree against std::set under random inserts and erases, with old versions kept and compared again
// later.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "graph/store/quad_tree_edit.h"

namespace docent {
namespace {

using Key = QuadTree::Key;
constexpr uint64_t kMax = ~uint64_t{0};
constexpr Key kLowest = {0, 0, 0, 0};
constexpr Key kHighest = {kMax, kMax, kMax, kMax};

std::vector<Key> All(const QuadTree& tree) {
  std::vector<Key> keys;
  for (auto i = tree.Range(kLowest, kHighest); i.Valid(); i.Next()) keys.push_back(i.key());
  return keys;
}

// Key words of several shapes: dense, spread over tags, and of all 64 bits.
struct KeySource {
  explicit KeySource(uint64_t seed) : random(seed), shape(seed % 4), words(20 + seed * 37 % 400) {}

  uint64_t Word(int column) {
    uint64_t n = random() % words;
    switch (shape) {
      case 0:
        return n;
      case 1:
        return column == 2 ? random() : n + (uint64_t{1} << 60);
      case 2:
        return (n % 9 + 1) << 60 | n * 1000003;
      default:
        return n % 3 == 0 ? kMax - n : n << (n % 50);
    }
  }
  Key Next() { return {Word(0), Word(1) % 50 + 1, Word(2), Word(3) % 3}; }

  std::mt19937_64 random;
  uint64_t shape;
  uint64_t words;
};

// Checks ContainsPrefix for the first `words` words of `key`.
void ExpectSamePrefix(const QuadTree& tree, const std::set<Key>& model, const Key& key, int words) {
  Key prefix = {};
  std::copy(key.begin(), key.begin() + words, prefix.begin());
  const auto after = model.lower_bound(prefix);
  ASSERT_EQ(tree.ContainsPrefix(prefix, words),
            after != model.end() && std::equal(prefix.begin(), prefix.begin() + words, after->begin()));
}

void ExpectSameRanges(const QuadTree& tree, const std::set<Key>& model, KeySource* source) {
  auto again = tree.Range(kLowest, kHighest);
  for (int i = 0; i < 20; ++i) {
    Key first = source->Next(), last = source->Next();
    if (i % 3 == 0) first = {first[0], 0, 0, 0}, last = {first[0], kMax, kMax, kMax};
    auto from = model.lower_bound(first);
    auto to = last < first ? from : model.upper_bound(last);
    std::vector<Key> expected(from, to), found;
    for (auto it = tree.Range(first, last); it.Valid(); it.Next()) found.push_back(it.key());
    ASSERT_EQ(found, expected);
    ASSERT_EQ(tree.CountRange(first, last), expected.size());
    ExpectSamePrefix(tree, model, first, i % 5);
    ASSERT_EQ(tree.RankOf(first),
              static_cast<uint64_t>(std::distance(model.begin(), model.lower_bound(first))));
    if (!model.empty()) {
      const uint64_t rank = source->random() % model.size();
      ASSERT_EQ(tree.KeyAt(rank), *std::next(model.begin(), static_cast<std::ptrdiff_t>(rank)));
    }
    again.Restart(first, last);  // from wherever the lookup before ended
    found.clear();
    for (; again.Valid() && (i % 4 != 1 || found.size() < 3); again.Next()) found.push_back(again.key());
    if (i % 4 == 1 && found.size() == 3) expected.resize(3);
    ASSERT_EQ(found, expected);
    expected.assign(from, to);
    // Seek visits the same keys as a walk over the model.
    auto it = tree.Range(first, last);
    Key at = first;
    for (int hop = 0; hop < 10; ++hop) {
      Key target = hop % 2 == 0 ? source->Next() : Key{at[0], at[1], at[2] + 1, 0};
      bool was_valid = it.Valid();
      it.Seek(target);
      if (target > at) at = target;
      auto expect = model.lower_bound(at);
      if (!was_valid || last < first || expect == model.end() || last < *expect) {
        ASSERT_FALSE(it.Valid());
        break;
      }
      ASSERT_TRUE(it.Valid());
      ASSERT_EQ(it.key(), *expect);
      at = *expect;
    }
  }
}

class StoreTreeProperty : public testing::TestWithParam<uint64_t> {};

TEST_P(StoreTreeProperty, BehavesAsASetAndOldVersionsStay) {
  SCOPED_TRACE(testing::Message() << "seed " << GetParam());
  KeySource source(GetParam());
  QuadTree tree;
  std::set<Key> model;
  std::vector<std::pair<QuadTree, std::vector<Key>>> versions;
  uint64_t epoch = QuadTree::NewEpoch();
  for (int round = 0; round < 60; ++round) {
    bool growing = source.random() % 3 != 0;
    int changes = static_cast<int>(source.random() % 400);
    if (round % 4 == 3) {  // many at once, of one neighbourhood or from everywhere
      std::set<Key> run;
      const size_t count = source.random() % (round % 8 == 3 ? 3000 : 40);
      for (size_t i = 0; i < count; ++i) {
        Key key = source.Next();
        if (round % 12 == 3 && !run.empty()) key[0] = (*run.begin())[0];
        run.insert(key);
      }
      QuadTree::Edit::InsertSorted(&tree, std::vector<Key>(run.begin(), run.end()), epoch);
      model.insert(run.begin(), run.end());
      tree.CheckInvariants();
      ASSERT_EQ(All(tree), std::vector<Key>(model.begin(), model.end()));
      for (const Key& key : run) ExpectSamePrefix(tree, model, key, 3);
    }
    for (int i = 0; i < changes; ++i) {
      Key key = source.Next();
      if (!growing && !model.empty() && i % 4 != 0) {
        auto near = model.lower_bound(key);
        key = near == model.end() ? *model.begin() : *near;
      }
      if (growing == (source.random() % 8 != 0)) {
        ASSERT_EQ(tree.Insert(key, epoch), model.insert(key).second);
      } else {
        ASSERT_EQ(tree.Erase(key, epoch), model.erase(key) == 1);
      }
      ASSERT_EQ(tree.Contains(key), model.contains(key));
      // Near the change, where the tree mostly answers without a descent.
      for (int words = 0; words < 5; ++words) ExpectSamePrefix(tree, model, key, words);
      const auto next = model.upper_bound(key);
      if (next != model.end()) ExpectSamePrefix(tree, model, *next, i % 5);
      if (next != model.begin()) ExpectSamePrefix(tree, model, *std::prev(next), i % 5);
      ExpectSamePrefix(tree, model, source.Next(), i % 5);
    }
    ASSERT_EQ(tree.size(), model.size());
    tree.CheckInvariants();
    QuadTree moved = std::move(tree);
    if (!model.empty()) ExpectSamePrefix(moved, model, *model.begin(), 2);
    tree = std::move(moved);
    if (round % 5 == 0) {
      versions.emplace_back(tree, std::vector<Key>(model.begin(), model.end()));
      epoch = QuadTree::NewEpoch();
    }
    if (round % 20 == 19) versions.erase(versions.begin());
    ExpectSameRanges(tree, model, &source);
  }
  ASSERT_EQ(All(tree), std::vector<Key>(model.begin(), model.end()));
  for (const auto& [version, keys] : versions) {
    version.CheckInvariants();
    ASSERT_EQ(All(version), keys);
    const std::set<Key> then(keys.begin(), keys.end());
    for (int i = 0; i < 100; ++i) ExpectSamePrefix(version, then, source.Next(), i % 5);
  }
  // Down to nothing, in random order.
  std::vector<Key> rest(model.begin(), model.end());
  std::shuffle(rest.begin(), rest.end(), source.random);
  for (const Key& key : rest) {
    ASSERT_TRUE(tree.Erase(key, epoch));
    model.erase(key);
    for (int words = 1; words < 5; ++words) ExpectSamePrefix(tree, model, key, words);
  }
  EXPECT_EQ(tree.size(), 0u);
  EXPECT_EQ(tree.bytes(), 0u);
  for (const auto& [version, keys] : versions) ASSERT_EQ(All(version), keys);
}

// The root may lose all children but one, which an older version shares and which has one child, too.
TEST(StoreTree, ANodeOfAnOlderVersionKeepsItsOnlyChild) {
  QuadTree::Edit before(QuadTree::NewEpoch());
  const Key key = {1, 2, 3, 4};
  QuadTree::Leaf* leaf = before.NewLeaf(std::span<const Key>(&key, 1), 0);
  QuadTree::Inner* inner = before.NewInner();
  inner->count = 1;
  inner->children[0] = leaf;
  QuadTree::Edit::Acquire(inner);  // by the older version
  {
    QuadTree::Edit now(QuadTree::NewEpoch());
    EXPECT_EQ(now.TakeOnlyChild(inner), leaf);
  }
  EXPECT_EQ(inner->count, 1);
  EXPECT_EQ(leaf->references, 2u);
  QuadTree::Edit::Release(inner);
  EXPECT_EQ(leaf->references, 1u);
  QuadTree::Edit::Release(leaf);
}

TEST(StoreTree, WordsBesideTheGreatestAndTheLeastInOneLeaf) {
  QuadTree tree;
  const uint64_t epoch = QuadTree::NewEpoch();
  const std::vector<Key> keys = {
      {0, 0, 0, 0}, {5, 0, 0, 0}, {kMax - 300, 1, 0, 0}, {kMax - 1, 0, 0, 0}, {kMax, 0, 0, 0}};
  for (const size_t i : {3, 4, 1, 0, 2}) {
    ASSERT_TRUE(tree.Insert(keys[i], epoch));
    tree.CheckInvariants();
    ASSERT_TRUE(tree.Contains(keys[i]));
  }
  EXPECT_EQ(All(tree), keys);
}

TEST_P(StoreTreeProperty, BuildEqualsInserts) {
  KeySource source(GetParam());
  std::set<Key> model;
  for (uint64_t i = 0; i < GetParam() * 300; ++i) model.insert(source.Next());
  QuadTree tree = QuadTree::Build({model.begin(), model.end()}, QuadTree::NewEpoch());
  tree.CheckInvariants();
  ASSERT_EQ(All(tree), std::vector<Key>(model.begin(), model.end()));
  uint64_t epoch = QuadTree::NewEpoch();
  QuadTree changed = tree;
  for (int i = 0; i < 500; ++i) {
    Key key = source.Next();
    bool known = model.contains(key);
    ASSERT_EQ(changed.Insert(key, epoch), !known);
    if (!known) {
      ASSERT_TRUE(changed.Erase(key, epoch));
    }
  }
  changed.CheckInvariants();
  ASSERT_EQ(All(changed), All(tree));
}

INSTANTIATE_TEST_SUITE_P(Seeds, StoreTreeProperty, testing::Range<uint64_t>(1, 17));

TEST(StoreTreeGrowth, KeysInOrderFillTheLeaves) {
  QuadTree tree;
  uint64_t epoch = QuadTree::NewEpoch();
  for (uint64_t i = 0; i < 200000; ++i) tree.Insert({1, 2, i, 3}, epoch);
  tree.CheckInvariants();
  EXPECT_EQ(tree.size(), 200000u);
  EXPECT_LT(tree.bytes() / tree.size(), 6u);  // three bytes of the third word, and the nodes
}

}  // namespace
}  // namespace docent
