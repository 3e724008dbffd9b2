// Interface behind a Redland storage: finding and changing quads. Terms are text, so that a server's graph
// and one in this process look the same. One thread at a time, as librdf's objects.
#ifndef DOCENT_GRAPH_REDLAND_QUAD_STORE_H_
#define DOCENT_GRAPH_REDLAND_QUAD_STORE_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/rdf/term.h"
#include "graph/store/write_batch.h"

namespace docent::redland {

// Quads with these terms; nullopt matches any. The default graph is docent:default here, never an empty
// term.
struct QuadQuery {
  std::optional<Term> subject;
  std::optional<Term> predicate;
  std::optional<Term> object;
  std::optional<Term> graph;

  bool Matches(const TermQuad& quad) const {
    return (!subject || *subject == quad.subject) && (!predicate || *predicate == quad.predicate) &&
           (!object || *object == quad.object) && (!graph || *graph == quad.graph);
  }
};

// The answer to one query, as of the time of the query: later changes are not visible.
class QuadStream {
 public:
  virtual ~QuadStream() = default;
  // False at the end; `*quad` is then unchanged.
  virtual bool Next(TermQuad* quad) = 0;
};

class QuadStore {
 public:
  virtual ~QuadStore() = default;

  // A triple in several graphs comes once for each, one after the other. An answer is whole or an error:
  // UNAVAILABLE, DEADLINE_EXCEEDED, RESOURCE_EXHAUSTED naming the limit.
  virtual absl::StatusOr<std::unique_ptr<QuadStream>> Find(const QuadQuery& query) = 0;
  // Number of quads in all graphs.
  virtual absl::StatusOr<uint64_t> Size() = 0;
  // The graphs with at least one quad, in term order, including docent:default.
  virtual absl::StatusOr<std::vector<Term>> Graphs() = 0;

  // Applies all of the operations or none; OK once they are as durable as this store makes them and visible
  // to Find. A quad is in at most one operation. INVALID_ARGUMENT names the operation and its fault;
  // FAILED_PRECONDITION: the store is read only, or its rules refuse the change.
  virtual absl::Status Apply(std::vector<QuadOperation> operations) = 0;
};

// The quads of `quads` as a stream.
std::unique_ptr<QuadStream> StreamOf(std::vector<TermQuad> quads);
// Order by subject, predicate, object, graph, each in term order.
bool TripleOrder(const TermQuad& a, const TermQuad& b);
// Sorts by TripleOrder, which brings the copies of each triple together.
void SortByTriple(std::vector<TermQuad>* quads);

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_QUAD_STORE_H_
