// RDF/XML documents for tests, and helpers that parse them.
#ifndef DOCENT_TESTS_GRAPH_RDF_FORMATS_RDF_XML_TEXTS_H_
#define DOCENT_TESTS_GRAPH_RDF_FORMATS_RDF_XML_TEXTS_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/term_check.h"

namespace docent::rdf_xml {

// A whole document around nodes; `attributes` of rdf:RDF.
inline std::string Document(const std::string& nodes, const std::string& attributes = "") {
  return absl::StrCat(
      "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" xmlns:e=\"http://e/\" ", attributes,
      ">\n", nodes, "\n</rdf:RDF>");
}
// Around the attributes and properties of one node, http://e/s.
inline std::string Node(const std::string& properties, const std::string& attributes = "") {
  return Document(absl::StrCat("<rdf:Description rdf:about=\"http://e/s\" ", attributes, ">", properties,
                               "</rdf:Description>"));
}

// The triples of a text that must parse, in order, in N-Triples with e: and rdf: for short.
inline std::vector<std::string> Triples(const std::string& text, ParseRdfOptions options = {}) {
  const ParsedRdf parsed = ParseRdf(text, RdfFormat::kRdfXml, options);
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  std::vector<std::string> out;
  for (const TermQuad& quad : parsed.quads) {
    EXPECT_TRUE(CheckQuad(quad, options.limits.term_bytes).ok());
    std::string line =
        absl::StrCat(ToNTriples(quad.subject), " ", ToNTriples(quad.predicate), " ", ToNTriples(quad.object));
    out.push_back(absl::StrReplaceAll(
        line, {{"<http://e/", "<e:"}, {"<http://www.w3.org/1999/02/22-rdf-syntax-ns#", "<rdf:"}}));
  }
  return out;
}

// The mistakes of a text that must not parse. Each has a place.
inline std::string Mistakes(const std::string& text, ParseRdfOptions options = {}) {
  const ParsedRdf parsed = ParseRdf(text, RdfFormat::kRdfXml, options);
  EXPECT_FALSE(parsed.ok()) << text;
  EXPECT_THAT(parsed.quads, testing::IsEmpty());
  for (const Diagnostic& d : parsed.diagnostics) {
    EXPECT_GT(d.span.line, 0);
    EXPECT_GT(d.span.column, 0);
  }
  return Render(parsed.diagnostics, "");
}

inline std::string Warnings(const std::string& text) {
  const ParsedRdf parsed = ParseRdf(text, RdfFormat::kRdfXml);
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  return Render(parsed.diagnostics, "");
}

}  // namespace docent::rdf_xml

#endif  // DOCENT_TESTS_GRAPH_RDF_FORMATS_RDF_XML_TEXTS_H_
