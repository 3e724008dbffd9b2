// Entry point of this folder: answers "why?" and "why not?" about one immutable graph version.
//
// Made for one question, beside the writer: it keeps the version and has a dictionary of its own over the
// server's, so other threads never see its temporary terms. One thread.
#ifndef DOCENT_REASONER_EXPLAIN_EXPLAINER_H_
#define DOCENT_REASONER_EXPLAIN_EXPLAINER_H_

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/sparql/syntax/algebra.h"
#include "reasoner/explain/fact_history.h"
#include "reasoner/explain/proof.h"
#include "reasoner/explain/why_not.h"

namespace docent::explain {

class Explainer {
 public:
  struct Settings {
    GraphVersionPtr version;
    const Dictionary* dictionary = nullptr;  // the server's
    std::vector<RuleText> rules;             // the rules of `version`
    const sparql::FunctionRegistry* functions = nullptr;
    FactHistory* history = nullptr;  // null: assertions have no offset and time
    // Ends the work early. Make allows it the steps of one turn on `version`. Null: no such limits.
    Cancellation* cancellation = nullptr;
    TimeMicros now_us = 0;
    sparql::DefaultGraph default_graph = sparql::DefaultGraph::kUnion;
    Limits limits;
    ExplainLimits explain_limits;
    MayChange may_change;  // of what WhyNot offers; null: all may be made
    // In addition to the well-known ones, for texts.
    std::vector<std::pair<std::string, std::string>> prefixes;
  };
  static absl::StatusOr<std::unique_ptr<Explainer>> Make(const Settings& settings);

  // nullopt: the version does not hold the fact. RESOURCE_EXHAUSTED (the limit is named), CANCELLED,
  // DEADLINE_EXCEEDED.
  absl::StatusOr<std::optional<Proof>> WhyFact(const TermQuad& fact);
  // Proofs of all facts of the first solution of the WHERE. nullopt: no solution. UNIMPLEMENTED for FROM.
  absl::StatusOr<std::optional<Proof>> WhyAsk(const sparql::Query& ask);
  // The values of a variable in the solutions of the WHERE, each once, at most so many.
  absl::StatusOr<std::vector<Term>> ValuesOf(const sparql::Query& ask, std::string_view variable,
                                             size_t most);
  // At most `sets` repairs, best first.
  absl::StatusOr<WhyNotAnswer> WhyNot(const sparql::Query& ask, size_t sets);

 private:
  explicit Explainer(const Settings& settings);
  absl::Status LookUpTellings(Proof& proof);
  absl::StatusOr<bool> Holds(const sparql::Query& ask);

  const Settings settings_;
  Dictionary dictionary_;
  sparql::RunOptions run_;
  TermId default_graph_;
  std::shared_ptr<const RuleBase> rules_;
  std::unique_ptr<Prover> prover_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_EXPLAINER_H_
