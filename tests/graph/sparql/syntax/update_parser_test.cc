#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/sparql/syntax/parser.h"

namespace docent::sparql {
namespace {

using Kind = UpdateOperation::Kind;
using testing::HasSubstr;

ParsedUpdate Parse(const std::string& text, const Limits& limits = {}) {
  ParseOptions options;
  options.prefixes = {{"", "http://e/"}};
  options.limits = limits;
  return ParseUpdate(text, options);
}

std::string Complaint(const std::string& text) {
  const ParsedUpdate parsed = Parse(text);
  EXPECT_FALSE(parsed.ok()) << text;
  return Render(parsed.diagnostics, text);
}

TEST(UpdateParser, EachOperationIsRead) {
  const std::string text =
      "PREFIX x: <http://x/> INSERT DATA { :a :b 1, 2 . GRAPH x:g { :a :b [ :c ( 1 ) ] } :z :b 3 } ;\n"
      "DELETE DATA { :a :b 1 } ; DELETE WHERE { ?s :b ?o . GRAPH ?g { ?s :c ?o } } ;\n"
      "PREFIX y: <http://y/> WITH y:g DELETE { ?s :b ?o } INSERT { GRAPH ?o { ?s :b _:n } }\n"
      "  USING :u USING NAMED :n WHERE { ?s :b ?o FILTER(?o > 1) } ;\n"
      "LOAD SILENT <http://d/> INTO GRAPH :g ; LOAD <http://d/> ; CLEAR SILENT NAMED ; DROP ALL ; CREATE "
      "GRAPH :g ;\n"
      "COPY DEFAULT TO :b ; MOVE SILENT GRAPH :a TO DEFAULT ; ADD :a TO GRAPH :b ;";
  const ParsedUpdate parsed = Parse(text);
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  const auto& o = parsed.update.operations;
  ASSERT_EQ(o.size(), 12u);
  EXPECT_EQ(o[0].kind, Kind::kInsertData);
  ASSERT_EQ(o[0].insert.size(), 7u);  // of the collection in the blank node, four
  EXPECT_FALSE(o[0].insert[0].graph);
  EXPECT_EQ(o[0].insert[2].graph->term().lexical, "http://x/g");
  EXPECT_FALSE(o[0].insert[6].graph);
  EXPECT_EQ(o[1].kind, Kind::kDeleteData);
  EXPECT_EQ(o[2].remove.size(), 2u);
  EXPECT_EQ(o[2].where->kind, Algebra::Kind::kJoin);
  EXPECT_EQ(o[3].with->lexical, "http://y/g");
  EXPECT_EQ(o[3].from.size(), 1u);
  EXPECT_EQ(o[3].from_named.size(), 1u);
  EXPECT_TRUE(o[3].insert[0].graph->IsVariable());
  EXPECT_TRUE(o[4].silent);
  EXPECT_EQ(o[4].target.kind, GraphTarget::Kind::kGraph);
  EXPECT_EQ(o[5].target.kind, GraphTarget::Kind::kDefault);
  EXPECT_EQ(o[6].target.kind, GraphTarget::Kind::kNamed);
  EXPECT_EQ(o[7].target.kind, GraphTarget::Kind::kAll);
  EXPECT_EQ(o[8].kind, Kind::kCreate);
  EXPECT_EQ(o[9].source.kind, GraphTarget::Kind::kDefault);
  EXPECT_EQ(o[10].kind, Kind::kMove);
  EXPECT_EQ(o[11].target.graph.lexical, "http://e/b");
}

TEST(UpdateParser, NothingIsAnUpdateThatDoesNothing) {
  EXPECT_TRUE(Parse("").ok());
  EXPECT_TRUE(Parse("PREFIX x: <http://x/>").update.operations.empty());
}

TEST(UpdateParser, MistakesAreNamedWithTheirPlaceAndRemedy) {
  EXPECT_THAT(Complaint("INSERT DATA { ?s :b 1 }"),
              testing::AllOf(HasSubstr("1:15"), HasSubstr("?s is a variable"), HasSubstr("WHERE")));
  EXPECT_THAT(Complaint("DELETE DATA { _:s :b 1 }"), HasSubstr("blank node cannot be deleted"));
  EXPECT_THAT(Complaint("DELETE WHERE { [] :b 1 }"), HasSubstr("use a variable"));
  EXPECT_THAT(Complaint("INSERT DATA { GRAPH ?g { :a :b 1 } }"), HasSubstr("?g is a variable"));
  EXPECT_THAT(Complaint("SELECT * { ?s ?p ?o }"), HasSubstr("this is a query, not an update"));
  EXPECT_THAT(Complaint("INSERT { :a :b 1 }"), HasSubstr("WHERE after INSERT"));
  EXPECT_THAT(Complaint("CLEAR :g"), HasSubstr("GRAPH <iri>, DEFAULT, NAMED or ALL"));
  EXPECT_THAT(Complaint("INSERT DATA { _:a :b 1 } ; INSERT DATA { _:a :b 2 }"),
              HasSubstr("another INSERT DATA"));
  EXPECT_THAT(Complaint("INSERT DATA { :a :b/:c 1 }"), HasSubstr("1:20"));
  EXPECT_THAT(
      Complaint("INSERT DATA { ?s :b . }"),
      testing::AllOf(HasSubstr("expected a variable, IRI"), testing::Not(HasSubstr("?s is a variable"))));
  EXPECT_THAT(Complaint("CLEAR ALL CLEAR ALL"), HasSubstr("';' before the next operation"));
}

TEST(UpdateParser, SeveralMistakesAreReportedTogether) {
  const ParsedUpdate parsed =
      Parse("INSERT DATA { ?s :b 1 . :a nope:c 2 } ; CLEAR WHAT ; DROP ALL ; DELETE { :a :b }");
  EXPECT_GE(parsed.diagnostics.size(), 4u);
}

TEST(UpdateParser, ShortNamesUnderALongPrefixDoNotGrowWithoutEnd) {
  Limits limits;
  limits.update_text_bytes = 24000;  // 384,000 bytes of IRIs
  const std::string iri = "urn:" + std::string(10000, 'x') + ":";
  const auto data = [&](const std::string& prologue, const std::string& name, int count) {
    std::string text = prologue + " INSERT DATA { <urn:s> <urn:p> 0";
    for (int i = 0; i < count; ++i) text += "," + name;
    return text + " }";
  };
  EXPECT_TRUE(Parse(data("PREFIX a: <" + iri + ">", "a:o", 38), limits).ok());
  for (const ParsedUpdate& refused : {Parse(data("PREFIX a: <" + iri + ">", "a:o", 500), limits),
                                      Parse(data("BASE <http://e/" + iri + "/>", "<o>", 500), limits)}) {
    ASSERT_EQ(refused.diagnostics.size(), 1u);
    EXPECT_THAT(refused.diagnostics[0].message, HasSubstr("more than 384000 bytes, written out"));
  }
}

TEST(UpdateParser, ManyPrefixesAreRead) {
  std::string text;
  for (int i = 0; i < 100000; ++i)
    text += "PREFIX p" + std::to_string(i) + ": <urn:" + std::to_string(i) + ":>\n";
  EXPECT_TRUE(Parse(text + "INSERT DATA { p7:s p99999:p p0:o }", {}).ok());
  EXPECT_FALSE(Parse(text + "INSERT DATA { q:s p99999:p p0:o }", {}).ok());
}

TEST(UpdateParser, TriplesAreBoundedByTheLimitOfTheText) {
  Limits limits;
  limits.update_text_bytes = 24000;  // 1500 triples
  const auto data = [](int count) {
    std::string text = "INSERT DATA { :a :b 0";
    for (int i = 1; i < count; ++i) text += i % 2 == 0 ? "; :c " : ",", text += std::to_string(i);
    return text + " }";
  };
  const ParsedUpdate most = Parse(data(1500), limits);
  ASSERT_TRUE(most.ok());
  EXPECT_EQ(most.update.operations[0].insert.size(), 1500u);
  const ParsedUpdate refused = Parse(data(1501), limits);
  ASSERT_EQ(refused.diagnostics.size(), 1u);
  EXPECT_THAT(refused.diagnostics[0].message,
              HasSubstr("more than 1500 triples: one for each 16 bytes of the limit update_text_bytes"));
  EXPECT_FALSE(Parse(data(800) + "; " + data(800), limits).ok()) << "of all operations";
}

TEST(UpdateParser, WhatDoesNotFitIntoTheLimitIsRefused) {
  Limits limits;
  limits.update_text_bytes = 9;
  EXPECT_TRUE(Parse("CLEAR ALL", limits).ok());
  const ParsedUpdate parsed = Parse("CLEAR ALL ", limits);
  ASSERT_FALSE(parsed.ok());
  EXPECT_THAT(parsed.diagnostics[0].message, HasSubstr("update_text_bytes is 9"));
}

TEST(UpdateParser, ALabelInTwoPatternsOfTwoOperationsIsTwoNodes) {
  EXPECT_TRUE(Parse("INSERT { ?a :c 1 } WHERE { ?a :b _:x } ; INSERT { ?a :c 1 } WHERE { ?a :b _:x }").ok());
}

}  // namespace
}  // namespace docent::sparql
