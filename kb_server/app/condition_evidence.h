// The facts that make a condition hold: what is told of a node that fired.
//
// The same binding and facts give the same text, whatever was asked before and however the query would be planned: it is
// recorded with decisions, and replay compares it.
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
#include "kb_server/sparql/function_registry.h"
#include "kb_server/store/graph_version.h"
#include "workflow/engine/ports.h"

namespace docent {

class ConditionEvidence {
 public:
  // Of the ASK `query`. `dictionary` and `functions` must outlive it.
  ConditionEvidence(std::shared_ptr<const sparql::Query> query, const Dictionary* dictionary,
                    const sparql::FunctionRegistry* functions);

  // N-Triples: the facts of `version` that its positive triple patterns are with the values of `binding`; of the steps of
  // property paths, in term order, the first kStepsShown that some solution with these values takes.
  std::string Text(const GraphVersion& version, TimeMicros now_us, const TermBinding& binding) const;

 private:
  static constexpr size_t kStepsShown = 8;

  std::vector<std::string> Steps(const GraphVersion& version, TimeMicros now_us, const TermBinding& binding) const;

  const std::shared_ptr<const sparql::Query> query_;
  const Dictionary* dictionary_;
  const sparql::FunctionRegistry* functions_;
  std::vector<const sparql::TriplePattern*> patterns_, steps_;  // of query_; steps have variables that no binding names
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_APP_CONDITION_EVIDENCE_H_
