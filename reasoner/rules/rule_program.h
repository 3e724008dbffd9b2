// All rules of all sets, compiled: bodies, strata and pattern indexes. For this folder and reasoner/explain.
// Writer thread only (bodies keep scratch space); after Build only Place changes it.
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
#include "reasoner/rules/report_words.h"
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

  // False if the row gives no RDF triple (unbound variable, literal as subject).
  bool Make(absl::Span<const TermId> row, Triple& out) const;
  // Binds in `seed` the columns with which this head gives `triple`; false if it cannot.
  bool SeedFrom(const Triple& triple, absl::Span<TermId> seed) const;
  QuadPattern Pattern() const { return {constants[0], constants[1], constants[2], TermId()}; }
};

// True if some triple matches both, ignoring repeated variables and graphs.
bool CanUnify(const QuadPattern& a, const QuadPattern& b);

struct CompiledRule {
  std::string label;  // "owl2rl prp-dom (line 40)", "s01.rules rule 3 (line 12)"
  std::string name;   // the last part of its IRI: "prp-dom"; empty without one
  std::string set;
  std::string text;  // canonical: rules of the same set and text are the same rule
  SourceSpan span;
  std::vector<HeadTriple> head;
  std::vector<HeadTriple> reports;  // of a check: the forms of its reports' facts; they have no columns
  std::unique_ptr<matching::Body> body;
  int stratum = 0;
  bool check = false;     // no head: each solution is an inconsistency
  bool positive = false;  // a conjunction of patterns without EXISTS: its triples prove the head
  uint32_t patterns = 0;  // bit set: all of a positive body
  // The patterns about the schema, if there are others as well: the SchemaIndex holds their solutions. Else
  // 0.
  uint32_t schema = 0;
  bool filters = false;      // some filters are not decided by the schema part alone
  bool of_schema = false;    // positive, and all of its patterns are about the schema
  bool of_equality = false;  // EqualityClasses writes its results; it is never evaluated

  bool negates_itself = false;  // a check: what it negates or aggregates may be its own reports

  // What it makes.
  const std::vector<HeadTriple>& conclusions() const { return check ? reports : head; }
  // The triple that a solution matches with pattern `i` of a flat body.
  Triple Premise(size_t i, absl::Span<const TermId> row) const;
  // The status with the rule's label in front; OK stays OK.
  absl::Status Named(absl::Status status) const;
};

// Values of the unknown subject or object of axiom patterns.
using AxiomAnswers = absl::flat_hash_map<FactPattern, std::vector<TermId>>;

// Levels count strata from the first stratum of the entangled rules.
struct NegationOrder {
  std::vector<int> of_rules;                       // of RuleProgram::ordered, from 1
  absl::flat_hash_map<FactPattern, int> of_facts;  // from 1; others: 0
  absl::flat_hash_set<TermId> with_subjects;       // predicates of patterns with a known subject
  bool late_reports = false;  // no order with what general rules make of reports: see RuleProgram::IsLate
  AxiomAnswers asked;         // basis of the order, in addition to the instances of the SchemaIndex

  bool IsSame(const NegationOrder& other) const {
    return of_rules == other.of_rules && of_facts == other.of_facts && late_reports == other.late_reports;
  }
};

using RuleSets = std::map<std::string, std::shared_ptr<const ParsedRules>>;

class RuleProgram {
 public:
  // Null and diagnostics (negation through recursion with its cycle, unknown functions) if the rules cannot
  // run, or are new and go beyond rule_dependencies.
  static std::shared_ptr<RuleProgram> Build(const RuleSets& sets, Dictionary& dictionary,
                                            const sparql::FunctionRegistry* functions,
                                            Diagnostics& diagnostics,
                                            RuleTextOrigin origin = RuleTextOrigin::kAccepted);

  // Rules with negation that would depend on themselves under some axioms: the existing axioms decide their
  // order (negation_order.h). They, and all rules entangled with them, run in several strata; in each they
  // make the facts of its level.
  std::vector<uint32_t> ordered;
  bool Place(NegationOrder order);  // true if the order has changed
  const NegationOrder& order() const { return order_; }
  uint64_t placed_for = 0;  // SchemaIndex::changes() of the axioms on which the order is based; 0: none
  // The strata in which they run; empty (0 to -1) if there are none.
  int first_entangled = 0, last_entangled = -1;
  bool IsEntangled(uint32_t rule) const { return component_[rule] == entangled_; }
  bool Runs(uint32_t rule, int stratum) const {
    return rules[rule].stratum == stratum ||
           (IsEntangled(rule) && rules[rule].stratum < stratum && stratum <= last_entangled);
  }
  // A check whose reports only come after the rules that do not name them: `?s ?p ?o` or `?x a ?c` would also
  // match a report, but the check (or with late_reports: any check) needs what those rules make. So such a
  // rule takes them where they are made, in the stratum of the check. Patterns that name reports
  // (ReportWords) always come after them.
  bool IsLate(const CompiledRule& rule) const {
    return rule.check && (rule.negates_itself || order_.late_reports);
  }
  bool AnyIsLate() const { return any_negates_itself_ || order_.late_reports; }
  ReportWords report_words;  // none without checks
  // The equality rules: true if all five are present, and the rules named in messages.
  struct Equality {
    bool by_classes = false;
    uint32_t transitivity = 0, replacement = 0;
    TermId same_as;
  };
  Equality equality;
  bool ClosesEquality(int stratum) const {
    return equality.by_classes && Runs(equality.replacement, stratum);
  }
  // The stratum of a fact made by entangled rules.
  int StratumOf(const Triple& fact) const;

  std::vector<CompiledRule> rules;
  int stratum_count = 0;
  std::vector<std::vector<uint32_t>> rules_of_stratum;
  matching::PatternIndex
      triggers;  // reference: rule, trigger of its body; rules with a schema part: those of that part only
  matching::PatternIndex schema_triggers;  // only those of schema parts
  matching::PatternIndex heads;  // reference: rule, triple of its head; not of rules with a schema part

 private:
  bool Compile(const RuleSets& sets, Dictionary& dictionary, const sparql::FunctionRegistry* functions,
               Diagnostics& diagnostics);
  void AddReports(Dictionary& dictionary, CompiledRule& check);
  void FindEquality(const RuleSets& sets, Dictionary& dictionary);
  bool FindOrdered(Diagnostics& diagnostics);
  void Index();

  std::vector<RuleDependency> dependencies_;
  std::vector<int> component_;  // of each rule in the dependencies; a dependency has a lower number
  int component_count_ = 0;
  int entangled_ = -1;  // the component of `ordered`
  bool any_negates_itself_ = false;
  NegationOrder order_;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_RULE_PROGRAM_H_
