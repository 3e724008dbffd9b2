#include "graph/rdf/iri_names.h"

#include "graph/rdf/vocabulary.h"
#include "gtest/gtest.h"

namespace docent {
namespace {

IriNames Expo() {
  IriNames names = IriNames::WellKnown();
  names.Add("expo", "https://w3id.org/docent/expo#");
  return names;
}

std::string Named(const std::string& local) {
  return Expo().Iri("https://w3id.org/docent/expo#" + local);
}

TEST(IriNamesTest, AnIriIsNamedByItsPrefix) {
  EXPECT_EQ(Named("R01"), "expo:R01");
  EXPECT_EQ(Named("").front(), '<') << "a namespace is shown whole, as in a hint that declares it";
  EXPECT_EQ(Expo().Iri(DocentIri("isAt")), "docent:isAt");
  EXPECT_EQ(Expo().Iri("urn:x:y"), "<urn:x:y>");
}

TEST(IriNamesTest, ANameThatTurtleReadsAsItStandsIsUsed) {
  EXPECT_EQ(Named("Zähler"), "expo:Zähler");
  EXPECT_EQ(Named("a.b"), "expo:a.b");
  EXPECT_EQ(Named("1:2"), "expo:1:2");
  EXPECT_EQ(Named("a%20b"), "expo:a%20b");
}

TEST(IriNamesTest, AnIriWhoseRestIsNoLocalNameStaysWhole) {
  for (const char* local :
       {"a/b", "-x", "a.", ".a", "a b", "a?b", "a#b", "a,b", "a%2", "a(b)", "a~b", "a&b=1", "a'b"})
    EXPECT_EQ(Named(local).front(), '<') << local;
}

TEST(IriNamesTest, TheLongestNamespaceNamesAnIri) {
  IriNames names;
  names.Add("a", "urn:x:");
  names.Add("b", "urn:x:y:");
  EXPECT_EQ(names.Iri("urn:x:y:z"), "b:z");
  EXPECT_EQ(names.Iri("urn:x:q"), "a:q");
  names.Add("c", "urn:x:y:z/");  // longer, but gives no valid name
  EXPECT_EQ(names.Iri("urn:x:y:z/a/b"), "<urn:x:y:z/a/b>");
}

TEST(IriNamesTest, ANameIsGivenOnce) {
  IriNames names;
  names.Add("a", "urn:x:");
  names.Add("a", "urn:y:");
  EXPECT_EQ(names.Iri("urn:x:1"), "a:1");
  EXPECT_EQ(names.Iri("urn:y:1"), "<urn:y:1>");
}

TEST(IriNamesTest, WhatCannotBeDeclaredIsNoPrefix) {
  IriNames names;
  names.Add("a b", "urn:x:");
  names.Add("a.", "urn:x:");
  names.Add("1", "urn:x:");
  names.Add("ok", "no namespace");
  names.Add("ok", "relative");
  EXPECT_TRUE(names.prefixes().empty());
  names.Add("", "urn:x:");
  EXPECT_EQ(names.Iri("urn:x:y"), ":y");
}

TEST(IriNamesTest, TermsAreShownInTheWayOfTurtle) {
  const IriNames names = Expo();
  EXPECT_EQ(names.Show(Term::Integer(7)), "7");
  EXPECT_EQ(names.Show(Term::Boolean(true)), "true");
  EXPECT_EQ(names.Show(Term::Literal("a\n\"b\"")), "\"a\\n\\\"b\\\"\"");
  EXPECT_EQ(names.Show(Term::LangString("a", "en")), "\"a\"@en");
  EXPECT_EQ(names.Show(Term::Literal("1", "https://w3id.org/docent/expo#metre")), "\"1\"^^expo:metre");
  EXPECT_EQ(IriNames().Show(Term::Iri(DocentIri("isAt"))), "<https://w3id.org/docent#isAt>");
}

TEST(IriNamesTest, IrisInATextAreNamed) {
  const IriNames names = Expo();
  EXPECT_EQ(names.InText("<https://w3id.org/docent/expo#R01> is at <urn:b>: <https://w3id.org/docent#Booth>"),
            "expo:R01 is at <urn:b>: docent:Booth");
  EXPECT_EQ(names.InText("\"7\"^^<http://www.w3.org/2001/XMLSchema#byte> ."), "\"7\"^^xsd:byte .");
}

TEST(IriNamesTest, LiteralsAndComparisonsInATextStay) {
  const IriNames names = Expo();
  for (const char* text :
       {"\"<https://w3id.org/docent#Booth>\" .", "\"a \\\"<https://w3id.org/docent#Booth>\" .",
        "?x < 3 && ?y > 2", "a < b", "\"open", "<", "<>", "\"\\"})
    EXPECT_EQ(names.InText(text), text);
}

}  // namespace
}  // namespace docent
