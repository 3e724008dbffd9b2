// The five equality rules of OWL 2 RL (W3C OWL 2 Profiles, table 4: eq-sym, eq-trans, eq-rep-s, eq-rep-p,
// eq-rep-o), in the rule language. If a program has all of them, EqualityClasses replaces their evaluation.
// For this folder and reasoner/explain. Pure; any thread.
#ifndef DOCENT_REASONER_RULES_EQUALITY_RULES_H_
#define DOCENT_REASONER_RULES_EQUALITY_RULES_H_

#include <cstdint>
#include <optional>
#include <string_view>

#include "reasoner/rules/rule_parser.h"

namespace docent::rules {

inline constexpr std::string_view kOwlSameAs = "http://www.w3.org/2002/07/owl#sameAs";

enum class EqualityRule : uint8_t { kSymmetry, kTransitivity, kSubject, kPredicate, kObject };
inline constexpr int kEqualityRules = 5;

// nullopt: another rule. The rule's name is ignored, the names of its variables matter.
std::optional<EqualityRule> EqualityRuleOf(const Rule& rule);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_EQUALITY_RULES_H_
