// Keeps the graph docent:inferred equal to what the rules derive from all other graphs (the *told* facts).
//
// Semantics: datalog with stratified negation (W3C SHACL 1.2 Rules draft). A rule body matches the union of
// all graphs; what its head makes and nobody tells lies in docent:inferred (a fact that is no longer told but
// still follows goes there). The graph is a function of the told facts and the rules alone: any sequence of
// updates gives what a computation from scratch gives.
//
// Additions are propagated semi-naively, a round at a time: each body pattern that a new triple matches is
// bound to it and the rest of the body evaluated. Retractions go backward and forward (proof_search.h): what
// rested on a lost fact stays where another proof is found, else it goes and what rested on it is asked. So
// facts that support only each other (inverse properties, cycles) go, and facts with other support stay, and
// with them all that rests on them. A changed rule set is a change like any other: what only the old rules
// made goes, what the new ones make comes.
//
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
  // engine. Of `limits`: rule_rounds, inferred_per_turn, and those of the text.
  explicit RuleEngine(Dictionary& dictionary, const Limits& limits = {},
                      const sparql::FunctionRegistry* functions = nullptr);
  ~RuleEngine();
  RuleEngine(const RuleEngine&) = delete;
  RuleEngine& operator=(const RuleEngine&) = delete;

  // Puts the rules of `text` (a `.rules` document, rule_parser.h) in the place of those that have the same
  // name. Takes effect at the next Update. On errors (syntax, an unsafe rule, negation through recursion
  // together with the other rule sets): all of them with place and hint, and nothing changes.
  Diagnostics PutRules(std::string_view name, std::string_view text,
                       RuleTextOrigin origin = RuleTextOrigin::kNew);
  // False if there are none of that name.
  bool RemoveRules(std::string_view name);

  // `told` is already applied in `writer` and leads there from the state of the last Update. Adds and removes
  // quads of docent:inferred in `writer`, and returns told and inferred changes together, net.
  // RESOURCE_EXHAUSTED naming the rule and the limit (rule_rounds in one Update, inferred_per_turn since the
  // last Commit) or the body that `cancellation` ended; INVALID_ARGUMENT where `told` itself writes docent:inferred. After an error the caller
  // rolls back the writer and this. `cancellation` ends it early, likewise as an error; null: none.
  absl::StatusOr<Delta> Update(GraphWriter& writer, const Delta& told, Cancellation* cancellation = nullptr);

  // The turn is done; or it failed: rule sets and state as of the last Commit (the caller rolls the writer
  // back).
  void Commit();
  void Rollback();

  // The graph that the next Update gets holds already what the rules that are put derive: nothing is computed
  // anew (a start from a snapshot).
  void Adopt();

  size_t rule_count() const;
  // Of the rule set of that name; 0 if there is none.
  size_t rule_count(std::string_view name) const;
  std::vector<std::string> names() const;
  // Since construction, for /metrics.
  struct Counters {
    uint64_t updates = 0;
    uint64_t firings = 0;       // heads made, before duplicates are dropped
    uint64_t inferred = 0;      // quads added to docent:inferred
    uint64_t retracted = 0;     // quads removed from it
    uint64_t rule_changes = 0;  // updates in which the rules were other ones
  };
  const Counters& counters() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_RULE_ENGINE_H_
