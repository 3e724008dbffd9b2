// The server's rules as clauses with heads, for backward reasoning from a fact. Immutable after Make; any
// thread reads.
#ifndef DOCENT_REASONER_EXPLAIN_RULE_BASE_H_
#define DOCENT_REASONER_EXPLAIN_RULE_BASE_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
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

// One alternative of a rule's body, with the head facts of its solutions.
struct RuleClause {
  uint32_t rule = 0;  // in RuleBase::rules
  Clause body;
  std::vector<Atom> heads;  // over body's variables; the graph is left open
  // Use of the clause: a count is evaluated to prove a fact, and rewritten (count_form.h) to find facts to
  // assert.
  bool proves = true, tells = true;
  std::optional<rules::EqualityRule> equality;  // set if the rule is a rule of equality
  // An absence is in the body, or in the body of a rule that may make its facts.
  bool rests_on_absence = false;
};

class RuleBase {
 public:
  struct Head {
    uint32_t clause = 0;
    uint32_t head = 0;
  };

  // INVALID_ARGUMENT if RuleEngine would refuse a text.
  static absl::StatusOr<std::shared_ptr<const RuleBase>> Make(const std::vector<RuleText>& sets,
                                                              Dictionary& dictionary, const Limits& limits);

  const rules::RuleSets& sets() const { return sets_; }
  // In the order of `sets`, as RuleProgram numbers them.
  const std::vector<RuleInfo>& rules() const { return rules_; }
  const std::vector<RuleClause>& clauses() const { return clauses_; }
  // If the rules include all five of equality: their clauses, in the order of EqualityRule. Otherwise empty.
  const std::vector<uint32_t>& equality() const { return equality_; }
  // The heads that may make a fact with this predicate (kNone: any) and object, in order of the rules.
  void ForEachHead(TermId predicate, absl::FunctionRef<void(Head)> visit) const;
  // True if a rule head names this predicate, and for rdf:type also this class.
  bool IsMadeByName(TermId predicate, TermId object) const;
  // By clause: true if the predicate (kNone: any) is in its body, or in the body of a rule that may make its facts.
  std::vector<bool> RestingOn(TermId predicate) const;
  // True if a check forbids all facts of this form ("?x a owl:Nothing"). kNone: any.
  bool IsForbidden(const QuadPattern& fact) const;

 private:
  void MarkWhatRestsOnAbsence();
  // By clause: true for these, and for those whose bodies use facts that one of them may make, however indirectly.
  std::vector<bool> WithUsersOf(std::vector<uint32_t> clauses) const;
  void FindEquality();
  absl::Status Add(const std::string& set, const rules::Rule& rule, int number, Dictionary& dictionary);
  // The clauses of the last rule, for this form of its body.
  absl::Status AddClauses(const rules::Rule& rule, const sparql::Algebra& body, bool proves, bool tells,
                          Dictionary& dictionary);

  rules::RuleSets sets_;
  std::vector<RuleInfo> rules_;
  std::vector<RuleClause> clauses_;
  absl::flat_hash_map<TermId, std::vector<Head>> by_predicate_;  // kNone: the predicate is a variable
  absl::flat_hash_map<TermId, std::vector<uint32_t>> users_;     // clauses by the predicates of their bodies
  std::vector<uint32_t> equality_;
  std::vector<QuadPattern> forbidden_;
  TermId type_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_RULE_BASE_H_
