#include "graph/rdf/formats/serializer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

using testing::HasSubstr;

Term E(std::string local) {
  return Term::Iri("http://e/" + std::move(local));
}

TEST(SerializerTest, TurtleGathersSubjectsAndShortens) {
  std::vector<TermQuad> quads = {{E("s"), E("p"), Term::Integer(2), {}},
                                 {E("s"), Term::Iri(std::string(kRdfType)), E("T"), {}},
                                 {E("s"), E("p"), Term::Literal("-1.5", std::string(kXsdDecimal)), {}},
                                 {E("s"), E("q"), Term::Boolean(false), {}},
                                 {E("a/b"), E("p"), Term::Literal("x", "http://e/dt"), {}},
                                 {E("s"), E("p"), Term::Integer(2), {}}};
  EXPECT_EQ(*SerializeRdf(quads, RdfFormat::kTurtle, {{"e", "http://e/"}}),
            "@prefix e: <http://e/> .\n"
            "\n"
            "<http://e/a/b> e:p \"x\"^^e:dt .\n"
            "\n"
            "e:s a e:T ;\n"
            "    e:p -1.5, 2 ;\n"
            "    e:q false .\n");
}

TEST(SerializerTest, PrefixesThatTurtleCannotNameAreLeftOut) {
  const std::vector<TermQuad> quads = {{E("s"), E("p"), E("o"), {}}};
  for (const char* prefix : {"_e", "e:f", "e.", "\xA9", "-e", "e f"}) {
    const auto text = SerializeRdf(quads, RdfFormat::kTurtle, {{prefix, "http://e/"}});
    ASSERT_TRUE(text.ok());
    EXPECT_EQ(*text, "<http://e/s> <http://e/p> <http://e/o> .\n") << prefix;
  }
  EXPECT_EQ(*SerializeRdf(quads, RdfFormat::kTurtle, {{"e", "relative"}}),
            "<http://e/s> <http://e/p> <http://e/o> .\n");
  EXPECT_EQ(*SerializeRdf(quads, RdfFormat::kTurtle, {{"", "http://e/"}}),
            "@prefix : <http://e/> .\n\n:s :p :o .\n");
  EXPECT_EQ(*SerializeRdf(quads, RdfFormat::kTurtle, {{"\xC3\xA9", "http://e/"}}),
            "@prefix \xC3\xA9: <http://e/> .\n\n\xC3\xA9:s \xC3\xA9:p \xC3\xA9:o .\n");
}

TEST(SerializerTest, APrefixThatIsGivenTwiceMeansTheFirst) {
  const std::vector<TermQuad> quads = {{E("s"), E("p"), Term::Iri("http://f/o"), {}}};
  for (RdfFormat format : {RdfFormat::kTurtle, RdfFormat::kTriG, RdfFormat::kRdfXml}) {
    const auto text = SerializeRdf(quads, format, {{"e", "http://e/"}, {"e", "http://f/"}});
    EXPECT_EQ(ParseRdf(*text, format).quads, quads) << *text;
  }
}

TEST(SerializerTest, CyclesOfBlankNodesSurvive) {
  std::vector<TermQuad> quads = {{Term::Blank("x"), E("p"), Term::Blank("y"), {}},
                                 {Term::Blank("y"), E("p"), Term::Blank("x"), {}}};
  for (RdfFormat format :
       {RdfFormat::kTurtle, RdfFormat::kTriG, RdfFormat::kNTriples, RdfFormat::kNQuads, RdfFormat::kRdfXml}) {
    auto text = SerializeRdf(quads, format);
    ASSERT_TRUE(text.ok());
    EXPECT_EQ(ParseRdf(*text, format).quads.size(), 2u) << *text;
  }
}

TEST(SerializerTest, GraphsNeedAFormatThatHasThem) {
  std::vector<TermQuad> quads = {{E("s"), E("p"), E("o"), E("g")}, {E("s"), E("p"), E("o"), {}}};
  for (RdfFormat format : {RdfFormat::kTriG, RdfFormat::kNQuads}) {
    auto text = SerializeRdf(quads, format);
    ASSERT_TRUE(text.ok());
    EXPECT_EQ(ParseRdf(*text, format).quads.size(), 2u) << *text;
  }
  for (RdfFormat format : {RdfFormat::kTurtle, RdfFormat::kNTriples, RdfFormat::kRdfXml}) {
    EXPECT_THAT(std::string(SerializeRdf(quads, format).status().message()),
                HasSubstr("<http://e/g>: use TriG or N-Quads"));
  }
}

