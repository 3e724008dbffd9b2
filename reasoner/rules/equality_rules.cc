#include "reasoner/rules/equality_rules.h"

#include <array>
#include <string>

#include "absl/strings/str_cat.h"
#include "graph/sparql/syntax/algebra_printer.h"

namespace docent::rules {
namespace {

// In the order of EqualityRule.
constexpr char kText[] = R"rules(
RULE { ?y owl:sameAs ?x } WHERE { ?x owl:sameAs ?y }
RULE { ?x owl:sameAs ?z } WHERE { ?x owl:sameAs ?y . ?y owl:sameAs ?z }
RULE { ?s2 ?p ?o } WHERE { ?s owl:sameAs ?s2 . ?s ?p ?o FILTER(?s != ?s2) }
RULE { ?s ?p2 ?o } WHERE { ?p owl:sameAs ?p2 . ?s ?p ?o FILTER(?p != ?p2) }
RULE { ?s ?p ?o2 } WHERE { ?o owl:sameAs ?o2 . ?s ?p ?o FILTER(?o != ?o2) }
)rules";

std::string TextOf(const Rule& rule) {
  std::string text;
  for (const sparql::TriplePattern& triple : rule.head)
    absl::StrAppend(&text, sparql::PrintTriple(triple), "\n");
  return absl::StrCat(text, sparql::PrintPattern(*rule.body.algebra));
}

std::array<std::string, kEqualityRules> Texts() {
  std::array<std::string, kEqualityRules> texts;
  const ParsedRules parsed = ParseRules(kText, "equality");
  for (size_t i = 0; i < texts.size(); ++i) texts[i] = TextOf(parsed.rules[i]);
  return texts;
}

}  // namespace

std::optional<EqualityRule> EqualityRuleOf(const Rule& rule) {
  static const auto& texts = *new std::array<std::string, kEqualityRules>(Texts());
  if (rule.head.size() != 1 || rule.body.algebra == nullptr) return std::nullopt;
  const std::string text = TextOf(rule);
  for (size_t i = 0; i < texts.size(); ++i) {
    if (text == texts[i]) return static_cast<EqualityRule>(i);
  }
  return std::nullopt;
}

}  // namespace docent::rules
