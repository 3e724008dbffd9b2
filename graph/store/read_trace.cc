#include "graph/store/read_trace.h"

#include "graph/store/index_order.h"

namespace docent {
namespace {

constexpr unsigned kAllPositions = 15;

Quad Bound(const Quad& quad, unsigned bound) {
  const auto word = [bound](unsigned position, TermId id) { return (bound & position) != 0 ? id : TermId(); };
  return {word(1, quad.subject), word(2, quad.predicate), word(4, quad.object), word(8, quad.graph)};
}

}  // namespace

thread_local constinit ReadTrace* ReadTrace::current_ = nullptr;

ReadTrace::Scope::Scope(ReadTrace* trace) : before_(current_) {
  current_ = trace;
}

ReadTrace::Scope::~Scope() {
  current_ = before_;
}

void ReadTrace::Add(const QuadPattern& pattern) {
  if (anything_ || (!pattern.predicate.IsNone() && predicates_.contains(pattern.predicate))) return;
  const unsigned bound = BoundIn(pattern);
  if (bound == 0) return AddAnything();
  bound_ |= 1u << bound;
  patterns_.insert({pattern.subject, pattern.predicate, pattern.object, pattern.graph});
  if (patterns_.size() > kMostPatterns) Widen();
}

void ReadTrace::Widen() {
  absl::erase_if(patterns_, [this](const Quad& pattern) {
    if (pattern.predicate.IsNone()) return false;
    predicates_.insert(pattern.predicate);
    return true;
  });
  if (patterns_.size() > kMostPatterns / 2 || predicates_.size() > kMostPatterns) AddAnything();
}

void ReadTrace::AddAnything() {
  anything_ = true;
  patterns_.clear();
  predicates_.clear();
}

bool ReadTrace::MayTouch(const Quad& changed) const {
  if (!whole()) return true;
  for (const TermId id : {changed.subject, changed.predicate, changed.object, changed.graph}) {
    if (id.InDictionary() && id.payload() >= terms_) return true;
  }
  if (predicates_.contains(changed.predicate)) return true;
  for (unsigned bound = 1; bound <= kAllPositions; ++bound) {
    if ((bound_ & 1u << bound) != 0 && patterns_.contains(Bound(changed, bound))) return true;
  }
  return false;
}

}  // namespace docent
