// Built-in rule sets, as `.rules` text: `rdfs` and `owl2rl`.
//
// They are ordinary documents of the rule language: loaded, replaced, removed, previewed and logged like a
// user's own. Each rule has its name from the W3C table; docs/reference/rules.md lists the covered rules and
// how they are implemented. Pure; any thread.
#ifndef DOCENT_REASONER_RULES_RULE_SETS_H_
#define DOCENT_REASONER_RULES_RULE_SETS_H_

#include <string>
#include <string_view>
#include <vector>

namespace docent::rules {

// Names, in display order.
std::vector<std::string> BuiltInRuleSets();
// Empty if no set has this name.
std::string BuiltInRuleSet(std::string_view name);

// The IRIs of the entailment regimes that the graph follows under the built-in set of this name; none for another
// name.
std::vector<std::string> EntailmentRegimes(std::string_view name);

// Longest lists for which owl2rl has a rule of that length: classes of one intersection (cls-int1; longer
// ones go cell by cell), properties of one chain (prp-spo2) and of one key (prp-key). With these, a body has at most
// 32 patterns, which are joined on ids (reasoner/matching/body.h).
inline constexpr int kIntersectionClasses = 10;
inline constexpr int kChainProperties = 8;
inline constexpr int kKeyProperties = 6;

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_RULE_SETS_H_
