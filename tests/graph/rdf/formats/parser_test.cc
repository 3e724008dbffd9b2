#include "graph/rdf/formats/parser.h"
#include "graph/base/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "graph/rdf/formats/line_parser.h"
#include "graph/rdf/term_check.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;

const Term kNoGraph;
Term E(std::string local) {
  return Term::Iri("http://e/" + std::move(local));
}

// The rendered mistakes of a text that must not parse.
std::string Mistakes(const std::string& text, RdfFormat format = RdfFormat::kTurtle,
                     ParseRdfOptions options = {}) {
  ParsedRdf parsed = ParseRdf(text, format, options);
  EXPECT_FALSE(parsed.ok()) << text;
  EXPECT_THAT(parsed.quads, IsEmpty());
  for (const Diagnostic& d : parsed.diagnostics) {
    EXPECT_GT(d.span.line, 0);
    EXPECT_GT(d.span.column, 0);
  }
  return Render(parsed.diagnostics, text);
}

TEST(ParserTest, FormatByNameAndMediaType) {
  EXPECT_EQ(FormatOfFile("a/b.ttl"), RdfFormat::kTurtle);
  EXPECT_EQ(FormatOfFile("x.OWL"), RdfFormat::kRdfXml);
  EXPECT_EQ(FormatOfFile("x.nq"), RdfFormat::kNQuads);
  EXPECT_EQ(FormatOfFile("x.json"), std::nullopt);
  EXPECT_EQ(FormatOfMediaType("text/turtle; charset=utf-8"), RdfFormat::kTurtle);
  EXPECT_EQ(FormatOfMediaType(" Application/RDF+XML "), RdfFormat::kRdfXml);
  EXPECT_EQ(FormatOfMediaType("text/html"), std::nullopt);
  EXPECT_EQ(FormatOfFile("x.nt.gz"), RdfFormat::kNTriples);
  EXPECT_EQ(FormatOfFile("x.gz"), std::nullopt);
  EXPECT_THAT(UnknownMediaType("application/ld+json; profile=x"),
              HasSubstr("\"application/ld+json\" is JSON-LD, which is not read; text/turtle, "));
  EXPECT_THAT(UnknownMediaType("image/png"), HasSubstr("\"image/png\" is not known; text/turtle, "));
}

TEST(ParserTest, TurtleTermsAndPrefixes) {
  ParsedRdf parsed = ParseRdf(
      "@prefix e: <http://e/> . @prefix : <http://d/> .\n"
      "e:s a e:T ; e:p 1, 2.5, 1e0, true, \"x\"@EN, \"y\"^^e:dt, '''long\n''' ; e:q [ e:r () ] .\n",
      RdfFormat::kTurtle);
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, "");
  EXPECT_THAT(parsed.prefixes, ElementsAre(Pair("e", "http://e/"), Pair("", "http://d/")));
  EXPECT_THAT(parsed.quads,
              ElementsAre(TermQuad{E("s"), Term::Iri(std::string(kRdfType)), E("T"), kNoGraph},
                          TermQuad{E("s"), E("p"), Term::Integer(1), kNoGraph},
                          TermQuad{E("s"), E("p"), Term::Literal("2.5", std::string(kXsdDecimal)), kNoGraph},
                          TermQuad{E("s"), E("p"), Term::Literal("1e0", std::string(kXsdDouble)), kNoGraph},
                          TermQuad{E("s"), E("p"), Term::Boolean(true), kNoGraph},
                          TermQuad{E("s"), E("p"), Term::LangString("x", "en"), kNoGraph},
                          TermQuad{E("s"), E("p"), Term::Literal("y", "http://e/dt"), kNoGraph},
                          TermQuad{E("s"), E("p"), Term::Literal("long\n"), kNoGraph},
                          TermQuad{Term::Blank("b1"), E("r"), Term::Iri(Concat(kRdfNs, "nil")), kNoGraph},
                          TermQuad{E("s"), E("q"), Term::Blank("b1"), kNoGraph}));
}

