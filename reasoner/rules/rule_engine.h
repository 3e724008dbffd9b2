// Rule engine: keeps the graph docent:inferred equal to the facts that the rules derive from all other graphs
// (the *asserted* facts).
//
// Semantics: datalog with stratified negation (W3C SHACL 1.2 Rules draft). A rule body matches the union of
// all graphs, without the reports that checks make in docent:inferred (inconsistency.h). Head facts that are
// not asserted are in docent:inferred (a fact that is no longer asserted but still follows moves there). The
// result depends only on the asserted facts and the rules: any sequence of updates gives the same graph as a
// computation from scratch.
//
// Additions are propagated semi-naively, round by round: each body pattern that a new triple matches is bound
// to it, and the rest of the body is evaluated. Retractions go backward and forward (proof_search.h): a fact
// that rested on a lost fact stays if another proof is found; else it is removed, and the facts that rested
// on it are tested. So facts that support only each other (inverse properties, cycles) are removed; facts
// with other support stay, with all their consequences. A change of the rules is handled like other changes:
// facts made only by old rules are removed, facts made by new ones are added.
// Writer thread only.
#ifndef DOCENT_REASONER_RULES_RULE_ENGINE_H_
#define DOCENT_REASONER_RULES_RULE_ENGINE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/delta.h"
#include "graph/store/graph_writer.h"
#include "reasoner/rules/rule_text_origin.h"

namespace docent::rules {

class RuleEngine {
 public:
  // `dictionary` interns constants and computed values. `functions` may be null. Both must outlive the
  // engine. Used from `limits`: rule_rounds, inferred_per_turn, and the limits of the text.
  explicit RuleEngine(Dictionary& dictionary, const Limits& limits = {},
                      const sparql::FunctionRegistry* functions = nullptr);
  ~RuleEngine();
  RuleEngine(const RuleEngine&) = delete;
  RuleEngine& operator=(const RuleEngine&) = delete;

  // Replaces the rule set `name` by the rules of `text` (a `.rules` document, rule_parser.h). Takes effect at
  // the next Update. On errors (syntax, an unsafe rule, negation through recursion together with the other
  // rule sets): returns all of them with place and hint, and nothing changes.
  Diagnostics PutRules(std::string_view name, std::string_view text,
                       RuleTextOrigin origin = RuleTextOrigin::kNew);
  // False if no set has this name.
  bool RemoveRules(std::string_view name);

  // `told` is already applied in `writer` and leads from the state of the last Update to the current one.
  // Adds and removes quads of docent:inferred in `writer`, and returns the net asserted and inferred changes
  // together. RESOURCE_EXHAUSTED naming the rule and the limit (rule_rounds in one Update, inferred_per_turn
  // since the last Commit) or the body that `cancellation` ended; INVALID_ARGUMENT if `told` itself writes
  // docent:inferred. After an error the caller rolls back the writer and this engine. `cancellation` ends it
  // early, also as an error; null: none.
  absl::StatusOr<Delta> Update(GraphWriter& writer, const Delta& told, Cancellation* cancellation = nullptr);

  // Commit at the end of a turn; Rollback restores the rule sets and the state of the last Commit (the caller
  // rolls the writer back).
  void Commit();
  void Rollback();

  // Declares that the graph of the next Update already holds the consequences of the current rules, so
  // nothing is computed (start from a snapshot).
  void Adopt();

  // Whether a rule may derive something else once this fact is told or withdrawn, as of the last Update.
  bool Reads(const Quad& quad) const;

  size_t rule_count() const;
  // Number of rules in the set of that name; 0 if there is none.
  size_t rule_count(std::string_view name) const;
  std::vector<std::string> names() const;
  // Since construction, for /metrics.
  struct Counters {
    uint64_t updates = 0;
    uint64_t firings = 0;       // head facts made, before duplicates are dropped
    uint64_t inferred = 0;      // quads added to docent:inferred
    uint64_t retracted = 0;     // quads removed from it
    uint64_t rule_changes = 0;  // updates with changed rules
  };
  const Counters& counters() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_RULE_ENGINE_H_
