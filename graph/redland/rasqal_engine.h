// The second query engine, for comparison: Rasqal answers a SPARQL query through the storage `docent`, over
// one graph version. Joins are done in textual order, and answers are kept whole.
// It runs in the client's process, on a copy of the graph: Rasqal cannot be cancelled and has open memory
// faults, which must not put the server at risk.
#ifndef DOCENT_GRAPH_REDLAND_RASQAL_ENGINE_H_
#define DOCENT_GRAPH_REDLAND_RASQAL_ENGINE_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/term.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/store/graph_version.h"

namespace docent::redland {

struct RasqalAnswer {
  sparql::Query::Form form = sparql::Query::Form::kSelect;
  std::vector<std::string> variables;                  // kSelect
  std::vector<std::vector<std::optional<Term>>> rows;  // kSelect; nullopt: unbound
  bool boolean = false;                                // kAsk
  std::vector<TermQuad> triples;                       // kConstruct; without graph
};

// The default graph is the union of all graphs, each triple once.
//
// UNIMPLEMENTED, RESOURCE_EXHAUSTED: see CheckForRasqal; RESOURCE_EXHAUSTED naming rasqal_rows;
// DEADLINE_EXCEEDED and CANCELLED by `cancellation`, which is polled for each triple that Rasqal reads and
// each row (a part that reads nothing, such as a long sort, is not interrupted); INVALID_ARGUMENT with
// Rasqal's own message about the query. Any thread; `cancellation` may be null.
absl::StatusOr<RasqalAnswer> RunRasqal(const sparql::Query& query, const Dictionary& dictionary,
                                       GraphVersionPtr version, Cancellation* cancellation,
                                       const Limits& limits = {});

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_RASQAL_ENGINE_H_