TEST(ParserTest, BlankNodeLabelsNeverMeet) {
  ParseRdfOptions options;
  options.blank_node_scope = "d7-";
  ParsedRdf parsed = ParseRdf("_:b1 <http://e/p> [], _:B1, [] .", RdfFormat::kTurtle, options);
  ASSERT_TRUE(parsed.ok());
  ASSERT_THAT(parsed.quads, SizeIs(3));
  EXPECT_EQ(parsed.quads[0].subject, Term::Blank("d7-b1"));
  EXPECT_EQ(parsed.quads[0].object, Term::Blank("d7-b2"));
  EXPECT_EQ(parsed.quads[1].object, Term::Blank("d7-B1"));
  EXPECT_EQ(parsed.quads[2].object, Term::Blank("d7-b3"));
}

// The grammar allows white space between any two tokens (Turtle section 6.1).
TEST(ParserTest, WhiteSpaceMayStandWithinALiteral) {
  const ParsedRdf turtle = ParseRdf(
      "@prefix : <http://e/> . :a :b \"1\" ^^ :int , 'x'\n@en , \"2\" # two\n^^:int , \"y\" .\n:a :b \"z\" . "
      "@prefix x: <http://x/> .",
      RdfFormat::kTurtle);
  ASSERT_TRUE(turtle.ok()) << Render(turtle.diagnostics, "");
  std::vector<Term> objects;
  for (const TermQuad& quad : turtle.quads) objects.push_back(quad.object);
  EXPECT_THAT(objects,
              ElementsAre(Term::Literal("1", "http://e/int"), Term::LangString("x", "en"),
                          Term::Literal("2", "http://e/int"), Term::Literal("y"), Term::Literal("z")));
  const ParsedRdf lines =
      ParseRdf("<urn:a> <urn:b> \"1\"\t^^ <urn:int> .\n<urn:a> <urn:b> \"x\" @en .", RdfFormat::kNTriples);
  ASSERT_TRUE(lines.ok()) << Render(lines.diagnostics, "");
  EXPECT_EQ(lines.quads[0].object, Term::Literal("1", "urn:int"));
  EXPECT_EQ(lines.quads[1].object, Term::LangString("x", "en"));
  EXPECT_THAT(Mistakes("@prefix : <http://e/> .\n:a :b \"x\"\n@prefix x: <http://x/> ."),
              HasSubstr("3:1: error: expected '.'"));
}

TEST(ParserTest, NumbersBeforeADot) {
  ParsedRdf parsed = ParseRdf("@prefix e: <http://e/>. e:s e:p 1.e:t e:p 2.5.e:u e:p .5e1.e:v e:p -1.E2.",
                              RdfFormat::kTurtle);
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, "");
  ASSERT_THAT(parsed.quads, SizeIs(4));
  EXPECT_EQ(parsed.quads[0].object, Term::Integer(1));
  EXPECT_EQ(parsed.quads[1].object.lexical, "2.5");
  EXPECT_EQ(parsed.quads[2].object.lexical, ".5e1");
  EXPECT_EQ(parsed.quads[3].object.lexical, "-1.E2");
}

TEST(ParserTest, GraphsOfTriGAndNQuads) {
  ParsedRdf trig = ParseRdf(
      "PREFIX e: <http://e/> e:s e:p e:o . GRAPH e:g { e:s e:p e:o . e:s e:p 2 } { e:s e:p 3 } _:g { [] e:p "
      "4 . }",
      RdfFormat::kTriG);
  ASSERT_TRUE(trig.ok()) << Render(trig.diagnostics, "");
  ASSERT_THAT(trig.quads, SizeIs(5));
  EXPECT_EQ(trig.quads[0].graph, kNoGraph);
  EXPECT_EQ(trig.quads[2].graph, E("g"));
  EXPECT_EQ(trig.quads[3].graph, kNoGraph);
  EXPECT_EQ(trig.quads[4].graph, Term::Blank("g"));
  ParsedRdf nquads = ParseRdf("<http://e/s> <http://e/p> \"o\" <http://e/g> . # end\n", RdfFormat::kNQuads);
  ASSERT_TRUE(nquads.ok());
  EXPECT_EQ(nquads.quads[0].graph, E("g"));
}

