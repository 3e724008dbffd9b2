#include "graph/rdf/formats/located_parser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

namespace docent {
namespace {

using Place = std::pair<int, int>;
Place At(const SourceSpan& span) {
  return {span.line, span.column};
}

TEST(LocatedParserTest, TurtleTermsHaveLineAndColumn) {
  const LocatedRdf document = ParseLocatedRdf(
      "@prefix e: <http://e/> .\n@prefix unused: <http://u/> .\ne:ä e:p 1 ,\n  2 ; a e:C .\n[ e:q ( 3 ) ] "
      "e:r e:ä .",
      RdfFormat::kTurtle);
  ASSERT_TRUE(document.rdf.ok()) << Render(document.rdf.diagnostics, "");
  ASSERT_EQ(document.places.size(), document.rdf.quads.size());
  EXPECT_EQ(At(document.places[0].subject), Place(3, 1));
  EXPECT_EQ(At(document.places[0].predicate), Place(3, 5));
  EXPECT_EQ(At(document.places[0].object), Place(3, 9));
  EXPECT_EQ(At(document.places[1].object), Place(4, 3));
  EXPECT_EQ(At(document.places[2].predicate), Place(4, 7));
  for (size_t i = 0; i < document.rdf.quads.size(); ++i) {
    if (document.rdf.quads[i].predicate.lexical == "http://e/q") {
      EXPECT_EQ(At(document.places[i].subject), Place(5, 1));
      EXPECT_EQ(At(document.places[i].object), Place(5, 7));
    }
    if (document.rdf.quads[i].predicate.lexical == "http://e/r") {
      EXPECT_EQ(At(document.places[i].object), Place(5, 19));
    }
    if (document.rdf.quads[i].object == Term::Integer(3)) {
      EXPECT_EQ(At(document.places[i].object), Place(5, 9));
    }
  }
  ASSERT_EQ(document.prefixes.size(), 2u);
  EXPECT_GT(document.prefixes[0].uses, 5u);
  EXPECT_EQ(document.prefixes[1].uses, 0u);
  EXPECT_EQ(At(document.prefixes[1].span), Place(2, 9));
}

TEST(LocatedParserTest, OtherFormatsHaveAPlaceForEachQuad) {
  const LocatedRdf lines = ParseLocatedRdf(
      "<http://e/s> <http://e/p> \"x\" .\n\n<http://e/s> <http://e/p> \"y\" .\n", RdfFormat::kNTriples);
  ASSERT_EQ(lines.places.size(), 2u);
  EXPECT_EQ(At(lines.places[1].object), Place(3, 27));
  const LocatedRdf xml = ParseLocatedRdf(
      "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" xmlns:e=\"http://e/\">\n"
      "<rdf:Description rdf:about=\"http://e/s\">\n  <e:p>1</e:p>\n  "
      "<e:p>2</e:p>\n</rdf:Description></rdf:RDF>",
      RdfFormat::kRdfXml);
  ASSERT_EQ(xml.places.size(), 2u) << Render(xml.rdf.diagnostics, "");
  EXPECT_EQ(At(xml.places[0].subject), Place(2, 1)) << "the node";
  EXPECT_EQ(At(xml.places[0].predicate), Place(3, 3)) << "the property";
  EXPECT_EQ(At(xml.places[1].object), Place(4, 3));
  const LocatedRdf attributes = ParseLocatedRdf(
      "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" xmlns:e=\"http://e/\">\n"
      "<rdf:Description e:a='e:b=' e:aa='1'\n e:b = '2'/></rdf:RDF>",
      RdfFormat::kRdfXml);
  ASSERT_EQ(attributes.places.size(), 3u) << Render(attributes.rdf.diagnostics, "");
  EXPECT_EQ(At(attributes.places[1].predicate), Place(2, 29));
  EXPECT_EQ(At(attributes.places[2].predicate), Place(3, 2));
  const LocatedRdf bad = ParseLocatedRdf("<http://e/s> <http://e/p> .", RdfFormat::kNTriples);
  EXPECT_FALSE(bad.rdf.ok());
  EXPECT_TRUE(bad.places.empty());
}

}  // namespace
}  // namespace docent
