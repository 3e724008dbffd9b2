// RDF serializer: term quads → text. Any thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_SERIALIZER_H_
#define DOCENT_GRAPH_RDF_FORMATS_SERIALIZER_H_

#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/term.h"

namespace docent {

// INVALID_ARGUMENT for quads that the format cannot express (a named graph in Turtle, a predicate without an
// XML name in RDF/XML).
absl::StatusOr<std::string> SerializeRdf(
    std::vector<TermQuad> quads, RdfFormat format,
    const std::vector<std::pair<std::string, std::string>>& prefixes = {});

// Turtle's declarations of those of the prefixes that it can name.
std::string DeclarePrefixesInTurtle(const std::vector<std::pair<std::string, std::string>>& prefixes);

// Turtle or TriG without the declarations, for a text that is written in pieces.
std::string SerializeTurtlePiece(std::vector<TermQuad> quads,
                                 const std::vector<std::pair<std::string, std::string>>& prefixes);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_SERIALIZER_H_
