// The limits of regular expressions in queries, rules and shapes, beside graph/base/limits.h.
#ifndef DOCENT_GRAPH_BASE_REGEX_LIMITS_H_
#define DOCENT_GRAPH_BASE_REGEX_LIMITS_H_

#include <cstddef>
#include <cstdint>

namespace docent {

struct RegexLimits {
  size_t regex_pattern_bytes = 64u << 10;  // text of one expression
  int regex_nesting = 200;                 // groups inside groups, classes inside classes
  // Characters, classes, anchors, groups and alternatives of one expression, each counted as often as the quantifiers
  // around it repeat it: x{1000} is a thousand.
  uint64_t regex_instructions = 100'000;
  size_t regex_ranges = 100'000;  // ranges of characters in all classes of one expression
  // Bytes of text times instructions of the expression in one search. RE2 can't be cancelled, and does so many steps where the
  // expression has too many states to keep: measured 4 to 8 ns each (2026-11-23), so at most some seconds.
  uint64_t regex_steps = 1'000'000'000;
  // Steps of one search with back-references, which may take exponential time: a second or so.
  uint64_t regex_backtracking_steps = 100'000'000;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_REGEX_LIMITS_H_
