#include "graph/rdf/term_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

using testing::HasSubstr;

std::string Message(const absl::Status& status) {
  return std::string(status.message());
}

TEST(TermCheckTest, GoodTerms) {
  for (const Term& term :
       {Term::Iri("http://a/\xC3\xA9"), Term::Blank("a.b-1"), Term::Blank("0"), Term::Literal(""),
        Term::Literal(std::string("\0", 1)), Term::LangString("x", "en-GB"), Term::Literal("x", "urn:t")}) {
    EXPECT_TRUE(CheckTerm(term, 100).ok()) << ToNTriples(term);
  }
}

TEST(TermCheckTest, BadTermsSayWhatIsWrong) {
  EXPECT_THAT(Message(CheckTerm(Term::Iri("booths/B03"), 100)), HasSubstr("<booths/B03> is relative"));
  EXPECT_THAT(Message(CheckTerm(Term::Iri("http://a b"), 100)), HasSubstr("percent-encoded"));
  EXPECT_THAT(Message(CheckTerm(Term::Iri(""), 100)), HasSubstr("empty"));
  EXPECT_THAT(Message(CheckTerm(Term::Blank("a b"), 100)), HasSubstr("is not a blank node label"));
  EXPECT_THAT(Message(CheckTerm(Term::Blank("a."), 100)), HasSubstr("is not a blank node label"));
  EXPECT_THAT(Message(CheckTerm(Term::LangString("x", "e n"), 100)), HasSubstr("is not a language tag"));
  EXPECT_THAT(Message(CheckTerm(Term::Literal("a\xFF"), 100)), HasSubstr("0xFF"));
  EXPECT_THAT(Message(CheckTerm(Term::Literal("x", "t"), 100)),
              HasSubstr("datatype: the IRI <t> is relative"));
  Term both = Term::LangString("x", "en");
  both.datatype = "urn:t";
  EXPECT_THAT(Message(CheckTerm(both, 100)), HasSubstr("not both"));
  EXPECT_THAT(Message(CheckTerm(Term::Literal("x", std::string(kRdfLangString)), 100)),
              HasSubstr("has a language instead"));
}

TEST(TermCheckTest, LengthAtTheLimitAndOnePast) {
  EXPECT_TRUE(CheckTerm(Term::Literal(std::string(100, 'x')), 100).ok());
  absl::Status status = CheckTerm(Term::Literal(std::string(101, 'x')), 100);
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(Message(status), HasSubstr("term_bytes is 100"));
}

TEST(TermCheckTest, QuadsNameThePosition) {
  Term iri = Term::Iri("urn:x");
  EXPECT_TRUE(CheckQuad({iri, iri, Term::Literal("o"), Term()}, 100).ok());
  EXPECT_TRUE(CheckQuad({Term::Blank("b"), iri, iri, iri}, 100).ok());
  EXPECT_THAT(Message(CheckQuad({Term::Literal("s"), iri, iri, Term()}, 100)),
              HasSubstr("subject: the literal \"s\""));
  EXPECT_THAT(Message(CheckQuad({iri, Term::Blank("b"), iri, Term()}, 100)),
              HasSubstr("predicate: a blank node"));
  EXPECT_THAT(Message(CheckQuad({iri, iri, Term::Iri("rel"), Term()}, 100)),
              HasSubstr("object: the IRI <rel>"));
  EXPECT_THAT(Message(CheckQuad({iri, iri, iri, Term::Literal("g")}, 100)), HasSubstr("graph: a literal"));
  EXPECT_THAT(Message(CheckQuad({iri, iri, iri, Term::Iri("g")}, 100)), HasSubstr("graph: the IRI <g>"));
}

}  // namespace
}  // namespace docent
