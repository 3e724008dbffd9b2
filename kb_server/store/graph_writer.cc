#include "kb_server/store/graph_writer.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "kb_server/store/index_order.h"
#include "kb_server/store/quad_tree_edit.h"

namespace docent {

GraphWriter::GraphWriter(GraphVersionPtr start)
    : start_(start != nullptr ? std::move(start) : std::make_shared<GraphVersion>()),
      version_(new GraphVersion(*start_)),
      epoch_(QuadTree::NewEpoch()) {}

bool GraphWriter::Add(const Quad& quad) {
  if (!version_->trees_[0].Insert(KeyOf(quad, IndexOrder::kSpog), epoch_)) return false;
  for (int i = 1; i < kIndexOrders; ++i) version_->trees_[i].Insert(KeyOf(quad, IndexOrder(i)), epoch_);
  return true;
}

bool GraphWriter::Remove(const Quad& quad) {
  if (!version_->trees_[0].Erase(KeyOf(quad, IndexOrder::kSpog), epoch_)) return false;
  for (int i = 1; i < kIndexOrders; ++i) version_->trees_[i].Erase(KeyOf(quad, IndexOrder(i)), epoch_);
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

std::vector<Quad> GraphWriter::AddAll(std::vector<Quad> quads) {
  using Placed = std::pair<Quad, size_t>;
  std::vector<Placed> fresh;
  fresh.reserve(quads.size());
  for (size_t i = 0; i < quads.size(); ++i) fresh.emplace_back(quads[i], i);
  std::sort(fresh.begin(), fresh.end());
  const auto repeats = std::unique(fresh.begin(), fresh.end(),
                                   [](const Placed& a, const Placed& b) { return a.first == b.first; });
  fresh.erase(repeats, fresh.end());
  if (version_->size() > 0) {
    QuadCursor cursor;
    std::erase_if(fresh, [&](const Placed& placed) {
      const Quad& quad = placed.first;
      version_->Rescan({quad.subject, quad.predicate, quad.object, quad.graph}, &cursor);
      return cursor.Valid();
    });
  }
  std::vector<QuadTree::Key> keys(fresh.size());
  for (int i = 0; i < kIndexOrders; ++i) {
    for (size_t j = 0; j < fresh.size(); ++j) keys[j] = KeyOf(fresh[j].first, IndexOrder(i));
    if (i > 0) std::sort(keys.begin(), keys.end());
    QuadTree::Edit::InsertSorted(&version_->trees_[i], keys, epoch_);
  }
  if (fresh.size() == quads.size()) return quads;
  std::sort(fresh.begin(), fresh.end(), [](const Placed& a, const Placed& b) { return a.second < b.second; });
  quads.clear();
  for (const Placed& placed : fresh) quads.push_back(placed.first);
  return quads;
}

GraphVersionPtr GraphWriter::Freeze(Revision revision) {
  version_->revision_ = revision;
  start_.reset(new GraphVersion(*version_));
  epoch_ = QuadTree::NewEpoch();
  return start_;
}

void GraphWriter::Rollback() {
  version_.reset(new GraphVersion(*start_));
  epoch_ = QuadTree::NewEpoch();
}

}  // namespace docent
