// RDF text → term quads (RDF 1.1 Turtle, TriG, N-Triples, N-Quads, RDF/XML).
//
// Raptor2 parses; nothing of it shows here. Safe to call from any thread (worlds are pooled behind a mutex).
#ifndef DOCENT_KB_SERVER_RDF_PARSER_H_
#define DOCENT_KB_SERVER_RDF_PARSER_H_

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "kb_server/base/diagnostic.h"
#include "kb_server/rdf/term.h"

namespace docent {

enum class RdfFormat { kTurtle, kTriG, kNTriples, kNQuads, kRdfXml };

// By file name ending (.ttl .trig .nt .nq .rdf .owl .xml) or by media type ("text/turtle; charset=utf-8").
std::optional<RdfFormat> FormatOfFile(std::string_view file_name);
std::optional<RdfFormat> FormatOfMediaType(std::string_view media_type);

struct ParseRdfOptions {
  std::string file;      // for diagnostics
  std::string base_iri;  // relative IRIs resolve against it; empty: a relative IRI is an error
  std::string blank_node_scope;  // prefix for blank node labels so that two documents never share one
};

// All quads of `text`. On an error: nothing but the diagnostics (line, column, message, hint).
// A document type definition in RDF/XML is refused; invalid UTF-8 and U+0000 are errors.
// `prefixes` holds the document's prefix declarations.
struct ParsedRdf {
  std::vector<TermQuad> quads;
  std::vector<std::pair<std::string, std::string>> prefixes;
  Diagnostics diagnostics;
  bool ok() const { return !HasErrors(diagnostics); }
};
ParsedRdf ParseRdf(std::string_view text, RdfFormat format, const ParseRdfOptions& options = {});

}  // namespace docent

#endif  // DOCENT_KB_SERVER_RDF_PARSER_H_
