// The librdf storage `docent`: a quad store behind librdf's model API, so that Redland programs and Rasqal
// see our graph. Storages and streams follow librdf's rule: a world and what is made of it are one thread's.
//
// Contexts are named graphs. What has no context lies in docent:default; that graph is no context of its own:
// statements of it come without one, get_contexts does not list it. Searches without a context look in all
// graphs, and a statement of several graphs comes once for each, as with librdf's own storages; with the
// option merged='yes' it comes once, as SPARQL wants it of a default graph.
//
// Every change is made whole or refused: one statement, one add_statements, one context_remove_statements,
// one transaction. librdf's functions then give non-zero, and the reason is one line of librdf's log. Parsing
// into a model is one add_statement for each statement: librdf (1.0.17, rdf_parser_raptor.c) tells a storage
// neither where a file begins nor where it ends, and passes over what add_statement answers, so nothing can
// be held back to be one.
#ifndef DOCENT_GRAPH_REDLAND_STORAGE_H_
#define DOCENT_GRAPH_REDLAND_STORAGE_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "graph/redland/quad_store.h"

struct librdf_world_s;
struct librdf_storage_s;

namespace docent::redland {

// Makes the store that a program names (rdfproc's STORE-NAME, the `name` of a storage). `make_new`: the
// option new='yes'. An error refuses the storage.
using StoreOpener = absl::StatusOr<std::unique_ptr<QuadStore>> (*)(const std::string& name, bool make_new);

// Registers the storage `docent` with `world`, where it is not yet. `opener` holds for all worlds of the
// process; null: only OpenStorage makes storages.
void RegisterStorage(librdf_world_s* world, StoreOpener opener);

// A storage `docent` over `store`. Null where librdf refuses; the world must know the storage.
librdf_storage_s* OpenStorage(librdf_world_s* world, std::unique_ptr<QuadStore> store, bool merged);

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_STORAGE_H_
