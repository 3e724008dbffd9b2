// The facts that make a condition hold: what is told of a node that fired.
//
// Writer thread only.
#ifndef DOCENT_KB_SERVER_APP_CONDITION_EVIDENCE_H_
#define DOCENT_KB_SERVER_APP_CONDITION_EVIDENCE_H_

#include <memory>
#include <string>
#include <vector>

#include "kb_server/base/clock.h"
#include "kb_server/rdf/dictionary.h"
#include "kb_server/sparql/algebra.h"
#include "kb_server/sparql/evaluator.h"
#include "kb_server/sparql/function_registry.h"
#include "kb_server/store/graph_version.h"
#include "workflow/engine/ports.h"

namespace docent {

class ConditionEvidence {
 public:
  // Of the ASK `query`. `dictionary` and `functions` must outlive it.
  ConditionEvidence(std::shared_ptr<const sparql::Query> query, const Dictionary* dictionary,
                    const sparql::FunctionRegistry* functions);

  // N-Triples: what its positive triple patterns match in the first solution on `version` that agrees with
  // `binding`. Empty where there is none.
  std::string Text(const GraphVersion& version, TimeMicros now_us, const TermBinding& binding);

 private:
  // Null where it cannot be prepared.
  sparql::PreparedQuery* Prepared(std::vector<std::string> bound);

  const std::shared_ptr<const sparql::Query> query_;
  const Dictionary* dictionary_;
  const sparql::FunctionRegistry* functions_;
  // For the variables that the last binding had; most conditions always have the same.
  std::unique_ptr<sparql::PreparedQuery> prepared_;
  std::vector<std::string> bound_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_APP_CONDITION_EVIDENCE_H_