TEST(ParserTest, AllMistakesWithPlaceAndHint) {
  std::string text =
      "@prefix ex: <http://e/> .\n"
      "ex:a exx:b 1 .\n"
      "ex:c ex:d \"no end .\n"
      "ex:e ex:f 3 .\n"
      "ex:g \"literal\" 4 .\n"
      "foaf:x ex:p geo:y .\n";
  std::string found = Mistakes(text);
  EXPECT_THAT(found, HasSubstr("2:6: error: the prefix 'exx:' is not declared\n  ex:a exx:b 1 .\n       ^\n  "
                               "hint: did you mean ex:?"));
  EXPECT_THAT(found, HasSubstr("3:11: error: this string has no end on its line"));
  EXPECT_THAT(found, HasSubstr("5:6: error: a literal can't be a predicate"));
  EXPECT_THAT(found, HasSubstr("6:1: error: the prefix 'foaf:' is not declared"));
}

TEST(ParserTest, MistakesAreLimited) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += "x:a x:b x:c .\n";
  EXPECT_THAT(ParseRdf(text, RdfFormat::kTurtle).diagnostics, SizeIs(Limits().document_diagnostics));
}

TEST(ParserTest, SingleMistakes) {
  EXPECT_THAT(Mistakes("<rel> <http://e/p> 1 ."),
              HasSubstr("1:1: error: <rel> is relative and the document has no base IRI"));
  EXPECT_THAT(Mistakes("<http://e/a b> <http://e/p> 1 ."), HasSubstr("U+0020 is not allowed in an IRI"));
  EXPECT_THAT(Mistakes("<http://e/a> <http://e/p> \"\\uD83D\" ."),
              HasSubstr("U+D83D is not a Unicode character"));
  EXPECT_THAT(Mistakes("<http://e/a> <http://e/p> \"\\q\" ."), HasSubstr("unknown escape"));
  EXPECT_THAT(Mistakes("<http://e/a> <http://e/p> 1"),
              HasSubstr("expected '.' at the end of the statement, found the end of the document"));
  EXPECT_THAT(
      Mistakes("<http://e/a> <http://e/p> \"x\"^^<http://www.w3.org/1999/02/22-rdf-syntax-ns#langString> ."),
      HasSubstr("needs a language tag"));
  EXPECT_THAT(Mistakes("@PREFIX e: <http://e/> ."), HasSubstr("unknown directive"));
  EXPECT_THAT(Mistakes("<http://e/a> <http://e/p> <http://e/b> . <http://e/c>", RdfFormat::kNTriples),
              HasSubstr("expected the end of the line"));
  EXPECT_THAT(Mistakes("<a> <http://e/p> 1 .", RdfFormat::kNTriples, {"", "http://base/"}),
              HasSubstr("not an absolute IRI"));
  EXPECT_THAT(Mistakes("{ <http://e/a> <http://e/p> 1 ", RdfFormat::kTriG), HasSubstr("expected '.' or '}'"));
}

TEST(ParserTest, WhatIsOfRdf12IsNamed) {
  const std::string iris = "<urn:s> <urn:p> ";
  for (const RdfFormat format :
       {RdfFormat::kTurtle, RdfFormat::kTriG, RdfFormat::kNTriples, RdfFormat::kNQuads}) {
    EXPECT_THAT(Mistakes("<< <urn:a> <urn:p> 1 >> <urn:q> 2 .", format),
                HasSubstr("1:1: error: '<<' opens a triple term"));
    EXPECT_THAT(Mistakes(iris + "<<( <urn:a> <urn:p> <urn:o> )>> .", format),
                HasSubstr("1:17: error: '<<' opens a triple term"));
    EXPECT_THAT(Mistakes("VERSION \"1.2\"\n", format),
                HasSubstr("1:8: error: VERSION is of RDF 1.2, which is not read"));
    EXPECT_THAT(Mistakes(iris + "\"x\"@ar--rtl .", format),
                HasSubstr("1:23: error: base directions of texts"));
  }
  for (const RdfFormat format : {RdfFormat::kTurtle, RdfFormat::kTriG}) {
    EXPECT_THAT(Mistakes(iris + "<urn:o> {| <urn:q> 1 |} .", format),
                HasSubstr("1:25: error: '{|' opens an annotation"));
    EXPECT_THAT(Mistakes(iris + "1 ~ <urn:r> .", format), HasSubstr("'~' names a reifier"));
    EXPECT_THAT(Mistakes("@version \"1.2\" .", format), HasSubstr("@version is of RDF 1.2"));
    EXPECT_THAT(Mistakes("[ <urn:p> << <urn:a> <urn:p> 1 >> ] .", format), HasSubstr("'<<' opens"));
    EXPECT_THAT(Mistakes("<urn:s> <urn:p> (<<( <urn:a> <urn:p> 1 )>>) .", format), HasSubstr("'<<' opens"));
  }
  EXPECT_TRUE(ParseRdf("@prefix version: <urn:v:> . @prefix VERSION: <urn:w:> . version:a VERSION:b 1 .",
                       RdfFormat::kTurtle)
                  .ok());
}

