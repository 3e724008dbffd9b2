// Answers "why?" and "why not?" about one immutable graph version: the folder's front door.
//
// Made for one question, beside the writer: it keeps the version and has a dictionary of its own over the server's,
// so nothing that it makes up is seen by others. One thread.
#ifndef DOCENT_REASONER_EXPLAIN_EXPLAINER_H_
#define DOCENT_REASONER_EXPLAIN_EXPLAINER_H_

#include <memory>
#include <optional>
#include <string>
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
    std::vector<RuleText> rules;             // that `version` follows
    const sparql::FunctionRegistry* functions = nullptr;
    FactHistory* history = nullptr;  // null: tellings have no offset and time
    Cancellation* cancellation = nullptr;
    TimeMicros now_us = 0;
    sparql::DefaultGraph default_graph = sparql::DefaultGraph::kUnion;
    Limits limits;
    ExplainLimits explain_limits;
    // Besides the well-known ones, for texts.
    std::vector<std::pair<std::string, std::string>> prefixes;
  };
  static absl::StatusOr<std::unique_ptr<Explainer>> Make(const Settings& settings);

  // nullopt: the version does not hold it. RESOURCE_EXHAUSTED (the limit is named), CANCELLED,
  // DEADLINE_EXCEEDED.
  absl::StatusOr<std::optional<Proof>> WhyFact(const TermQuad& fact);
  // The facts of the first solution of the WHERE, each proved. nullopt: it has none. UNIMPLEMENTED for FROM.
  absl::StatusOr<std::optional<Proof>> WhyAsk(const sparql::Query& ask);
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
