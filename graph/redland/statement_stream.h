// Adapters of quads to librdf's streams and iterators. Only the .cc files of this folder include it.
#ifndef DOCENT_GRAPH_REDLAND_STATEMENT_STREAM_H_
#define DOCENT_GRAPH_REDLAND_STATEMENT_STREAM_H_

#include <memory>
#include <vector>

#include "graph/redland/quad_store.h"
#include "graph/redland/redland_nodes.h"

namespace docent::redland {

// A librdf_stream over `quads`, which keeps `storage` alive. With `merged` each triple comes once. The
// context of a statement is its graph, null for docent:default.
librdf_stream* NewStatementStream(librdf_storage* storage, std::unique_ptr<QuadStream> quads, bool merged);

// A librdf_iterator over `terms` as nodes.
librdf_iterator* NewNodeIterator(librdf_world* world, const std::vector<Term>& terms);

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_STATEMENT_STREAM_H_
