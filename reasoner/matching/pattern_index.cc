#include "reasoner/matching/pattern_index.h"

#include <bit>
#include <limits>

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
  entry.key = {pattern.constants.subject, pattern.constants.predicate, pattern.constants.object};
  entry.graph = pattern.constants.graph;
  entry.reference = reference;
  entry.equal = pattern.equal;
  Bucket& bucket = buckets_[entry.key];
  if (bucket.empty()) {
    const unsigned shape = ShapeOf(entry.key);
    ++shape_counts_[shape];
    shapes_ |= 1u << shape;
  }
  if (pattern.object_guard) {
    if (!bucket.guarded) bucket.guarded = std::make_unique<Guarded>();
    entry.bound = pattern.object_guard->bound;
    entry.side = IsLowerBound(pattern.object_guard->op) ? 1 : -1;
    (entry.side > 0 ? bucket.guarded->at_least : bucket.guarded->at_most).insert({entry.bound, handle});
  } else {
    entry.side = 0;
    entry.place = static_cast<uint32_t>(bucket.plain.size());
    bucket.plain.push_back(handle);
  }
  return handle;
}

void PatternIndex::Remove(Handle handle) {
  const Entry& entry = entries_[handle];
  const auto found = buckets_.find(entry.key);
  Bucket& bucket = found->second;
  if (entry.side != 0) {
    Guarded& guarded = *bucket.guarded;
    (entry.side > 0 ? guarded.at_least : guarded.at_most).erase({entry.bound, handle});
    if (guarded.at_least.empty() && guarded.at_most.empty()) bucket.guarded.reset();
  } else {
    const Handle last = bucket.plain.back();
    bucket.plain[entry.place] = last;
    entries_[last].place = entry.place;
    bucket.plain.pop_back();
  }
  if (bucket.empty()) {
    const unsigned shape = ShapeOf(entry.key);
    if (--shape_counts_[shape] == 0) shapes_ &= ~(1u << shape);
    buckets_.erase(found);
  }
  free_.push_back(handle);
}

void PatternIndex::VisitEntry(Handle handle, const Quad& quad,
                              absl::FunctionRef<void(Reference)> visit) const {
  const Entry& entry = entries_[handle];
  if (!entry.graph.IsNone() && entry.graph != quad.graph) return;
  if (EqualPositionsHold(entry.equal, quad)) visit(entry.reference);
}

void PatternIndex::VisitGuarded(const Guarded& guarded, const Quad& quad,
                                absl::FunctionRef<void(Reference)> visit) const {
  const NumberView view = ViewNumber(quad.object);
  if (view.kind == NumberView::Kind::kOther) return;
  const bool known = view.kind == NumberView::Kind::kNumber;
  for (const Bound& bound : guarded.at_least) {
    if (known && bound.value > view.value) break;
    VisitEntry(bound.handle, quad, visit);
  }
  for (auto it = guarded.at_most.rbegin(); it != guarded.at_most.rend(); ++it) {
    if (known && it->value < view.value) break;
    VisitEntry(it->handle, quad, visit);
  }
}

void PatternIndex::ForEachMatch(const Quad& quad, absl::FunctionRef<void(Reference)> visit) const {
  for (unsigned rest = shapes_; rest != 0; rest &= rest - 1) {
    const int shape = std::countr_zero(rest);
    const Key key = {(shape & 1) ? quad.subject : TermId(), (shape & 2) ? quad.predicate : TermId(),
                     (shape & 4) ? quad.object : TermId()};
    const auto found = buckets_.find(key);
    if (found == buckets_.end()) continue;
    for (const Handle handle : found->second.plain) VisitEntry(handle, quad, visit);
    if (found->second.guarded) VisitGuarded(*found->second.guarded, quad, visit);
  }
}

}  // namespace docent
