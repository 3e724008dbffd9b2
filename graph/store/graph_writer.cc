#include "graph/store/graph_writer.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "graph/store/index_order.h"
#include "graph/store/key_sort.h"
#include "graph/store/quad_tree_edit.h"
#include "graph/store/read_trace.h"

namespace docent {
namespace {

// Who adds or removes learns whether the quad was there.
void NoteRead(const Quad& quad) {
  ReadTrace::Note({quad.subject, quad.predicate, quad.object, quad.graph});
}

}  // namespace

GraphWriter::GraphWriter(GraphVersionPtr start)
    : start_(start != nullptr ? std::move(start) : std::make_shared<GraphVersion>()),
      version_(new GraphVersion(*start_)),
      epoch_(QuadTree::NewEpoch()) {}

bool GraphWriter::Add(const Quad& quad) {
  NoteRead(quad);
  for (int i = 0; i < kIndexOrders; ++i) {
    if (!version_->trees_[i].Insert(KeyOf(quad, IndexOrder(i)), epoch_))
      return false;  // after the first: all indexes hold the same quads
  }
  Note(quad, true);
  return true;
}

bool GraphWriter::Remove(const Quad& quad) {
  NoteRead(quad);
  for (int i = 0; i < kIndexOrders; ++i) {
    if (!version_->trees_[i].Erase(KeyOf(quad, IndexOrder(i)), epoch_))
      return false;  // after the first: all indexes hold the same quads
  }
  Note(quad, false);
  return true;
}

Delta GraphWriter::Apply(const std::vector<Quad>& add, const std::vector<Quad>& remove) {
  Delta delta;
  for (const Quad& quad : add) {
    if (Add(quad)) delta.added.push_back(quad);
  }
  if (remove.empty()) return delta;
  absl::flat_hash_set<Quad> added(delta.added.begin(), delta.added.end());
  bool cancelled = false;
  for (const Quad& quad : remove) {
    if (!Remove(quad)) continue;
    if (added.erase(quad) == 0)
      delta.removed.push_back(quad);
    else
      cancelled = true;
  }
  if (cancelled) {
    std::erase_if(delta.added, [&](const Quad& quad) { return !added.contains(quad); });
  }
  return delta;
}

namespace {

// Fewer quads than this are inserted one by one.
constexpr size_t kFew = 16;
// For quads sorted by their fields; few words then remain to sort by.
std::vector<QuadTree::Key> SortedKeys(const std::vector<Quad>& quads, IndexOrder order,
                                      std::vector<QuadTree::Key>& scratch) {
  std::vector<QuadTree::Key> keys(quads.size());
  for (size_t i = 0; i < quads.size(); ++i) keys[i] = KeyOf(quads[i], order);
  if (order == IndexOrder::kPosg) StableSortByWord(keys, 1, scratch);
  if (order != IndexOrder::kSpog) StableSortByWord(keys, 0, scratch);
  return keys;
}

void SortQuads(std::vector<Quad>& quads) {
  if (!std::is_sorted(quads.begin(), quads.end())) std::sort(quads.begin(), quads.end());
}

}  // namespace

std::vector<Quad> GraphWriter::AddAll(std::vector<Quad> quads) {
  if (quads.size() < kFew) {
    std::erase_if(quads, [this](const Quad& quad) { return !Add(quad); });
    return quads;
  }
  const auto erase_known = [this](auto& fresh, auto quad_of) {
    if (version_->size() == 0) return ReadTrace::NoteAnything();
    QuadCursor cursor;
    std::erase_if(fresh, [&](const auto& each) {
      const Quad& quad = quad_of(each);
      version_->Rescan({quad.subject, quad.predicate, quad.object, quad.graph}, &cursor);
      return cursor.Valid();
    });
  };
  const auto insert = [this](const std::vector<Quad>& sorted) {
    std::vector<QuadTree::Key> scratch;
    for (int i = 0; i < kIndexOrders; ++i) {
      QuadTree::Edit::InsertSorted(&version_->trees_[i], SortedKeys(sorted, IndexOrder(i), scratch), epoch_);
    }
    for (const Quad& quad : sorted) Note(quad, true);
  };
  const bool rising = std::adjacent_find(quads.begin(), quads.end(), std::greater_equal<>()) == quads.end();
  if (rising) {  // sorted and distinct
    erase_known(quads, [](const Quad& quad) -> const Quad& { return quad; });
    insert(quads);
    return quads;
  }
  using Placed = std::pair<Quad, size_t>;
  std::vector<Placed> fresh;
  fresh.reserve(quads.size());
  for (size_t i = 0; i < quads.size(); ++i) fresh.emplace_back(quads[i], i);
  std::sort(fresh.begin(), fresh.end());
  const auto repeats = std::unique(fresh.begin(), fresh.end(),
                                   [](const Placed& a, const Placed& b) { return a.first == b.first; });
  fresh.erase(repeats, fresh.end());
  erase_known(fresh, [](const Placed& placed) -> const Quad& { return placed.first; });
  std::vector<Quad> sorted;
  sorted.reserve(fresh.size());
  for (const Placed& placed : fresh) sorted.push_back(placed.first);
  insert(sorted);
  if (fresh.size() == quads.size()) return quads;
  std::sort(fresh.begin(), fresh.end(), [](const Placed& a, const Placed& b) { return a.second < b.second; });
  quads.clear();
  for (const Placed& placed : fresh) quads.push_back(placed.first);
  return quads;
}

size_t GraphWriter::RemoveAll(std::vector<Quad> quads) {
  const size_t before = version_->size();
  if (quads.size() < kFew) {
    for (const Quad& quad : quads) Remove(quad);
    return before - version_->size();
  }
  SortQuads(quads);
  std::erase_if(quads, [this](const Quad& quad) {
    NoteRead(quad);
    return !version_->trees_[0].Erase(KeyOf(quad, IndexOrder::kSpog), epoch_);
  });
  std::vector<QuadTree::Key> scratch;
  for (int i = 1; i < kIndexOrders; ++i) {
    QuadTree& tree = version_->trees_[i];
    for (const QuadTree::Key& key : SortedKeys(quads, IndexOrder(i), scratch)) tree.Erase(key, epoch_);
  }
  for (const Quad& quad : quads) Note(quad, false);
  return before - version_->size();
}

void GraphWriter::Commit() {
  committed_ = true;
  journal_.clear();
}

GraphVersionPtr GraphWriter::Freeze(Revision revision) {
  committed_ = false;
  journal_.clear();
  version_->revision_ = revision;
  start_.reset(new GraphVersion(*version_));
  epoch_ = QuadTree::NewEpoch();
  return start_;
}

// The first change of a quad tells whether it was there before, the last one whether it is there now.
void GraphWriter::TakeBack() {
  if (journal_.size() < kFew) {
    for (auto change = journal_.rbegin(); change != journal_.rend(); ++change) {
      change->added ? Remove(change->quad) : Add(change->quad);
    }
    return;
  }
  std::stable_sort(journal_.begin(), journal_.end(),
                   [](const Change& a, const Change& b) { return a.quad < b.quad; });
  std::vector<Quad> came, went;
  for (size_t i = 0; i < journal_.size();) {
    size_t last = i;
    while (last + 1 < journal_.size() && journal_[last + 1].quad == journal_[i].quad) ++last;
    if (journal_[i].added == journal_[last].added)
      (journal_[i].added ? came : went).push_back(journal_[i].quad);
    i = last + 1;
  }
  RemoveAll(std::move(came));
  AddAll(std::move(went));
}

void GraphWriter::Rollback() {
  if (committed_) {
    committed_ = false;  // the changes made here are not recorded for another undo
    TakeBack();
    return Commit();
  }
  version_.reset(new GraphVersion(*start_));
  epoch_ = QuadTree::NewEpoch();
}

}  // namespace docent