TEST(ParserTest, OtherSyntaxesAreNamed) {
  EXPECT_THAT(Mistakes("\n {\n  \"@context\": {} }"),
              HasSubstr("2:2: error: this looks like JSON-LD, which is not read"));
  EXPECT_THAT(Mistakes("[{\"@id\": \"a\"}]", RdfFormat::kTriG), HasSubstr("JSON-LD"));
  EXPECT_THAT(Mistakes("{ <urn:a> <urn:b> 1 } => { <urn:a> <urn:c> 1 } ."),
              HasSubstr("1:1: error: '{' opens a graph, which Turtle does not have"));
  EXPECT_THAT(Mistakes("@keywords a ."), HasSubstr("those of Notation3 are not read"));
  EXPECT_TRUE(ParseRdf("{ } { <urn:a> <urn:b> 1 } [] <urn:b> 1 .", RdfFormat::kTriG).ok());
  EXPECT_THAT(Mistakes("\x1F\x8B\x08rest"), HasSubstr("these are gzip data"));
}

TEST(ParserTest, BytesThatAreNoText) {
  EXPECT_THAT(Mistakes("<http://e/a> <http://e/p> \"\xFF\" ."),
              HasSubstr("1:28: error: the byte 0xFF here is not UTF-8"));
  std::string zero("<http://e/a> \0 .", 16);
  EXPECT_THAT(Mistakes(zero), HasSubstr("expected a prefixed name"));
  EXPECT_THAT(Mistakes(std::string("<a>\0</a>", 8), RdfFormat::kRdfXml),
              HasSubstr("U+0000 is not allowed in XML"));
  EXPECT_TRUE(ParseRdf("\xEF\xBB\xBF<http://e/a> <http://e/p> 1 .", RdfFormat::kTurtle).ok());
}

TEST(ParserTest, LimitsAtAndOnePast) {
  ParseRdfOptions options;
  options.limits.term_bytes = 12;
  options.limits.turtle_nesting = 3;
  EXPECT_TRUE(ParseRdf("<urn:a> <urn:b> \"123456789012\" .", RdfFormat::kTurtle, options).ok());
  EXPECT_THAT(Mistakes("<urn:a> <urn:b> \"1234567890123\" .", RdfFormat::kTurtle, options),
              HasSubstr("term_bytes is 12"));
  EXPECT_TRUE(ParseRdf("<urn:a> <urn:b> (((1))) .", RdfFormat::kTurtle, options).ok());
  EXPECT_THAT(Mistakes("<urn:a> <urn:b> ((((1)))) .", RdfFormat::kTurtle, options),
              HasSubstr("turtle_nesting = 3"));
  std::string text = "<urn:a> <urn:b> 1 .";
  options.limits.document_bytes = text.size();
  EXPECT_TRUE(ParseRdf(text, RdfFormat::kTurtle, options).ok());
  EXPECT_THAT(Mistakes(text + " ", RdfFormat::kTurtle, options), HasSubstr("document_bytes is 19"));
}

