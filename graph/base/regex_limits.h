// Limits of regular expressions in queries, rules and shapes, beside graph/base/limits.h.
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
  // Bytes of text times instructions in one search. RE2 cannot be cancelled, and needs as many steps if it
  // cannot cache all states: 4 to 8 ns each (measured 2026-11-23), some seconds at most.
  uint64_t regex_steps = 1'000'000'000;
  // Steps of one search with back-references, which may take exponential time: about a second.
  uint64_t regex_backtracking_steps = 100'000'000;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_REGEX_LIMITS_H_
