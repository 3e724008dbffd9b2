// The limits of regular expressions in queries, beside graph/base/limits.h.
#ifndef DOCENT_GRAPH_BASE_REGEX_LIMITS_H_
#define DOCENT_GRAPH_BASE_REGEX_LIMITS_H_

#include <cstdint>

namespace docent {

struct RegexLimits {
  // Bytes of text times instructions of the expression in one search. RE2 can't be cancelled, and does so many steps where the
  // expression has too many states to keep: measured 4 to 8 ns each (2026-11-23), so at most some seconds.
  uint64_t regex_steps = 1'000'000'000;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_REGEX_LIMITS_H_