TEST(ParserTest, TriplesAreBoundedByTheLimitOfTheDocument) {
  ParseRdfOptions options;
  options.limits.document_bytes = 40000;  // 1250 triples
  const auto turtle = [](int count) {
    std::string text = "<urn:a> <urn:b> 0";
    for (int i = 1; i < count; ++i) text += "," + std::to_string(i);
    return text + " .";
  };
  EXPECT_EQ(ParseRdf(turtle(1250), RdfFormat::kTurtle, options).quads.size(), 1250u);
  const ParsedRdf refused = ParseRdf(turtle(5000), RdfFormat::kTurtle, options);
  EXPECT_TRUE(refused.quads.empty());
  ASSERT_EQ(refused.diagnostics.size(), 1u);
  EXPECT_THAT(refused.diagnostics[0].message,
              HasSubstr("more than 1250 triples: one for each 32 bytes of the limit document_bytes"));
  const auto lists = [](int count) {
    std::string text = "<urn:a> <urn:b> (";
    for (int i = 0; i < count; ++i) text += "1 ";
    return text + ") .";
  };
  EXPECT_EQ(ParseRdf(lists(624), RdfFormat::kTriG, options).quads.size(), 1249u);
  EXPECT_EQ(ParseRdf(lists(625), RdfFormat::kTriG, options).diagnostics.size(), 1u);
  options.limits.document_bytes = 32000;  // 1000
  const auto xml = [](int count) {
    std::string text = "<r:RDF xmlns:r='http://www.w3.org/1999/02/22-rdf-syntax-ns#' xmlns:e='urn:e:'><e:a>";
    for (int i = 1; i < count; ++i) text += "<e:p/>";
    return text + "</e:a></r:RDF>";
  };
  EXPECT_EQ(ParseRdf(xml(1000), RdfFormat::kRdfXml, options).quads.size(), 1000u);
  EXPECT_THAT(Mistakes(xml(1001), RdfFormat::kRdfXml, options), HasSubstr("more than 1000 triples"));
}

TEST(ParserTest, APrefixThatIsDeclaredAgainCountsAtItsLastPlace) {
  const ParsedRdf parsed =
      ParseRdf("@prefix a: <urn:1:> . @prefix b: <urn:2:> . a:s a:p 1 . @prefix a: <urn:3:> . a:s a:p 1 .",
               RdfFormat::kTurtle);
  ASSERT_TRUE(parsed.ok());
  EXPECT_THAT(parsed.prefixes, ElementsAre(Pair("b", "urn:2:"), Pair("a", "urn:3:")));
  EXPECT_EQ(parsed.quads[0].subject, Term::Iri("urn:1:s"));
  EXPECT_EQ(parsed.quads[1].subject, Term::Iri("urn:3:s"));
}

// In quadratic time these would take many minutes.
TEST(ParserTest, ManyPrefixesAreRead) {
  std::string text;
  for (int i = 0; i < 150000; ++i) {
    text += "@prefix p" + std::to_string(i % 100000) + ": <urn:" + std::to_string(i) + ":> .\n";
  }
  const ParsedRdf parsed = ParseRdf(text + "p7:s p7:p p99999:o .", RdfFormat::kTurtle);
  ASSERT_TRUE(parsed.ok());
  EXPECT_THAT(parsed.prefixes, SizeIs(100000));
  EXPECT_EQ(parsed.quads[0].subject, Term::Iri("urn:100007:s"));
  EXPECT_THAT(Mistakes(text + "q:s q:p 1 . "), HasSubstr("the prefix 'q:' is not declared"));
}

TEST(ParserTest, ShortNamesUnderLongPrefixesDoNotGrowWithoutEnd) {
  ParseRdfOptions options;
  options.limits.document_bytes = 100000;  // 1.6 MB of terms
  const std::string iri = "urn:" + std::string(10000, 'x') + ":";
  std::string names, references;
  for (int i = 0; i < 300; ++i) {
    names += "a:s a:p a:o .\n";
    references += "<s> <p> <o> .\n";
  }
  EXPECT_THAT(Mistakes("@prefix a: <" + iri + "> .\n" + names, RdfFormat::kTurtle, options),
              HasSubstr("16 for each byte of the limit document_bytes"));
  options.base_iri = iri + "/";
  EXPECT_THAT(Mistakes("@base <http://e/" + iri + "/> .\n" + references, RdfFormat::kTurtle, options),
              HasSubstr("16 for each byte of the limit document_bytes"));
  options.limits.term_bytes = iri.size() + 1;
  EXPECT_TRUE(ParseRdf("@prefix a: <" + iri + "> . a:s a:p a:o .", RdfFormat::kTurtle, options).ok());
  EXPECT_THAT(Mistakes("@prefix a: <" + iri + "> . a:ss a:p a:o .", RdfFormat::kTurtle, options),
              HasSubstr("written out; the limit term_bytes is 10006"));
  EXPECT_THAT(
      Mistakes("@base <http://e/" + std::string(9900, 'x') + "/> . <" + std::string(200, 'y') + "> a 1 .",
               RdfFormat::kTurtle, options),
      HasSubstr("written out; the limit term_bytes is 10006"));
}

