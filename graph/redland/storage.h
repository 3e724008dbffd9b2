// The librdf storage `docent`: a quad store behind librdf's model API, through which Redland programs and
// Rasqal read our graph. Storages and streams follow librdf's rule: a world and all objects made from it
// belong to one thread.
//
// Contexts are named graphs. Statements without a context are in docent:default; that graph is not a context:
// its statements come without one, and get_contexts does not list it. Searches without a context look in all
// graphs, and a statement in several graphs comes once for each, as with librdf's own storages; with the
// option merged='yes' it comes once, as SPARQL requires of a default graph.
//
// Every change is applied whole or refused: one statement, one add_statements, one context_remove_statements,
// one transaction. librdf's functions then return non-zero, and the reason is one line in librdf's log.
// Parsing into a model is one add_statement for each statement: librdf (1.0.17, rdf_parser_raptor.c) does not
// tell a storage where a file begins or ends, and ignores the result of add_statement, so a file cannot be
// made one transaction.
#ifndef DOCENT_GRAPH_REDLAND_STORAGE_H_
#define DOCENT_GRAPH_REDLAND_STORAGE_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "graph/redland/quad_store.h"

struct librdf_world_s;
struct librdf_storage_s;

namespace docent::redland {

// Opens the store that a program names (rdfproc's STORE-NAME, the `name` of a storage). `make_new`: the
// option new='yes'. An error refuses the storage.
using StoreOpener = absl::StatusOr<std::unique_ptr<QuadStore>> (*)(const std::string& name, bool make_new);

// Registers the storage `docent` with `world`, unless it is registered. `opener` applies to all worlds of the
// process; null: only OpenStorage makes storages.
void RegisterStorage(librdf_world_s* world, StoreOpener opener);

// A storage `docent` over `store`. Null if librdf refuses; the storage must be registered with the world.
librdf_storage_s* OpenStorage(librdf_world_s* world, std::unique_ptr<QuadStore> store, bool merged);

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_STORAGE_H_
