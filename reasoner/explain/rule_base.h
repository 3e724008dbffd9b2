// The rules of the server as clauses with heads, for reasoning backward from a fact. Immutable after Make; any
// thread reads.
#ifndef DOCENT_REASONER_EXPLAIN_RULE_BASE_H_
#define DOCENT_REASONER_EXPLAIN_RULE_BASE_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/quad.h"
#include "reasoner/explain/condition_form.h"
#include "reasoner/explain/rule_text.h"
#include "reasoner/rules/equality_rules.h"
#include "reasoner/rules/rule_program.h"

namespace docent::explain {

struct RuleInfo {
  std::string label;  // "guide.rules rule 1 (line 5)", as RuleEngine names it
  std::string set;
  int line = 0;
};

// One alternative of a rule's body, with the facts that the rule makes of its solutions.
struct RuleClause {
  uint32_t rule = 0;  // in RuleBase::rules
  Clause body;
  std::vector<Atom> heads;  // over body's variables; the graph is left open
  // What it is for: a count is looked up to prove something, and written out (count_form.h) to find what to tell.
  bool proves = true, tells = true;
  std::optional<rules::EqualityRule> equality;  // the rule is this one
  // Of the body and of those of rules that may make a fact for it: whether an absence is in it, and its predicates
  // (none: any).
  bool rests_on_absence = false;
  absl::flat_hash_set<TermId> rests_on;
};

class RuleBase {
 public:
  struct Head {
    uint32_t clause = 0;
    uint32_t head = 0;
  };

  // INVALID_ARGUMENT where a text is not one that RuleEngine would take.
  static absl::StatusOr<std::shared_ptr<const RuleBase>> Make(const std::vector<RuleText>& sets,
                                                              Dictionary& dictionary, const Limits& limits);

  const rules::RuleSets& sets() const { return sets_; }
  // In the order of `sets`, as RuleProgram numbers them.
  const std::vector<RuleInfo>& rules() const { return rules_; }
  const std::vector<RuleClause>& clauses() const { return clauses_; }
  // Where the rules have all five of equality: their clauses, in the order of EqualityRule. Otherwise empty.
  const std::vector<uint32_t>& equality() const { return equality_; }
  // The heads that may make a fact with this predicate (none: any) and object, in order of the rules.
  void ForEachHead(TermId predicate, absl::FunctionRef<void(Head)> visit) const;
  // Whether a rule names this predicate, of rdf:type also this class, as what it makes.
  bool IsMadeByName(TermId predicate, TermId object) const;
  // Whether a check forbids facts of this form whatever else there is ("?x a owl:Nothing"). None: any.
  bool IsForbidden(const QuadPattern& fact) const;

 private:
  void MarkWhatClausesRestOn();
  void FindEquality();
  absl::Status Add(const std::string& set, const rules::Rule& rule, int number, Dictionary& dictionary);
  // The clauses of the last rule, by this body of it.
  absl::Status AddClauses(const rules::Rule& rule, const sparql::Algebra& body, bool proves, bool tells,
                          Dictionary& dictionary);

  rules::RuleSets sets_;
  std::vector<RuleInfo> rules_;
  std::vector<RuleClause> clauses_;
  absl::flat_hash_map<TermId, std::vector<Head>> by_predicate_;  // none: the predicate is a variable
  std::vector<uint32_t> equality_;
  std::vector<QuadPattern> forbidden_;
  TermId type_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_RULE_BASE_H_
