#include "graph/rdf/term.h"

#include <gtest/gtest.h>

#include "absl/hash/hash.h"

#include <algorithm>
#include <vector>

#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

TEST(TermTest, EqualTermsAreEqualStructs) {
  EXPECT_EQ(Term::Literal("x", std::string(kXsdString)), Term::Literal("x"));
  EXPECT_EQ(Term::LangString("x", "EN-gb"), Term::LangString("x", "en-GB"));
  EXPECT_EQ(absl::HashOf(Term::LangString("x", "EN-gb")), absl::HashOf(Term::LangString("x", "en-GB")));
  EXPECT_FALSE(Term::LangString("x", "EN") < Term::LangString("x", "en") ||
               Term::LangString("x", "en") < Term::LangString("x", "EN"));
  EXPECT_LT(Term::LangString("x", "DE"), Term::LangString("x", "en"));
  EXPECT_LT(Term::LangString("w", "fr"), Term::LangString("x", "DE"));
  EXPECT_EQ(Term::LangString("x", "en-GB").language, "en-GB");
  EXPECT_EQ(ToNTriples(Term::LangString("x", "en-GB")), "\"x\"@en-GB");
  EXPECT_NE(Term::LangString("x", "en"), Term::Literal("x"));
  EXPECT_EQ(Term::Integer(-5), Term::Literal("-5", std::string(kXsdInteger)));
}

TEST(TermTest, OrderIsBlankIriLiteral) {
  std::vector<Term> terms = {Term::Literal("a"), Term::Iri("http://b"), Term::Blank("z"),
                             Term::Iri("http://a"), Term::Literal("a", "http://t")};
  std::sort(terms.begin(), terms.end());
  std::vector<Term> expected = {Term::Blank("z"), Term::Iri("http://a"), Term::Iri("http://b"),
                                Term::Literal("a"), Term::Literal("a", "http://t")};
  EXPECT_EQ(terms, expected);
}

TEST(TermTest, NTriplesEscapes) {
  EXPECT_EQ(ToNTriples(Term::Iri("http://a/b c>")), "<http://a/b\\u0020c\\u003E>");
  EXPECT_EQ(ToNTriples(Term::Blank("x1")), "_:x1");
  EXPECT_EQ(ToNTriples(Term::Literal("a\"b\\c\n\r\t\x01")), "\"a\\\"b\\\\c\\n\\r\\t\\u0001\"");
  EXPECT_EQ(ToNTriples(Term::LangString("\xC3\xA9t\xC3\xA9", "fr")), "\"\xC3\xA9t\xC3\xA9\"@fr");
  EXPECT_EQ(ToNTriples(Term::Boolean(true)), "\"true\"^^<http://www.w3.org/2001/XMLSchema#boolean>");
}

TEST(TermTest, DisplayIsShort) {
  EXPECT_EQ(ToDisplay(Term::Iri(DocentIri("isAt"))), "docent:isAt");
  EXPECT_EQ(ToDisplay(Term::Iri("http://example.org/x")), "<http://example.org/x>");
  EXPECT_EQ(ToDisplay(Term::Integer(42)), "42");
  EXPECT_EQ(ToDisplay(Term::Literal("x", std::string(kXsdDate))), "\"x\"^^xsd:date");
  EXPECT_EQ(ToDisplay(Term::Iri(DocentIri("a b"))), "<https://w3id.org/docent#a\\u0020b>");
}

}  // namespace
}  // namespace docent
