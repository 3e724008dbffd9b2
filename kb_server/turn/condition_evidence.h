// The facts that make a condition hold: what is told of a node that fired.
//
// The same binding and facts give the same text, whatever was asked before and however the query would be planned: it is
// recorded with decisions, and replay compares it.
//
// Writer thread only.
#ifndef DOCENT_KB_SERVER_TURN_CONDITION_EVIDENCE_H_
#define DOCENT_KB_SERVER_TURN_CONDITION_EVIDENCE_H_

#include <string>
#include <vector>

#include "graph/rdf/dictionary.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/store/graph_version.h"
#include "workflow/engine/state/ports.h"

namespace docent::server {

class ConditionEvidence {
 public:
  // Of the ASK `query` that a CAWL condition compiles to: all its variables are named. `dictionary` must outlive it.
  ConditionEvidence(const sparql::Query& query, const Dictionary* dictionary);

  // N-Triples: the facts of `version` that its positive triple patterns are with the values of `binding`, each once. A
  // pattern whose variables have no values there is of an alternative that was not taken.
  std::string Text(const GraphVersion& version, const engine::TermBinding& binding) const;

 private:
  std::vector<sparql::TriplePattern> patterns_;
  const Dictionary* dictionary_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_TURN_CONDITION_EVIDENCE_H_
