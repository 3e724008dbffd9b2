#include "graph/sparql/results/results.h"

#include <gtest/gtest.h>

#include "graph/rdf/vocabulary.h"

namespace docent::sparql {
namespace {

std::string Write(ResultFormat format) {
  std::string out;
  const auto writer = ResultWriter::Make(format, &out);
  writer->Begin({"a", "b"});
  writer->Row({{Term::Iri("http://x/é"), Term::Literal("say \"hi\",\n<ok>\t\\")}});
  writer->Row({{Term::Blank("b1"), std::nullopt}});
  writer->Row({{Term::LangString("x", "en"), Term::Integer(5)}});
  writer->End();
  return out;
}

TEST(SparqlResults, Json) {
  EXPECT_EQ(Write(ResultFormat::kJson),
            "{\"head\":{\"vars\":[\"a\",\"b\"]},\"results\":{\"bindings\":[\n"
            "{\"a\":{\"type\":\"uri\",\"value\":\"http://x/é\"},\"b\":{\"type\":\"literal\",\"value\":\"say "
            "\\\"hi\\\",\\n<ok>\\t\\\\\"}},\n"
            "{\"a\":{\"type\":\"bnode\",\"value\":\"b1\"}},\n"
            "{\"a\":{\"type\":\"literal\",\"value\":\"x\",\"xml:lang\":\"en\"},\"b\":{\"type\":\"literal\","
            "\"value\":\"5\","
            "\"datatype\":\"http://www.w3.org/2001/XMLSchema#integer\"}}\n]}}\n");
}

TEST(SparqlResults, Csv) {
  EXPECT_EQ(Write(ResultFormat::kCsv), "a,b\r\nhttp://x/é,\"say \"\"hi\"\",\n<ok>\t\\\"\r\n_:b1,\r\nx,5\r\n");
}

TEST(SparqlResults, Tsv) {
  EXPECT_EQ(Write(ResultFormat::kTsv),
            "?a\t?b\n<http://x/é>\t\"say \\\"hi\\\",\\n<ok>\\t\\\\\"\n_:b1\t\n\"x\"@en\t5\n");
}

TEST(SparqlResults, Xml) {
  EXPECT_NE(Write(ResultFormat::kXml)
                .find("<binding name=\"b\"><literal>say &quot;hi&quot;,\n&lt;ok&gt;\t\\</literal>"),
            std::string::npos);
}

TEST(SparqlResults, WhatXmlCannotHoldIsReplaced) {
  std::string out;
  const auto writer = ResultWriter::Make(ResultFormat::kXml, &out);
  writer->Begin({"a"});
  writer->Row({{Term::Literal("\x01|\uFFFE|\uFFFF|\uFFFC|é")}});
  writer->End();
  EXPECT_NE(out.find(">\uFFFD|\uFFFD|\uFFFD|\uFFFC|é<"), std::string::npos) << out;
}

TEST(SparqlResults, BooleansAndNames) {
  EXPECT_EQ(WriteBoolean(true, ResultFormat::kJson), "{\"head\":{},\"boolean\":true}\n");
  EXPECT_EQ(WriteBoolean(false, ResultFormat::kCsv), "false\n");
  EXPECT_EQ(ResultFormatOfName("tsv"), ResultFormat::kTsv);
}

}  // namespace
}  // namespace docent::sparql
