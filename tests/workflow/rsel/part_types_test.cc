#include "workflow/rsel/part_types.h"

#include <gtest/gtest.h>

#include "graph/rdf/vocabulary.h"

namespace docent::rsel {
namespace {

std::string Xsd(const std::string& local) {
  return std::string(kXsdNs) + local;
}

bool Is(const Term& value, const std::string& type) {
  return TypeFault(value, type).empty();
}

TEST(PartTypes, ANumberIsOfTheDatatypesThatItCanBe) {
  const Term three = Term::Integer(3), half = Term::Literal("0.5", Xsd("decimal"));
  for (const char* type :
       {"integer", "int", "long", "decimal", "double", "float", "nonNegativeInteger", "unsignedByte"})
    EXPECT_TRUE(Is(three, Xsd(type))) << type;
  EXPECT_TRUE(Is(half, Xsd("decimal")));
  EXPECT_TRUE(Is(half, Xsd("double")));
  EXPECT_FALSE(Is(half, Xsd("integer")));
  EXPECT_FALSE(Is(Term::Integer(-3), Xsd("nonNegativeInteger")));
  EXPECT_FALSE(Is(Term::Integer(300), Xsd("byte")));
  EXPECT_FALSE(Is(three, Xsd("string")));
  EXPECT_FALSE(Is(three, Xsd("boolean")));
  EXPECT_FALSE(Is(Term::Literal("3"), Xsd("integer")));
}

TEST(PartTypes, AWholeNumberIsAnIntegerHoweverItIsWritten) {
  const auto is = [](const std::string& lexical, const std::string& given, const std::string& wanted) {
    return Is(Term::Literal(lexical, Xsd(given)), Xsd(wanted));
  };
  for (const char* lexical : {"4", "04", "4.0", "4.", "+4.000"}) {
    EXPECT_TRUE(is(lexical, "decimal", "integer")) << lexical;
    EXPECT_TRUE(is(lexical, "decimal", "unsignedByte")) << lexical;
  }
  for (const char* lexical : {"4", "4.0", "4e0", "40E-1", "0.4e1"}) {
    EXPECT_TRUE(is(lexical, "double", "integer")) << lexical;
    EXPECT_TRUE(is(lexical, "float", "byte")) << lexical;
    EXPECT_TRUE(is(lexical, "double", "decimal")) << lexical;
  }
  EXPECT_TRUE(is(".0", "decimal", "integer"));
  EXPECT_TRUE(is("-0.0", "double", "unsignedInt"));
  EXPECT_FALSE(is("4.01", "decimal", "integer") || is("4.5e0", "double", "integer"));
  EXPECT_FALSE(is("3e2", "double", "byte") || is("-1.0", "decimal", "unsignedInt"));
  EXPECT_FALSE(is("NaN", "double", "integer") || is("INF", "double", "decimal"));
}

TEST(PartTypes, ZeroIsNeitherPositiveNorNegative) {
  for (const char* zero : {"0", "-0", "+00"}) {
    const Term value = Term::Literal(zero, Xsd("integer"));
    EXPECT_TRUE(Is(value, Xsd("nonNegativeInteger"))) << zero;
    EXPECT_TRUE(Is(value, Xsd("nonPositiveInteger"))) << zero;
    EXPECT_TRUE(Is(value, Xsd("unsignedByte"))) << zero;
    EXPECT_FALSE(Is(value, Xsd("positiveInteger"))) << zero;
    EXPECT_FALSE(Is(value, Xsd("negativeInteger"))) << zero;
  }
  EXPECT_TRUE(Is(Term::Integer(1), Xsd("positiveInteger")));
  EXPECT_FALSE(Is(Term::Integer(-1), Xsd("positiveInteger")));
  EXPECT_TRUE(Is(Term::Integer(-1), Xsd("negativeInteger")));
  EXPECT_FALSE(Is(Term::Integer(1), Xsd("nonPositiveInteger")));
}

TEST(PartTypes, RangesEndWhereTheyEnd) {
  const auto in = [](const std::string& lexical, const std::string& type) {
    return Is(Term::Literal(lexical, Xsd("integer")), Xsd(type));
  };
  EXPECT_TRUE(in("127", "byte") && in("-128", "byte") && in("+127", "byte"));
  EXPECT_FALSE(in("128", "byte") || in("-129", "byte"));
  EXPECT_TRUE(in("255", "unsignedByte") && in("65535", "unsignedShort"));
  EXPECT_FALSE(in("256", "unsignedByte") || in("65536", "unsignedShort") || in("-1", "unsignedByte"));
  EXPECT_TRUE(in("2147483647", "int") && in("-2147483648", "int"));
  EXPECT_FALSE(in("2147483648", "int") || in("-2147483649", "int"));
  EXPECT_TRUE(in("18446744073709551615", "unsignedLong") && in("-9223372036854775808", "long"));
  EXPECT_FALSE(in("18446744073709551616", "unsignedLong") || in("9223372036854775808", "long"));
}

TEST(PartTypes, ALiteralNeedsTheFormOfItsDatatype) {
  EXPECT_FALSE(Is(Term::Literal("three", Xsd("integer")), Xsd("integer")));
  EXPECT_FALSE(Is(Term::Literal("yes", Xsd("boolean")), Xsd("boolean")));
  EXPECT_TRUE(Is(Term::Literal("NaN", Xsd("double")), Xsd("double")));
  EXPECT_TRUE(Is(Term::Boolean(true), Xsd("boolean")));
  const auto of = [](const std::string& lexical, const std::string& type) {
    return Is(Term::Literal(lexical, Xsd(type)), Xsd(type));
  };
  EXPECT_TRUE(of("2026-02-28", "date") && of("23:59:59Z", "time") && of("2026-02-28T24:00:00", "dateTime"));
  EXPECT_FALSE(of("2026-02-30", "date") || of("today", "date") || of("25:00:00", "time") ||
               of("2026-02-28", "dateTime"));
  EXPECT_TRUE(of("2026-02-28T10:00:00Z", "dateTimeStamp"));
  EXPECT_FALSE(of("2026-02-28T10:00:00", "dateTimeStamp"));
  EXPECT_TRUE(of("PT5M", "duration") && of("PT5M", "dayTimeDuration") && of("P1Y", "yearMonthDuration"));
  EXPECT_FALSE(of("5min", "duration") || of("P1Y", "dayTimeDuration") || of("PT5M", "yearMonthDuration"));
}

TEST(PartTypes, TextAndResources) {
  const Term booth = Term::Iri("urn:b3"), text = Term::Literal("hello"),
             welcome = Term::LangString("hello", "en");
  EXPECT_TRUE(Is(text, Xsd("string")));
  EXPECT_TRUE(Is(welcome, Xsd("string")));
  EXPECT_TRUE(Is(text, std::string(kRdfLangString)));
  EXPECT_TRUE(Is(booth, DocentIri("Booth")));
  EXPECT_TRUE(Is(booth, Xsd("anyURI")));
  EXPECT_FALSE(Is(booth, Xsd("string")));
  EXPECT_FALSE(Is(text, DocentIri("Booth")));
  EXPECT_TRUE(Is(text, ""));
  EXPECT_TRUE(Is(text, std::string(kRdfsNs) + "Resource"));
  EXPECT_TRUE(Is(text, std::string(kRdfsNs) + "Literal"));
  EXPECT_EQ(TypeFault(text, DocentIri("Booth")),
            "is a literal, and docent:Booth is a class; give <iri> or prefix:local");
}

TEST(PartTypes, WhatATypeMayBe) {
  EXPECT_TRUE(MayBeOf("", Xsd("integer")));
  EXPECT_TRUE(MayBeOf(Xsd("int"), Xsd("decimal")));
  EXPECT_TRUE(MayBeOf(Xsd("decimal"), Xsd("int")));
  EXPECT_TRUE(MayBeOf(DocentIri("Person"), DocentIri("Visitor")));
  EXPECT_TRUE(MayBeOf("urn:my#datatype", "urn:other#class"));
  EXPECT_FALSE(MayBeOf(Xsd("string"), Xsd("integer")));
  EXPECT_FALSE(MayBeOf(Xsd("dateTime"), Xsd("date")));
  EXPECT_FALSE(MayBeOf(Xsd("string"), DocentIri("Booth")));
  EXPECT_FALSE(MayBeOf(DocentIri("Booth"), Xsd("boolean")));
}

TEST(PartTypes, NamesOfTypes) {
  EXPECT_EQ(FullType("xsd:integer"), Xsd("integer"));
  EXPECT_EQ(FullType("docent:Booth"), DocentIri("Booth"));
  EXPECT_EQ(FullType("https://example.org/Lamp"), "https://example.org/Lamp");
  EXPECT_EQ(PartsText({}, {}), "nothing");
  EXPECT_EQ(
      PartsText({"booth", "times", "where"}, {{"booth", DocentIri("Booth")}, {"times", Xsd("integer")}}),
      "booth (docent:Booth), times (xsd:integer) and where");
}

}  // namespace
}  // namespace docent::rsel
