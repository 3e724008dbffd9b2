// librdf's objects as owned C++ values, and conversions of terms and nodes. Only the .cc files of this folder
// include it. A world and all objects made with it belong to one thread at a time.
#ifndef DOCENT_GRAPH_REDLAND_REDLAND_NODES_H_
#define DOCENT_GRAPH_REDLAND_REDLAND_NODES_H_

#include <redland.h>

#include <memory>
#include <optional>
#include <string>

#include "graph/rdf/term.h"
#include "graph/redland/quad_store.h"

namespace docent::redland {

template <auto Free>
struct LibrdfDeleter {
  template <typename T>
  void operator()(T* object) const {
    Free(object);
  }
};
using NodePtr = std::unique_ptr<librdf_node, LibrdfDeleter<librdf_free_node>>;
using UriPtr = std::unique_ptr<librdf_uri, LibrdfDeleter<librdf_free_uri>>;
using StatementPtr = std::unique_ptr<librdf_statement, LibrdfDeleter<librdf_free_statement>>;
using StreamPtr = std::unique_ptr<librdf_stream, LibrdfDeleter<librdf_free_stream>>;
using StoragePtr = std::unique_ptr<librdf_storage, LibrdfDeleter<librdf_free_storage>>;
using ModelPtr = std::unique_ptr<librdf_model, LibrdfDeleter<librdf_free_model>>;
using LibrdfQueryPtr = std::unique_ptr<librdf_query, LibrdfDeleter<librdf_free_query>>;
using ResultsPtr = std::unique_ptr<librdf_query_results, LibrdfDeleter<librdf_free_query_results>>;

inline const unsigned char* Bytes(const std::string& text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

// Null only if librdf is out of memory.
NodePtr ToNode(librdf_world* world, const Term& term);
StatementPtr ToStatement(librdf_world* world, const TermQuad& quad);

// nullopt for null: a missing node.
std::optional<Term> FromNode(librdf_node* node);
// The terms of a whole statement, in `graph`. Missing parts are empty IRIs, which no store accepts.
TermQuad FromStatement(librdf_statement* statement, const Term& graph);

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_REDLAND_NODES_H_
