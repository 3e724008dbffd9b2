#include "workflow/xml/term_text.h"

#include <gtest/gtest.h>

#include "graph/rdf/vocabulary.h"

namespace docent::xml {
namespace {

const Prefixes kPrefixes = {{"expo", "https://w3id.org/docent/expo#"},
                            {"docent", "urn:own:"},
                            {"rel", "httpsorg/x#"},
                            {"odd", "urn:a b:"}};

std::optional<Term> Parse(std::string_view text, TermError* error = nullptr) {
  TermError unused;
  return ParseTerm(text, kPrefixes, error != nullptr ? error : &unused);
}

TEST(TermText, ReadsEachForm) {
  EXPECT_EQ(Parse("expo:B03"), Term::Iri("https://w3id.org/docent/expo#B03"));
  EXPECT_EQ(Parse("schema:name"), Term::Iri("https://schema.org/name"));
  EXPECT_EQ(Parse("docent:x"), Term::Iri("urn:own:x")) << "a declaration wins over a well-known prefix";
  EXPECT_EQ(Parse("<urn:x:y>"), Term::Iri("urn:x:y"));
  EXPECT_EQ(Parse("\"a \\\"b\\\"\\n\""), Term::Literal("a \"b\"\n"));
  EXPECT_EQ(Parse("'a'"), Term::Literal("a"));
  EXPECT_EQ(Parse("\"\\u00e9 \\U0001F916\""), Term::Literal("é 🤖"));
  for (const char* bad : {"\"\\u00e\"", "\"\\uD800\"", "\"\\U00110000\"", "\"\\u\"", "\"\\u0000\""})
    EXPECT_FALSE(Parse(bad)) << bad;
  EXPECT_EQ(Parse("\"a\"@EN-gb"), Term::LangString("a", "en-gb"));
  EXPECT_EQ(Parse("\"1\"^^xsd:decimal"), Term::Literal("1", std::string(kXsdDecimal)));
  EXPECT_EQ(Parse("\"1\"^^<urn:t>"), Term::Literal("1", "urn:t"));
  EXPECT_EQ(Parse("-7"), Term::Literal("-7", std::string(kXsdInteger)));
  EXPECT_EQ(Parse(".5"), Term::Literal(".5", std::string(kXsdDecimal)));
  EXPECT_EQ(Parse("1.5e-3"), Term::Literal("1.5e-3", std::string(kXsdDouble)));
  EXPECT_EQ(Parse("true"), Term::Boolean(true));
}

TEST(TermText, TellsWhereAndWhat) {
  TermError error;
  EXPECT_FALSE(Parse("\"a\"^^exp:b", &error));
  EXPECT_EQ(error.offset, 5u);
  EXPECT_EQ(error.message, "unknown prefix exp:");
  EXPECT_EQ(error.hint, "did you mean expo:? Or declare it on the root element: xmlns:exp=\"…\"");
  for (const char* bad :
       {"",         "x",         "<x>",      "<urn:a b>", "<urn:a", "\"a",  "\"a\"b", "\"a\"@",
        "\"a\"@12", "\"a\"@en-", "\"a\"^^5", "1.",        "1e",     "+",    "--1",    "expo:a b",
        "_:b",      ":x",        "ex po:a",  "expo:a<",   "rel:a",  "odd:a"}) {
    EXPECT_FALSE(Parse(bad)) << bad;
  }
}

TEST(TermText, VariableNames) {
  for (const char* good : {"x", "X1", "user_region"}) EXPECT_TRUE(IsVariableName(good)) << good;
  for (const char* bad : {"", "1x", "_x", "a-b", "a.b", "é", "a b"}) EXPECT_FALSE(IsVariableName(bad)) << bad;
}

}  // namespace
}  // namespace docent::xml