TEST(ParserTest, TheTimeLimitAndACallerWhoLeavesEndEveryFormat) {
  std::string lines, objects = "<urn:s> <urn:p> 0";
  for (int i = 0; i < 100000; ++i) {
    lines += "<urn:s> <urn:p> \"" + std::to_string(i) + "\" .\n";
    objects += "," + std::to_string(i);
  }
  for (const RdfFormat format :
       {RdfFormat::kTurtle, RdfFormat::kTriG, RdfFormat::kNTriples, RdfFormat::kNQuads}) {
    for (const std::string& text : {lines, format == RdfFormat::kTurtle ? objects + " ." : lines}) {
      Cancellation cancelled, late(std::chrono::milliseconds(1));
      cancelled.Cancel();
      ParseRdfOptions options;
      options.cancellation = &cancelled;
      EXPECT_EQ(ToStatus(ParseRdf(text, format, options), text).code(), absl::StatusCode::kCancelled);
      options.cancellation = &late;
      const ParsedRdf parsed = ParseRdf(text, format, options);
      EXPECT_EQ(ToStatus(parsed, text).code(), absl::StatusCode::kDeadlineExceeded);
      EXPECT_FALSE(parsed.ok());
      EXPECT_THAT(parsed.quads, IsEmpty());
      EXPECT_THAT(parsed.diagnostics, IsEmpty());
    }
  }
  Cancellation cancelled;
  ParseRdfOptions options;
  options.cancellation = &cancelled;
  size_t seen = 0;
  const auto visit = [&](const TermQuad&) {
    if (++seen == 500) cancelled.Cancel();
    return true;
  };
  EXPECT_EQ(ParseLines(lines, RdfFormat::kNTriples, options, visit).stopped.code(),
            absl::StatusCode::kCancelled);
  EXPECT_LT(seen, 1500u);
}

TEST(ParserTest, DeepNestingIsRefusedNotACrash) {
  std::string deep(200000, '[');
  EXPECT_THAT(Mistakes("<urn:a> <urn:b> " + std::string(200000, '(')), HasSubstr("turtle_nesting"));
  EXPECT_THAT(Mistakes(deep), HasSubstr("error"));
}

std::string RdfXml(const std::string& body) {
  return "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" xmlns:e=\"http://e/\">\n" +
         body + "\n</rdf:RDF>";
}

TEST(ParserTest, GraphsThatAreNotTakenHaveTheirPlaces) {
  ParseRdfOptions options;
  options.refuse_graph = [](const Term& graph) {
    return graph.IsIri() && graph.lexical != "urn:no" ? "" : "not " + graph.lexical;
  };
  const auto places = [&options](const std::string& text, RdfFormat format) {
    std::string out;
    for (const Diagnostic& d : ParseRdf(text, format, options).diagnostics)
      out += std::to_string(d.span.line) + ":" + std::to_string(d.span.column) + " " + d.message + "\n";
    return out;
  };
  EXPECT_EQ(places("<urn:a> <urn:p> 1 .\n<urn:no> { <urn:a> <urn:p> 2 }\nGRAPH <urn:no> { }\n<urn:g> { "
                   "<urn:no> <urn:p> 3 }",
                   RdfFormat::kTriG),
            "2:1 not urn:no\n3:7 not urn:no\n");
  EXPECT_EQ(places("_:x { <urn:a> <urn:p> 2 }", RdfFormat::kTriG), "1:1 not x\n");
  EXPECT_EQ(places("[] { <urn:a> <urn:p> 2 }", RdfFormat::kTriG).substr(0, 8), "1:1 not ");
  EXPECT_EQ(places("<urn:a> <urn:p> <urn:no> .\n<urn:a> <urn:p> <urn:b> <urn:no> .\n", RdfFormat::kNQuads),
            "2:25 not urn:no\n");
  EXPECT_EQ(places("<urn:no> <urn:p> 1 .", RdfFormat::kTurtle), "");
}

