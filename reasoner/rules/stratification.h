// Strata of a rule program: a rule is evaluated after the rules that it negates (datalog with stratified
// negation).
//
// Rule A depends on rule B if a head of B can make a triple that a pattern of A's body matches; constants are
// compared position by position. So `?r a ex:Free` may negate `?r a ex:Busy`, although both are about
// rdf:type.
#ifndef DOCENT_REASONER_RULES_STRATIFICATION_H_
#define DOCENT_REASONER_RULES_STRATIFICATION_H_

#include <cstdint>
#include <vector>

namespace docent::rules {

// rules[a] uses facts that rules[b] derives.
struct RuleDependency {
  uint32_t from = 0;  // a
  uint32_t to = 0;    // b
  bool negative = false;
  bool by_axioms = false;  // only with certain axioms
};

struct Stratification {
  std::vector<int> stratum;  // by rule; dependencies are in the same or a lower stratum
  int count = 0;
  // If not empty, there are no strata: rules r0, r1, …, each depends on the next and the last on the first,
  // r0 negatively on r1.
  std::vector<uint32_t> negative_cycle;
};

// By rule: those on which it depends.
using DependencyGraph = std::vector<std::vector<uint32_t>>;
DependencyGraph GraphOf(uint32_t rule_count, const std::vector<RuleDependency>& dependencies);

// Rules r0 = `rule`, r1, …, each depends on the next and the last on the first, as few as there can be; empty if there is no
// such cycle. It looks at each dependency once.
std::vector<uint32_t> CycleThrough(uint32_t rule, const DependencyGraph& graph);

// Strata are the strongly connected components (Tarjan, SIAM J. Comput. 1972) in the order of dependency.
// Iterative, any size.
Stratification Stratify(uint32_t rule_count, const std::vector<RuleDependency>& dependencies);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_STRATIFICATION_H_
