#include "reasoner/matching/pattern_index.h"

#include <bit>
#include <utility>

#include "absl/hash/hash.h"

namespace docent {
namespace {

bool EqualPositionsHold(uint8_t equal, const Quad& q) {
  if (equal == 0) return true;
  return (!(equal & MatchPattern::kSubjectPredicate) || q.subject == q.predicate) &&
         (!(equal & MatchPattern::kSubjectObject) || q.subject == q.object) &&
         (!(equal & MatchPattern::kPredicateObject) || q.predicate == q.object) &&
         (!(equal & MatchPattern::kSubjectGraph) || q.subject == q.graph) &&
         (!(equal & MatchPattern::kPredicateGraph) || q.predicate == q.graph) &&
         (!(equal & MatchPattern::kObjectGraph) || q.object == q.graph);
}

bool IsLowerBound(Comparison op) {
  return op == Comparison::kGreater || op == Comparison::kGreaterOrEqual;
}

}  // namespace

bool MatchPattern::Matches(const Quad& quad) const {
  if (!constants.Matches(quad) || !EqualPositionsHold(equal, quad)) return false;
  if (!object_guard) return true;
  const NumberView view = ViewNumber(quad.object);
  if (view.kind != NumberView::Kind::kNumber) return view.kind == NumberView::Kind::kUnknown;
  return IsLowerBound(object_guard->op) ? view.value >= object_guard->bound
                                        : view.value <= object_guard->bound;
}

unsigned PatternIndex::ShapeOf(const Key& key) {
  return (key.subject.IsNone() ? 0u : 1u) | (key.predicate.IsNone() ? 0u : 2u) |
         (key.object.IsNone() ? 0u : 4u);
}

PatternIndex::Handle PatternIndex::Add(const MatchPattern& pattern, Reference reference) {
  Handle handle;
  if (free_.empty()) {
    handle = static_cast<Handle>(entries_.size());
    entries_.emplace_back();
  } else {
    handle = free_.back();
    free_.pop_back();
  }
  Entry& entry = entries_[handle];
  entry = {.key = {pattern.constants.subject, pattern.constants.predicate, pattern.constants.object},
           .graph = pattern.constants.graph,
           .reference = reference,
           .equal = pattern.equal};
  const unsigned shape = ShapeOf(entry.key);
  if (shape_counts_[shape]++ == 0) shapes_ |= 1u << shape;
  const size_t hash = absl::HashOf(entry.key);
  if (pattern.object_guard) {
    std::unique_ptr<Guarded>& guarded = guarded_[hash];
    if (!guarded) guarded = std::make_unique<Guarded>();
    entry.bound = pattern.object_guard->bound;
    entry.side = IsLowerBound(pattern.object_guard->op) ? 1 : -1;
    (entry.side > 0 ? guarded->at_least : guarded->at_most).insert({entry.bound, handle});
    return handle;
  }
  const auto [place, fresh] = first_.try_emplace(hash, handle);
  Entry& first = entries_[place->second];
  if (!fresh) {
    entry.previous = first.previous;
    entries_[entry.previous].next = handle;
  }
  first.previous = handle;
  return handle;
}

void PatternIndex::Remove(Handle handle) {
  const Entry& entry = entries_[handle];
  const unsigned shape = ShapeOf(entry.key);
  if (--shape_counts_[shape] == 0) shapes_ &= ~(1u << shape);
  free_.push_back(handle);
  if (entry.side != 0) {
    const auto found = guarded_.find(absl::HashOf(entry.key));
    Guarded& guarded = *found->second;
    (entry.side > 0 ? guarded.at_least : guarded.at_most).erase({entry.bound, handle});
    if (guarded.at_least.empty() && guarded.at_most.empty()) guarded_.erase(found);
    return;
  }
  Entry& previous = entries_[entry.previous];
  const bool is_first = previous.next == kNone, is_last = entry.next == kNone;
  if (!is_first) previous.next = entry.next;
  if (!is_last) entries_[entry.next].previous = entry.previous;
  if (!is_first && !is_last) return;
  const auto place = first_.find(absl::HashOf(entry.key));
  if (!is_first) {
    entries_[place->second].previous = entry.previous;
  } else if (!is_last) {
    place->second = entry.next;
  } else {
    first_.erase(place);
  }
}

void PatternIndex::VisitEntry(const Entry& entry, const Key& key, const Quad& quad,
                              absl::FunctionRef<void(Reference)> visit) const {
  if (entry.key != key || (!entry.graph.IsNone() && entry.graph != quad.graph)) return;
  if (EqualPositionsHold(entry.equal, quad)) visit(entry.reference);
}

void PatternIndex::VisitGuarded(const Guarded& guarded, const Key& key, const Quad& quad,
                                absl::FunctionRef<void(Reference)> visit) const {
  const NumberView view = ViewNumber(quad.object);
  if (view.kind == NumberView::Kind::kOther) return;
  const bool known = view.kind == NumberView::Kind::kNumber;
  for (const Bound& bound : guarded.at_least) {
    if (known && bound.value > view.value) break;
    VisitEntry(entries_[bound.handle], key, quad, visit);
  }
  for (auto it = guarded.at_most.rbegin(); it != guarded.at_most.rend(); ++it) {
    if (known && it->value < view.value) break;
    VisitEntry(entries_[it->handle], key, quad, visit);
  }
}

void PatternIndex::ForEachMatch(const Quad& quad, absl::FunctionRef<void(Reference)> visit) const {
  for (unsigned rest = shapes_; rest != 0; rest &= rest - 1) {
    const int shape = std::countr_zero(rest);
    const Key key = {(shape & 1) ? quad.subject : TermId(), (shape & 2) ? quad.predicate : TermId(),
                     (shape & 4) ? quad.object : TermId()};
    const size_t hash = absl::HashOf(key);
    if (const auto first = first_.find(hash); first != first_.end()) {
      for (Handle handle = first->second; handle != kNone; handle = entries_[handle].next) {
        VisitEntry(entries_[handle], key, quad, visit);
      }
    }
    if (guarded_.empty()) continue;
    if (const auto found = guarded_.find(hash); found != guarded_.end()) VisitGuarded(*found->second, key, quad, visit);
  }
}

}  // namespace docent