TEST(ParserTest, OtherSyntaxesUnderTheEndingsOfRdfXml) {
  const auto mistake = [](const std::string& text) { return Mistakes(text, RdfFormat::kRdfXml); };
  EXPECT_THAT(mistake("\n@prefix : <urn:e:> . :a :b :c ."), HasSubstr("2:1: error: this is not XML"));
  EXPECT_THAT(mistake("<http://e/a> <http://e/b> 1 ."), HasSubstr("ends with .ttl"));
  EXPECT_THAT(mistake("Prefix(:=<urn:e:>)\nOntology(<urn:e>)"), HasSubstr("OWL functional syntax"));
  EXPECT_THAT(mistake("Prefix: : <urn:e:>\nOntology: <urn:e>"), HasSubstr("OWL Manchester syntax"));
  const std::string owl_xml =
      "<Ontology xmlns=\"http://www.w3.org/2002/07/owl#\" ontologyIRI=\"urn:e\"></Ontology>";
  EXPECT_THAT(mistake("<?xml version=\"1.0\"?>\n<!-- x -->\n" + owl_xml),
              HasSubstr("3:1: error: this is OWL/XML"));
  const std::string lone =
      "<Ontology xmlns=\"http://www.w3.org/2002/07/owl#\" "
      "xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" "
      "rdf:about=\"urn:o\"><versionInfo>1</versionInfo></Ontology>";
  EXPECT_EQ(ParseRdf(lone, RdfFormat::kRdfXml).quads.size(), 2u) << "rdf:RDF may be left out around one node";
  EXPECT_TRUE(
      ParseRdf("<?xml version=\"1.0\"?>\n<!-- " + owl_xml + " -->\n" + RdfXml(""), RdfFormat::kRdfXml).ok());
}

TEST(ParserTest, RdfXml) {
  ParsedRdf parsed = ParseRdf(RdfXml("<e:T rdf:about=\"http://e/s\"><e:p>x</e:p><e:q "
                                     "rdf:nodeID=\"n\"/><e:r><rdf:Description/></e:r></e:T>"),
                              RdfFormat::kRdfXml);
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, "");
  ASSERT_THAT(parsed.quads, SizeIs(4));
  EXPECT_EQ(parsed.quads[1], (TermQuad{E("s"), E("p"), Term::Literal("x"), kNoGraph}));
  EXPECT_EQ(parsed.quads[2].object, Term::Blank("n"));
  EXPECT_EQ(parsed.quads[3].object, Term::Blank("b1"));
  EXPECT_THAT(parsed.prefixes, ElementsAre(Pair("rdf", std::string(kRdfNs)), Pair("e", "http://e/")));
}

TEST(ParserTest, ANodeIdThatOtherSyntaxesCannotWriteIsStillOneNode) {
  const ParsedRdf parsed =
      ParseRdf(RdfXml("<e:T rdf:nodeID=\"n.\"><e:p rdf:nodeID=\"n.\"/><e:q rdf:nodeID=\"m\"/></e:T>"),
               RdfFormat::kRdfXml);
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, "");
  ASSERT_THAT(parsed.quads, SizeIs(3));
  EXPECT_EQ(parsed.quads[1].object, parsed.quads[0].subject);
  EXPECT_NE(parsed.quads[2].object, parsed.quads[0].subject);
  for (const TermQuad& quad : parsed.quads) EXPECT_TRUE(CheckQuad(quad, Limits().term_bytes).ok());
}

TEST(ParserTest, ManyThreads) {
  std::vector<std::thread> threads;
  std::atomic<int> good{0};
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&good] {
      for (int i = 0; i < 50; ++i) {
        bool xml = ParseRdf(RdfXml("<e:T rdf:about=\"http://e/s\"/>"), RdfFormat::kRdfXml).quads.size() == 1;
        bool bad = !ParseRdf(RdfXml("<e:T"), RdfFormat::kRdfXml).ok();
        if (xml && bad && ParseRdf("<urn:a> <urn:b> 1 .", RdfFormat::kTurtle).ok()) ++good;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(good, 200);
}

}  // namespace
}  // namespace docent
