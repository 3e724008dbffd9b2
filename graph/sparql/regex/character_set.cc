#include "graph/sparql/regex/character_set.h"

#include <algorithm>
#include <utility>

namespace docent::sparql {
namespace {

using Range = CharacterSet::Range;

constexpr char32_t kLast = 0x10FFFF;
constexpr Range kSurrogates = {0xD800, 0xDFFF};

// Appends `range` without the surrogates in it.
void AppendScalars(const Range& range, std::vector<Range>* out) {
  if (range.first > range.last) return;
  if (range.last < kSurrogates.first || range.first > kSurrogates.last) return out->push_back(range);
  if (range.first < kSurrogates.first) out->push_back({range.first, kSurrogates.first - 1});
  if (range.last > kSurrogates.last) out->push_back({kSurrogates.last + 1, range.last});
}

}  // namespace

CharacterSet CharacterSet::Of(std::vector<Range> ranges) {
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.first < b.first; });
  std::vector<Range> merged;
  for (const Range& range : ranges) {
    if (!merged.empty() && range.first <= merged.back().last + 1) {
      merged.back().last = std::max(merged.back().last, range.last);
    } else {
      merged.push_back(range);
    }
  }
  CharacterSet set;
  for (const Range& range : merged) AppendScalars(range, &set.ranges_);
  for (const Range& range : set.ranges_) {
    for (char32_t c = range.first; c <= range.last && c < 128; ++c)
      set.ascii_[c >> 6] |= uint64_t{1} << (c & 63);
  }
  return set;
}

bool CharacterSet::ContainsLarge(char32_t c) const {
  const auto after = std::upper_bound(ranges_.begin(), ranges_.end(), c,
                                      [](char32_t value, const Range& range) { return value < range.first; });
  return after != ranges_.begin() && c <= std::prev(after)->last;
}

CharacterSet CharacterSet::Complement() const {
  std::vector<Range> out;
  char32_t next = 0;
  for (const Range& range : ranges_) {
    if (range.first > next) out.push_back({next, range.first - 1});
    next = range.last + 1;
  }
  if (next <= kLast) out.push_back({next, kLast});
  return Of(std::move(out));
}

CharacterSet CharacterSet::Minus(const CharacterSet& other) const {
  // a - b is all but (all but a) and b
  std::vector<Range> outside = Complement().ranges_;
  outside.insert(outside.end(), other.ranges_.begin(), other.ranges_.end());
  return Of(std::move(outside)).Complement();
}

}  // namespace docent::sparql
