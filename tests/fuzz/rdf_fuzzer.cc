// Any bytes as a document in each RDF format: sound diagnostics, or quads that the store accepts and that
// survive writing and reading.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/serializer.h"
#include "graph/rdf/term_check.h"
#include "tests/fuzz/fuzz_check.h"

namespace docent {
namespace {

void CheckQuads(const ParsedRdf& parsed) {
  for (const TermQuad& quad : parsed.quads) {
    fuzz::Require(CheckQuad(quad, Limits().term_bytes).ok(), "a quad that the store refuses");
  }
  auto lines = SerializeRdf(parsed.quads, RdfFormat::kNQuads);
  fuzz::Require(lines.ok(), "quads that N-Quads cannot say");
  fuzz::Require(ParseRdf(*lines, RdfFormat::kNQuads).quads == parsed.quads, "N-Quads that read differently");
  auto pretty = SerializeRdf(parsed.quads, RdfFormat::kTriG, parsed.prefixes);
  fuzz::Require(pretty.ok() && ParseRdf(*pretty, RdfFormat::kTriG).ok(), "TriG that does not parse");
}

void CheckOne(std::string_view text, RdfFormat format) {
  ParseRdfOptions options;
  options.base_iri = text.size() % 2 == 0 ? "http://base/" : "";
  ParsedRdf parsed = ParseRdf(text, format, options);
  if (parsed.ok()) return CheckQuads(parsed);
  fuzz::Require(parsed.quads.empty(), "quads of a document with mistakes");
  fuzz::Require(parsed.diagnostics.size() <= options.limits.document_diagnostics, "too many diagnostics");
  for (const Diagnostic& d : parsed.diagnostics) {
    fuzz::Require(!d.message.empty(), "a diagnostic without a message");
    // RDF/XML in another encoding has its places in UTF-8, which may be longer
    fuzz::Require(d.span.line > 0 && d.span.offset <= 3 * text.size(), "a diagnostic without a place");
  }
}

}  // namespace
}  // namespace docent

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::string_view text(reinterpret_cast<const char*>(data), size);
  for (docent::RdfFormat format :
       {docent::RdfFormat::kTurtle, docent::RdfFormat::kTriG, docent::RdfFormat::kNTriples,
        docent::RdfFormat::kNQuads, docent::RdfFormat::kRdfXml}) {
    docent::CheckOne(text, format);
  }
  return 0;
}
