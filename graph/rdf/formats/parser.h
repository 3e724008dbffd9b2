// RDF parser: text → term quads (RDF 1.1 Turtle, TriG, N-Triples, N-Quads, RDF/XML).
//
// All parsers are our own; turtle_parser.h and rdf_xml.h give the reasons. Any thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_PARSER_H_
#define DOCENT_GRAPH_RDF_FORMATS_PARSER_H_

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "graph/base/cancellation.h"
#include "graph/base/diagnostic.h"
#include "graph/base/document_limits.h"
#include "graph/base/limits.h"
#include "graph/rdf/term.h"

namespace docent {

class MemoryUse;

enum class RdfFormat { kTurtle, kTriG, kNTriples, kNQuads, kRdfXml };

// By file name ending (.ttl .trig .nt .nq .rdf .owl .xml, and .gz after it) or by media type ("text/turtle; charset=utf-8").
std::optional<RdfFormat> FormatOfFile(std::string_view file_name);
std::optional<RdfFormat> FormatOfMediaType(std::string_view media_type);

// "x.ttl.gz" → "x.ttl": .gz says only how it is packed.
std::string_view NameWithoutGz(std::string_view file_name);
// INVALID_ARGUMENT if the name stands for an RDF format that is not read (.jsonld, .n3 …); lists the readable
// ones.
absl::Status CheckFormatOfFile(std::string_view file_name);
// "is not known" or "is JSON-LD, which is not read", with the readable media types.
std::string UnknownMediaType(std::string_view media_type);

struct ParseRdfOptions {
  std::string file;              // for diagnostics
  std::string base_iri;          // relative IRIs resolve against it; empty: a relative IRI is an error
  std::string blank_node_scope;  // prefix for blank node labels so that two documents never share one
  Limits limits;                 // document_bytes, term_bytes, turtle_nesting, document_diagnostics
  DocumentLimits document_limits;
  std::string charset;  // RDF/XML: the encoding of Content-Type, used if the text itself declares none
  Cancellation* cancellation = nullptr;  // polled every few KiB; null: none
  MemoryUse* memory =
      nullptr;  // counts the quads, which stay counted; null: document_bytes alone bounds them
  // Why a graph that the document names is not taken where its quads are to go; empty: it is. Null: all are.
  std::function<std::string(const Term& graph)> refuse_graph;
};

// All quads of `text`, at most one for each 32 bytes of document_bytes; the graph is empty if the document
// names none. After an error: no quads, but every mistake found (line, column, message, hint). Nothing is
// fetched. Invalid UTF-8 is an error, and so is U+0000, except in a literal of the Turtle family, where RDF
// allows it. RDF/XML may be UTF-16 or in a declared encoding (xml_encoding.h); mistakes then have their
// places in the UTF-8 text. `prefixes` holds the document's prefix declarations in order.
struct ParsedRdf {
  std::vector<TermQuad> quads;
  std::vector<std::pair<std::string, std::string>> prefixes;
  Diagnostics diagnostics;
  absl::Status stopped;  // the error of options.cancellation or options.memory, if it ended the parsing
  bool ok() const { return stopped.ok() && !HasErrors(diagnostics); }
};
ParsedRdf ParseRdf(std::string_view text, RdfFormat format, const ParseRdfOptions& options = {});

// The error that ended the parsing, or INVALID_ARGUMENT with the rendered mistakes; OK if parsed.ok().
absl::Status ToStatus(const ParsedRdf& parsed, std::string_view text);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_PARSER_H_
