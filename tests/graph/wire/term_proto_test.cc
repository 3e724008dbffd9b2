#include "graph/wire/term_proto.h"

#include <gtest/gtest.h>

#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

TEST(TermProtoTest, EveryKindOfTermComesBackAsItWent) {
  for (const Term& term : {Term::Iri("urn:w:a"), Term::Blank("b1"), Term::Literal(""), Term::Literal("x\ny"),
                           Term::Literal("1.50", std::string(kXsdDecimal)),
                           Term::LangString("hallo", "de-at"), Term::Integer(7)}) {
    v1::Term message;
    ToProto(term, &message);
    v1::Term sent;
    ASSERT_TRUE(sent.ParseFromString(message.SerializeAsString()));
    EXPECT_EQ(FromProto(sent), term) << ToNTriples(term);
  }
}

TEST(TermProtoTest, AnUnsetTermIsNone) {
  EXPECT_EQ(FromProto(v1::Term()), std::nullopt);
}

TEST(TermProtoTest, AnEmptyGraphStaysUnset) {
  TermQuad quad = {Term::Iri("urn:w:a"), Term::Iri("urn:w:p"), Term::Integer(1), Term()};
  v1::Quad message;
  ToProto(quad, &message);
  EXPECT_FALSE(message.has_graph());
  quad.graph = Term::Iri("urn:w:g");
  ToProto(quad, &message);
  EXPECT_EQ(message.graph().iri(), "urn:w:g");
  EXPECT_EQ(message.object().literal().lexical(), "1");
}

}  // namespace
}  // namespace docent
