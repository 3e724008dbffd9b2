// Evaluator of a SPARQL Update on a graph version; the result is its changes as quads. It writes nothing: the
// quads go through the inbox like any batch, and hold the values that NOW, RAND, UUID and BNODE had, so that
// the log replays exactly. Any thread; the version is not changed.
//
// The default graph of WHERE is PrepareOptions::default_graph; templates, DATA and DEFAULT without GRAPH or
// WITH always mean docent:default (SPARQL 1.1 Update section 2.3 leaves the union to the store).
#ifndef DOCENT_GRAPH_SPARQL_RUN_UPDATE_EVALUATOR_H_
#define DOCENT_GRAPH_SPARQL_RUN_UPDATE_EVALUATOR_H_

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/update_algebra.h"
#include "graph/store/graph_version.h"
#include "graph/store/recent_changes.h"
#include "graph/store/write_batch.h"

namespace docent::sparql {

// The quads of a document for LOAD; labels of blank nodes need not be unique. An error's message gives the
// reason.
using DocumentQuads = std::shared_ptr<const std::vector<TermQuad>>;
using LoadDocument = std::function<absl::StatusOr<DocumentQuads>(const std::string& iri)>;

struct UpdateOptions {
  PrepareOptions prepare;  // `bound` is not used
  LoadDocument load;       // empty: LOAD is refused
};

struct UpdateEffect {
  std::vector<QuadOperation> operations;  // to be applied in order
  // The patterns that the evaluation read. If no matching quad has changed, a later version gives the same
  // operations. Empty: every version gives them.
  std::vector<ReadPattern> reads;
  // Memory of both, which stays counted in PrepareOptions::memory; the caller releases it with them. 0 without that.
  size_t bytes = 0;
};

// INVALID_ARGUMENT (with the operation's place), FAILED_PRECONDITION (a graph exists that must not, or is
// missing), RESOURCE_EXHAUSTED naming the limit, CANCELLED, DEADLINE_EXCEEDED, and the errors of `load`.
// `run.seed` must differ between any two updates of one log: blank nodes are named after it.
absl::StatusOr<UpdateEffect> EvaluateUpdate(const Update& update, const Dictionary& dictionary,
                                            const RunOptions& run, const UpdateOptions& options);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_UPDATE_EVALUATOR_H_
