// DESCRIBE (SPARQL 1.1 section 16.4): descriptions of the resources that a query names or finds. One thread.
#ifndef DOCENT_GRAPH_SPARQL_RUN_DESCRIBE_H_
#define DOCENT_GRAPH_SPARQL_RUN_DESCRIBE_H_

#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/run/evaluator.h"

namespace docent::sparql {

// The concise bounded descriptions (CBD, W3C member submission of 3 June 2005, without reification) of the
// query's resources in the data set's default graph: the triples with a resource as subject, and the triples
// of every blank node reached as an object. Distinct, without graph. `prepared` was made from `query` with
// `options`. Errors as of a run; the result counts as memory of the run.
absl::StatusOr<std::vector<TermQuad>> Describe(PreparedQuery& prepared, const Query& query,
                                               const Dictionary& dictionary, const PrepareOptions& options,
                                               const RunOptions& run);

// The graph that answers a CONSTRUCT or DESCRIBE.
absl::StatusOr<std::vector<TermQuad>> AnswerGraph(PreparedQuery& prepared, const Query& query,
                                                  const Dictionary& dictionary, const PrepareOptions& options,
                                                  const RunOptions& run);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_DESCRIBE_H_
