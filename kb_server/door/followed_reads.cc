#include "kb_server/door/followed_reads.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::server {

FollowedReads::Begun FollowedReads::Begin() {
  Begun begun;
  begun.trace = std::make_shared<ReadTrace>(dictionary_.size());
  absl::MutexLock lock(&mutex_);
  if (traces_.size() >= drop_gone_at_) {
    absl::erase_if(traces_, [](const auto& one) { return one.second.expired(); });
    drop_gone_at_ = 2 * traces_.size() + 64;
  }
  begun.name = absl::StrCat(++last_name_);
  traces_.emplace(begun.name, begun.trace);
  return begun;
}

std::shared_ptr<ReadTrace> FollowedReads::Find(std::string_view name) {
  absl::MutexLock lock(&mutex_);
  const auto found = traces_.find(ToAbsl(name));
  return found == traces_.end() ? nullptr : found->second.lock();
}

void FollowedReads::Keep(bool keep) {
  absl::MutexLock lock(&mutex_);
  if (keeps_ == keep) return;
  keeps_ = keep;
  kept_after_ = newest_;
  turns_.clear();
}

void FollowedReads::Add(const GraphVersion& version, const std::vector<const Delta*>& turns, bool others) {
  const uint64_t revision = version.revision().value();
  {
    absl::MutexLock lock(&mutex_);
    const bool back = revision < newest_;  // after a recovery
    newest_ = revision;
    if (back) turns_.clear();
    if (back) kept_after_ = revision;
    if (!keeps_) return;
  }
  Turn turn = Summary(version, turns, others);
  absl::MutexLock lock(&mutex_);
  if (kept_after_ >= revision) return;  // it is kept only since a moment ago
  turns_.push_back(std::move(turn));
  if (turns_.size() <= kMostTurns) return;
  kept_after_ = turns_.front().revision;
  turns_.pop_front();
}

FollowedReads::Turn FollowedReads::Summary(const GraphVersion& version,
                                           const std::vector<const Delta*>& turns, bool others) {
  Turn summary;
  summary.revision = version.revision().value();
  size_t size = 0;
  for (const Delta* delta : turns) size += delta->size();
  summary.anything = others || size > kMostQuads;
  if (summary.anything) return summary;
  absl::flat_hash_map<TermId, int64_t> of_graph, of_predicate;  // how many more quads they have
  const auto add = [&](const std::vector<Quad>& quads, int64_t more) {
    for (const Quad& quad : quads) {
      summary.quads.push_back(quad);
      of_graph[quad.graph] += more;
      of_predicate[quad.predicate] += more;
    }
  };
  for (const Delta* delta : turns) {
    add(delta->added, 1);
    add(delta->removed, -1);
  }
  const auto came_or_went = [&version](const QuadPattern& pattern, int64_t more) {
    const auto count = static_cast<int64_t>(version.Count(pattern));
    return (count == 0) != (count == more);
  };
  for (const auto& [graph, more] : of_graph)
    summary.names = summary.names || came_or_went({{}, {}, {}, graph}, more);
  for (const auto& [predicate, more] : of_predicate)
    summary.names = summary.names || came_or_went({{}, predicate, {}, {}}, more);
  return summary;
}

bool FollowedReads::MayHaveChanged(const ReadTrace& trace, uint64_t after, uint64_t until) const {
  if (!trace.whole()) return true;
  absl::ReaderMutexLock lock(&mutex_);
  if (!keeps_ || after < kept_after_ || until < after || until > newest_) return true;
  const auto touches = [&trace](const Turn& turn) {
    return turn.anything || (turn.names && trace.MayTouchNames()) ||
           std::any_of(turn.quads.begin(), turn.quads.end(),
                       [&trace](const Quad& quad) { return trace.MayTouch(quad); });
  };
  for (auto turn = turns_.rbegin(); turn != turns_.rend() && turn->revision > after; ++turn) {
    if (turn->revision <= until && touches(*turn)) return true;
  }
  return false;
}

}  // namespace docent::server
