// Term quads → RDF text: RDF/XML by Raptor2, the Turtle family by our own writer
// (Raptor's pretty Turtle writer drops blank-node cycles silently). Any thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_SERIALIZER_H_
#define DOCENT_GRAPH_RDF_FORMATS_SERIALIZER_H_

#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/term.h"

namespace docent {

// INVALID_ARGUMENT where the format cannot say it (a named graph in Turtle, a predicate that RDF/XML cannot
// name).
absl::StatusOr<std::string> SerializeRdf(
    std::vector<TermQuad> quads, RdfFormat format,
    const std::vector<std::pair<std::string, std::string>>& prefixes = {});

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_SERIALIZER_H_
