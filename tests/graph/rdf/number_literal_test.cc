#include "graph/rdf/number_literal.h"

#include <gtest/gtest.h>

#include <string>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

std::optional<double> Value(const std::string& text, const std::string& type) {
  return FiniteNumber(Term::Literal(text, Concat(kXsdNs, type)));
}

TEST(NumberLiteral, FiniteOnesHaveAValue) {
  EXPECT_EQ(Value("1.5", "decimal"), 1.5);
  EXPECT_EQ(Value("-.5", "decimal"), -0.5);
  EXPECT_EQ(Value("+7", "integer"), 7);
  EXPECT_EQ(Value("255", "unsignedByte"), 255);
  EXPECT_EQ(Value("1e3", "double"), 1000);
  EXPECT_EQ(Value("-1.5E-2", "float"), -0.015);
}

TEST(NumberLiteral, OthersHaveNone) {
  for (const char* text : {"NaN", "INF", "-INF", "+INF", "nan", "inf", "infinity", "1e400", "0x10", "", "1,5",
                           " 1", "1 ", "e5", ".", "1e"})
    EXPECT_FALSE(Value(text, "double")) << text;
  EXPECT_FALSE(Value("1e3", "decimal"));
  EXPECT_FALSE(Value("1.0", "integer"));
  EXPECT_FALSE(Value(std::string(400, '9'), "decimal")) << "more than a double holds";
  EXPECT_FALSE(Value("1", "string"));
  EXPECT_FALSE(FiniteNumber(Term::Literal("1")));
  EXPECT_FALSE(FiniteNumber(Term::Iri("urn:1")));
  EXPECT_TRUE(IsNumberLiteral(Term::Literal("NaN", std::string(kXsdDouble))));
  EXPECT_FALSE(IsNumberLiteral(Term::Literal("1", std::string(kXsdString))));
}

}  // namespace
}  // namespace docent
