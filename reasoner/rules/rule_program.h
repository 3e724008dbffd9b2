// All rules of all sets, ready to run: bodies compiled, strata found, patterns indexed. For this
// folder and reasoner/explain. Writer thread only (bodies keep scratch space); after Build only Place changes it.
#ifndef DOCENT_REASONER_RULES_RULE_PROGRAM_H_
#define DOCENT_REASONER_RULES_RULE_PROGRAM_H_

#include <array>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/quad.h"
#include "reasoner/matching/body.h"
#include "reasoner/matching/pattern_index.h"
#include "reasoner/rules/fact_pattern.h"
#include "reasoner/rules/rule_parser.h"
#include "reasoner/rules/stratification.h"

namespace docent::rules {

struct Triple {
  TermId subject, predicate, object;
  friend constexpr auto operator<=>(const Triple&, const Triple&) = default;
  template <typename H>
  friend H AbslHashValue(H h, const Triple& t) {
    return H::combine(std::move(h), t.subject, t.predicate, t.object);
  }
};

// A triple of a head: constants, and columns of the body.
struct HeadTriple {
  std::array<TermId, 3> constants;
  std::array<int16_t, 3> columns = {matching::Trigger::kNoColumn, matching::Trigger::kNoColumn,
                                    matching::Trigger::kNoColumn};

  // False where the row does not make an RDF triple (unbound variable, literal as subject).
  bool Make(absl::Span<const TermId> row, Triple& out) const;
  // Extends `seed` by what makes this head `triple`; false if it cannot.
  bool SeedFrom(const Triple& triple, absl::Span<TermId> seed) const;
  QuadPattern Pattern() const { return {constants[0], constants[1], constants[2], TermId()}; }
};

// Whether some triple matches both, what stands for the same variable aside. The graphs do not count.
bool CanUnify(const QuadPattern& a, const QuadPattern& b);

struct CompiledRule {
  std::string label;  // "owl2rl prp-dom (line 40)", "s01.rules rule 3 (line 12)"
  std::string name;   // the last part of its IRI: "prp-dom"; empty without one
  std::string set;
  std::string text;  // canonical: rules of the same set and text are the same rule
  SourceSpan span;
  std::vector<HeadTriple> head;
  std::unique_ptr<matching::Body> body;
  int stratum = 0;
  bool check = false;     // no head: each solution is an inconsistency
  bool positive = false;  // a conjunction of patterns without EXISTS: what its triples prove
  uint32_t patterns = 0;  // bit set: all of a positive body
  // Those of them that speak of the schema, if others do not: the SchemaIndex knows their solutions. Else 0.
  uint32_t schema = 0;
  bool filters = false;      // there are filters that the schema part alone does not decide
  bool of_schema = false;    // positive, and all of its patterns speak of the schema
  bool of_equality = false;  // what it makes is written out by EqualityClasses; it is never evaluated

  // The triple that a solution matches with pattern `i` of a flat body.
  Triple Premise(size_t i, absl::Span<const TermId> row) const;
  // Why evaluating it ended, with its label; OK as it is.
  absl::Status Named(absl::Status status) const;
};

// Of axioms that know all but their subject or their object: which these are.
using AxiomAnswers = absl::flat_hash_map<FactPattern, std::vector<TermId>>;

// Levels are strata above the first of those of the rules that are entangled.
struct NegationOrder {
  std::vector<int> of_rules;                       // of RuleProgram::ordered, from 1
  absl::flat_hash_map<FactPattern, int> of_facts;  // from 1; others: 0
  absl::flat_hash_set<TermId> with_subjects;       // predicates of those that know a subject
  AxiomAnswers asked;  // what the order rests on beside the instances of the SchemaIndex

  bool IsSame(const NegationOrder& other) const {
    return of_rules == other.of_rules && of_facts == other.of_facts;
  }
};

using RuleSets = std::map<std::string, std::shared_ptr<const ParsedRules>>;

class RuleProgram {
 public:
  // Null and diagnostics (negation through recursion with its cycle, unknown functions) where it cannot be
  // run.
  static std::shared_ptr<RuleProgram> Build(const RuleSets& sets, Dictionary& dictionary,
                                            const sparql::FunctionRegistry* functions,
                                            Diagnostics& diagnostics);

  // Rules with negation that would depend on themselves if the axioms were such: the axioms decide which of them comes after
  // which (negation_order.h). They, and all other rules that are entangled with them, run in several strata, and make in each
  // the facts of its level.
  std::vector<uint32_t> ordered;
  bool Place(NegationOrder order);  // whether it is another one
  const NegationOrder& order() const { return order_; }
  uint64_t placed_for = 0;  // SchemaIndex::changes() of the axioms that the order is for; 0: of none
  // The strata in which they run; empty (0 to -1) where there are none.
  int first_entangled = 0, last_entangled = -1;
  bool IsEntangled(uint32_t rule) const { return component_[rule] == entangled_; }
  bool Runs(uint32_t rule, int stratum) const {
    return rules[rule].stratum == stratum ||
           (IsEntangled(rule) && rules[rule].stratum < stratum && stratum <= last_entangled);
  }
  // Whether the rules of equality are there, all five of them, and which speak for them in messages.
  struct Equality {
    bool by_classes = false;
    uint32_t transitivity = 0, replacement = 0;
    TermId same_as;
  };
  Equality equality;
  bool ClosesEquality(int stratum) const {
    return equality.by_classes && Runs(equality.replacement, stratum);
  }
  // Where it is entangled rules that make it.
  int StratumOf(const Triple& fact) const;

  std::vector<CompiledRule> rules;
  int stratum_count = 0;
  std::vector<std::vector<uint32_t>> rules_of_stratum;
  matching::PatternIndex
      triggers;  // reference: rule, trigger of its body; of rules with a schema part those alone
  matching::PatternIndex schema_triggers;  // the latter again
  matching::PatternIndex heads;  // reference: rule, triple of its head; not of rules with a schema part

 private:
  bool Compile(const RuleSets& sets, Dictionary& dictionary, const sparql::FunctionRegistry* functions,
               Diagnostics& diagnostics);
  void FindEquality(const RuleSets& sets, Dictionary& dictionary);
  bool FindOrdered(Diagnostics& diagnostics);
  void Index();

  std::vector<RuleDependency> dependencies_;
  std::vector<int> component_;  // of each rule: of the dependencies, those depended on first
  int component_count_ = 0;
  int entangled_ = -1;  // the component of `ordered`
  NegationOrder order_;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_RULE_PROGRAM_H_
