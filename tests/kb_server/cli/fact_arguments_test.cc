#include "kb_server/cli/fact_arguments.h"

#include "gmock/gmock.h"
#include "graph/rdf/vocabulary.h"
#include "gtest/gtest.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

class FactArgumentsTest : public testing::Test {
 protected:
  FactArguments facts_{[this] {
    ++asked_;
    IriNames names = IriNames::WellKnown();
    names.Add("expo", "https://expo.example/");
    return names;
  }};
  int asked_ = 0;
};

TEST_F(FactArgumentsTest, KnownPrefixesNeedNoServer) {
  ASSERT_TRUE(facts_.AddPrefixes({"mine=urn:mine:"}).ok());
  const auto quads = facts_.Parse("mine:a docent:isAt mine:b", "facts");
  ASSERT_TRUE(quads.ok()) << quads.status();
  EXPECT_EQ((*quads)[0].subject.lexical, "urn:mine:a");
  EXPECT_EQ(facts_.Iri("mine:x"), "urn:mine:x");
  EXPECT_EQ(facts_.Iri("docent:isAt"), DocentIri("isAt"));
  EXPECT_EQ(facts_.Iri("https://w3id.org/x"), "https://w3id.org/x");
  EXPECT_EQ(facts_.Iri("<urn:x:y>"), "urn:x:y");
  EXPECT_EQ(facts_.Iri("urn:x:y"), "urn:x:y");
  EXPECT_EQ(facts_.Iri(""), "");
  EXPECT_EQ(asked_, 0);
}

TEST_F(FactArgumentsTest, ThePrefixesOfTheServerAreKnownToo) {
  const auto quads = facts_.Parse("expo:John docent:isAt expo:B03", "facts");
  ASSERT_TRUE(quads.ok()) << quads.status();
  EXPECT_EQ((*quads)[0].object.lexical, "https://expo.example/B03");
  EXPECT_EQ(facts_.Iri("expo:R01"), "https://expo.example/R01");
  EXPECT_EQ(asked_, 1);
}

TEST_F(FactArgumentsTest, AGivenPrefixComesBeforeTheServers) {
  ASSERT_TRUE(facts_.AddPrefixes({"expo:=urn:mine:", ":=urn:empty:"}).ok());
  EXPECT_EQ(facts_.Iri("expo:R01"), "urn:mine:R01");
  EXPECT_EQ(facts_.Iri(":x"), "urn:empty:x");
  EXPECT_EQ(facts_.Iri("nowhere:x"), "nowhere:x");
  EXPECT_EQ(facts_.Parse("expo:a expo:b other:c", "facts").ok(), false);
  EXPECT_EQ(facts_.Iri("expo:R01"), "urn:mine:R01");
  EXPECT_EQ(asked_, 1);
}

TEST_F(FactArgumentsTest, ANameThatNoPrefixHasIsToldWithTheOption) {
  for (const char* bad :
       {"1=http://e/", "a b=http://e/", "-=http://e/", "a.=http://e/", "a: <urn:x> . @prefix b=http://e/"}) {
    EXPECT_THAT(std::string(facts_.AddPrefixes({bad}).message()), HasSubstr("is not the name of a prefix"))
        << bad;
  }
  EXPECT_TRUE(facts_.AddPrefixes({"a-1=http://e/", "ä.b:=http://e/", ":=http://e/"}).ok());
}

TEST_F(FactArgumentsTest, AnUnknownPrefixIsDeclaredByTheCommandsOption) {
  const auto hint = [this](const std::string& text) {
    return std::string(facts_.Parse(text, "facts").status().message());
  };
  EXPECT_THAT(hint("hotel:Ada a docent:Visitor"), HasSubstr("declare it with --prefix hotel=IRI, or write"));
  EXPECT_THAT(hint(":Ada a docent:Visitor"), HasSubstr("declare it with --prefix :=IRI"));
  EXPECT_THAT(hint("expi:Ada a docent:Visitor"),
              HasSubstr("did you mean expo:? Else declare it with --prefix expi=IRI"));
  EXPECT_EQ(hint("hotel:Ada a docent:Visitor").find("@prefix"), std::string::npos);
}

TEST_F(FactArgumentsTest, AnIriOfAnUnknownPrefixIsTakenWholeAndThatCanBeSaid) {
  EXPECT_EQ(facts_.Iri("expo:R01"), "https://expo.example/R01");
  EXPECT_EQ(facts_.Iri("https://w3id.org/x"), "https://w3id.org/x");
  EXPECT_EQ(facts_.Iri("urn:x:y"), "urn:x:y");
  EXPECT_EQ(facts_.taken_whole(), "");
  EXPECT_EQ(facts_.Iri("hotel:R01"), "hotel:R01");
  EXPECT_EQ(facts_.taken_whole(),
            "hotel:R01 was taken as a whole IRI: the prefix hotel: is not known; declare it with --prefix "
            "hotel=IRI\n");
}

TEST_F(FactArgumentsTest, AMistakeIsToldInTheTextAsItWasGiven) {
  const absl::Status status = facts_.Parse("docent:a docent:b", "facts").status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("facts:1:"));
  EXPECT_EQ(facts_.AddPrefixes({"x"}).code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace docent::server
