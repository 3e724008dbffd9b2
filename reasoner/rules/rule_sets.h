// The rule sets that come with the server, as `.rules` text: `rdfs` and `owl2rl`.
//
// They are ordinary documents of the rule language: loaded, replaced, removed, previewed and logged like a
// user's own. Each rule bears the name that its W3C table gives it; which rules are covered, and how, stands
// in docs/reference/rules.md. Pure; any thread.
#ifndef DOCENT_REASONER_RULES_RULE_SETS_H_
#define DOCENT_REASONER_RULES_RULE_SETS_H_

#include <string>
#include <string_view>
#include <vector>

namespace docent::rules {

// Names, in the order in which people should see them.
std::vector<std::string> BuiltInRuleSets();
// Empty if there is none of that name.
std::string BuiltInRuleSet(std::string_view name);

// Longest lists that have a rule of their own length in owl2rl: classes of one intersection (cls-int1; longer
// ones go cell by cell), properties of one chain (prp-spo2) and of one key (prp-key). A body has at most 32
// patterns.
inline constexpr int kIntersectionClasses = 10;
inline constexpr int kChainProperties = 8;
inline constexpr int kKeyProperties = 6;

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_RULE_SETS_H_
