// Which values a variable of a type takes.
#include "workflow/cawl/value_type.h"

#include <gtest/gtest.h>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::cawl {
namespace {

bool Takes(const std::string& type, const Term& value) {
  return TypeFault(value, Term::Iri(type)).empty();
}

TEST(ValueTypeTest, TextInALanguageIsAText) {
  const std::string text = Concat(kXsdNs, "string");
  EXPECT_TRUE(Takes(text, Term::Literal("Guten Tag")));
  EXPECT_TRUE(Takes(text, Term::LangString("Guten Tag", "de")));
  EXPECT_TRUE(Takes(std::string(kRdfLangString), Term::LangString("Guten Tag", "de")));
  EXPECT_FALSE(Takes(std::string(kRdfLangString), Term::Literal("Guten Tag")));
  EXPECT_FALSE(Takes(Concat(kXsdNs, "integer"), Term::LangString("1", "de")));
  EXPECT_FALSE(Takes(text, Term::Integer(1)));
}

}  // namespace
}  // namespace docent::cawl
