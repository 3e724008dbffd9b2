// Limits of rules and of the patterns of standing queries. The rules of limits.h hold here; a separate header, because few
// files include it. They cannot be configured: all servers accept the same rules.
#ifndef DOCENT_GRAPH_BASE_RULE_LIMITS_H_
#define DOCENT_GRAPH_BASE_RULE_LIMITS_H_

#include <cstddef>

namespace docent {

struct RuleLimits {
  size_t rule_patterns = 10000;         // triple patterns in the body of one rule
  size_t rule_dependencies = 10000000;  // pairs of rules of which one may use what the other derives
  size_t body_variables = 32000;  // variables in the body of one rule, in one condition or subscribed query
};

inline constexpr RuleLimits kRuleLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_RULE_LIMITS_H_
