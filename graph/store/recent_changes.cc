#include "graph/store/recent_changes.h"

#include <algorithm>
#include <utility>

namespace docent {
namespace {

// nullopt if the dictionary lacks one of the terms: then no quad has it.
std::optional<QuadPattern> ToIds(const ReadPattern& read, const Dictionary& dictionary) {
  QuadPattern pattern;
  for (auto [term, id] : {std::pair{&read.subject, &pattern.subject},
                          {&read.predicate, &pattern.predicate},
                          {&read.object, &pattern.object},
                          {&read.graph, &pattern.graph}}) {
    if (!*term) continue;
    const std::optional<TermId> found = dictionary.Find(**term);
    if (!found) return std::nullopt;
    *id = *found;
  }
  return pattern;
}

}  // namespace

void RecentChanges::Add(Revision revision, const Delta& delta) {
  if (delta.size() >= quad_limit_) return Clear();  // readers of older versions must read again
  quads_ += delta.size();
  changes_.push_back({revision, delta});
  // An empty change costs an entry, too.
  while (!changes_.empty() && quads_ + changes_.size() > quad_limit_) {
    quads_ -= changes_.front().delta.size();
    changes_.pop_front();
  }
}

bool RecentChanges::Touched(Revision since, const std::vector<ReadPattern>& reads,
                            const Dictionary& dictionary) const {
  if (reads.empty()) return false;
  if (changes_.empty() || changes_.front().revision.value() > since.value() + 1) return true;
  std::vector<QuadPattern> patterns;
  for (const ReadPattern& read : reads) {
    if (std::optional<QuadPattern> ids = ToIds(read, dictionary)) patterns.push_back(*ids);
  }
  const auto touches = [&patterns](const Quad& quad) {
    return std::any_of(patterns.begin(), patterns.end(),
                       [&quad](const QuadPattern& p) { return p.Matches(quad); });
  };
  for (auto it = changes_.rbegin(); it != changes_.rend() && it->revision > since; ++it) {
    for (const std::vector<Quad>* quads : {&it->delta.added, &it->delta.removed}) {
      if (std::any_of(quads->begin(), quads->end(), touches)) return true;
    }
  }
  return false;
}

void RecentChanges::Clear() {
  changes_.clear();
  quads_ = 0;
}

}  // namespace docent