TEST(SerializerTest, WhatLooksLikeANumberButIsNone) {
  for (const char* text : {"", ".", "1.", "+", "1.2.3", "x", "1e0"}) {
    std::vector<TermQuad> quads = {{E("s"), E("p"), Term::Literal(text, std::string(kXsdDecimal)), {}}};
    auto written = SerializeRdf(quads, RdfFormat::kTurtle);
    EXPECT_EQ(ParseRdf(*written, RdfFormat::kTurtle).quads, quads) << *written;
  }
}

TEST(SerializerTest, WhatRdfXmlCannotSay) {
  EXPECT_THAT(std::string(SerializeRdf({{E("s"), Term::Iri("http://e/123"), E("o"), {}}}, RdfFormat::kRdfXml)
                              .status()
                              .message()),
              HasSubstr("<http://e/123>"));
  EXPECT_THAT(
      std::string(
          SerializeRdf({{E("s"), E("p"), Term::Literal("\x01"), {}}}, RdfFormat::kRdfXml).status().message()),
      HasSubstr("U+0001"));
}

TEST(SerializerTest, RdfXmlDoesNotSayWordsOfItsSyntaxAsProperties) {
  for (const std::string& predicate :
       {Concat(kRdfNs, "li"), Concat(kRdfNs, "Description"), Concat(kRdfNs, "about"), Concat(kRdfNs, "bagID"),
        Concat(kRdfNs, "a#b"), Concat(kRdfNs, "a/b"), Concat(kRdfNs, "1a"), Concat(kRdfNs, "a:li"),
        std::string("http://www.w3.org/2000/xmlns/foo"), std::string("http://e/"), std::string("tag")}) {
    const auto written = SerializeRdf({{E("s"), Term::Iri(predicate), E("o"), {}}}, RdfFormat::kRdfXml);
    EXPECT_THAT(std::string(written.status().message()), HasSubstr(Concat("<", predicate, ">")));
  }
}

TEST(SerializerTest, WhatRdfXmlWritesIsReadBack) {
  const std::vector<std::string> predicates = {"http://e/p",
                                               "http://e/x#a\xE2\x80\x93"
                                               "b",
                                               "http://example.org/gr\xC3\xB6\xC3\x9F"
                                               "e#\xC3\xA4",
                                               "urn:a:b.c",
                                               "http://ex:port/p",
                                               "http://e/a?x=1&y",
                                               Concat(kRdfNs, "_1"),
                                               Concat(kRdfNs, "type"),
                                               "http://e/1a-b"};
  std::vector<TermQuad> quads;
  for (const std::string& predicate : predicates) {
    quads.push_back({E("s"), Term::Iri(predicate), Term::Literal("a\x7F]]>\r\n\t b"), {}});
    quads.push_back({E("s"), Term::Iri(predicate), Term::Iri("http://e/o?a=1&b='2'"), {}});
  }
  for (const auto& prefixes :
       std::vector<std::vector<std::pair<std::string, std::string>>>{{},
                                                                     {{"", "http://e/"},
                                                                      {"rdf", "http://e/x#"},
                                                                      {"1", "urn:a:"},
                                                                      {"xmlfoo", "urn:a:"},
                                                                      {"ns0", "urn:x:"}}}) {
    const auto written = SerializeRdf(quads, RdfFormat::kRdfXml, prefixes);
    ASSERT_TRUE(written.ok()) << written.status();
    const ParsedRdf again = ParseRdf(*written, RdfFormat::kRdfXml);
    EXPECT_EQ(again.quads, quads) << *written << Render(again.diagnostics, *written);
  }
}

TEST(SerializerTest, RdfXmlKeepsTextExactly) {
  std::vector<TermQuad> quads = {{E("s"), E("p"), Term::Literal("<&>\"'\r\n\t \xF0\x9F\x98\x80"), {}},
                                 {Term::Blank("7"), E("p"), Term::LangString("x", "de-at"), {}}};
  auto text = SerializeRdf(quads, RdfFormat::kRdfXml, {{"e", "http://e/"}});
  ASSERT_TRUE(text.ok());
  ParsedRdf again = ParseRdf(*text, RdfFormat::kRdfXml);
  ASSERT_EQ(again.quads.size(), 2u) << *text;
  EXPECT_EQ(again.quads[0], quads[0]);
  EXPECT_EQ(again.quads[1].object, quads[1].object);
}

}  // namespace
}  // namespace docent
