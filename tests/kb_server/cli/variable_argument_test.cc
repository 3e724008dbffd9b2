#include "kb_server/cli/variable_argument.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/rdf/vocabulary.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

std::optional<std::string> Known(std::string_view prefix) {
  if (prefix == "expo") return "https://w3id.org/docent/expo#";
  if (prefix == "xsd") return std::string(kXsdNs);
  return std::nullopt;
}

Term Value(const std::string& text) {
  const auto parsed = ParseVariable("v=" + text, Known);
  EXPECT_TRUE(parsed.ok()) << parsed.status();
  return parsed.ok() ? parsed->second : Term();
}

std::string Refusal(const std::string& text) {
  return std::string(ParseVariable(text, Known).status().message());
}

TEST(VariableArgument, KnownPrefixesGiveIris) {
  EXPECT_EQ(Value("expo:John"), Term::Iri("https://w3id.org/docent/expo#John"));
  EXPECT_EQ(ParseVariable("user.name=expo:John", Known)->first, "user.name");
}

TEST(VariableArgument, AnUnknownPrefixIsAnErrorThatSaysWhatToWrite) {
  const std::string refusal = Refusal("user=ex:John");
  EXPECT_THAT(refusal, HasSubstr("user=ex:John: the prefix ex: is not known"));
  EXPECT_THAT(refusal, HasSubstr("--prefix ex=IRI"));
  EXPECT_THAT(refusal, HasSubstr("'user=<…>'"));
  EXPECT_THAT(refusal, HasSubstr("'user=\"ex:John\"'"));
}

TEST(VariableArgument, IrisAreWrittenWhole) {
  EXPECT_EQ(Value("<urn:x:y>"), Term::Iri("urn:x:y"));
  EXPECT_EQ(Value("https://example.org/a?b=c"), Term::Iri("https://example.org/a?b=c"));
  EXPECT_EQ(Value("urn:w:John"), Term::Iri("urn:w:John"));
  EXPECT_THAT(Refusal("v=<urn:a b>"), HasSubstr("may not stand in an IRI"));
  EXPECT_THAT(Refusal("v=<urn:a"), HasSubstr("no closing >"));
  EXPECT_THAT(Refusal("v=https://example.org/{a}"), HasSubstr("may not stand in one"));
}

TEST(VariableArgument, LiteralsMayHaveLanguagesAndDatatypes) {
  EXPECT_EQ(Value("\"ex:John\""), Term::Literal("ex:John"));
  EXPECT_EQ(Value("'say \"hi\"'"), Term::Literal("say \"hi\""));
  EXPECT_EQ(Value("\"Halle\"@de"), Term::LangString("Halle", "de"));
  EXPECT_EQ(Value("\"1\"^^xsd:byte"), Term::Literal("1", "http://www.w3.org/2001/XMLSchema#byte"));
  EXPECT_EQ(Value("\"1\"^^<urn:t>"), Term::Literal("1", "urn:t"));
  EXPECT_THAT(Refusal("v=\"1\"^^ex:t"), HasSubstr("unknown prefix ex:"));
  EXPECT_THAT(Refusal("v=\"open"), HasSubstr("no closing"));
}

TEST(VariableArgument, NumbersAndBooleansHaveTheirTypes) {
  EXPECT_EQ(Value("7"), Term::Integer(7));
  EXPECT_EQ(Value("-0.5"), Term::Literal("-0.5", std::string(kXsdDecimal)));
  EXPECT_EQ(Value("1e3"), Term::Literal("1e3", std::string(kXsdDouble)));
  EXPECT_EQ(Value("true"), Term::Boolean(true));
}

TEST(VariableArgument, AnythingElseIsAText) {
  for (const char* text :
       {"John", "", "Tour A", "12:30", "note: two words", "a=b", "nan", "inf", ":x", "1,5"})
    EXPECT_EQ(Value(text), Term::Literal(text)) << text;
}

TEST(VariableArgument, ANameIsNeeded) {
  EXPECT_THAT(Refusal("expo:John"), HasSubstr("it is not NAME=VALUE"));
  EXPECT_THAT(Refusal("=1"), HasSubstr("it is not NAME=VALUE"));
}

}  // namespace
}  // namespace docent::server
