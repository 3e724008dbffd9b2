// Hypothetical graph version: a version with some facts added and some removed, and the rules applied. Writes
// nothing. One thread, beside the writer.
#ifndef DOCENT_REASONER_EXPLAIN_HYPOTHESIS_H_
#define DOCENT_REASONER_EXPLAIN_HYPOTHESIS_H_

#include <memory>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/graph_writer.h"
#include "reasoner/explain/rule_base.h"
#include "reasoner/rules/rule_engine.h"

namespace docent::explain {

class Hypothesis {
 public:
  // `version` holds the facts derived by `rules`. `dictionary` is the caller's own, over the server's.
  // `cancellation` ends the rules early, and counts their steps; null: none. It must outlive the result.
  static absl::StatusOr<std::unique_ptr<Hypothesis>> Make(GraphVersionPtr version, Dictionary& dictionary,
                                                          const std::vector<RuleText>& rules,
                                                          const sparql::FunctionRegistry* functions,
                                                          const Limits& limits,
                                                          Cancellation* cancellation = nullptr);

  // Calls `look` with the changed graph and the changes, asserted and inferred, then drops them. Returns the
  // status of `look`. Errors of the rules: RESOURCE_EXHAUSTED naming the rule and the limit; CANCELLED,
  // DEADLINE_EXCEEDED.
  absl::Status With(const std::vector<Quad>& add, const std::vector<Quad>& remove,
                    absl::FunctionRef<absl::Status(const GraphVersion&, const Delta&)> look);

 private:
  Hypothesis(GraphVersionPtr version, Dictionary& dictionary, const sparql::FunctionRegistry* functions,
             const Limits& limits, Cancellation* cancellation)
      : writer_(std::move(version)), rules_(dictionary, limits, functions), cancellation_(cancellation) {}

  GraphWriter writer_;
  rules::RuleEngine rules_;
  Cancellation* const cancellation_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_HYPOTHESIS_H_
