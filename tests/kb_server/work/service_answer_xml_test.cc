#include "kb_server/work/service_answer_xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace docent::server {
namespace {

using testing::HasSubstr;

std::string Answer(const std::string& head, const std::string& results) {
  return "<?xml version=\"1.0\"?>\n<sparql xmlns=\"http://www.w3.org/2005/sparql-results#\"><head>" + head +
         "<link href=\"x\"/></head>" + results + "</sparql>";
}
std::string Row(const std::string& bindings) {
  return "<result>" + bindings + "</result>";
}
std::string Binding(const std::string& name, const std::string& term) {
  return "<binding name=\"" + name + "\">" + term + "</binding>";
}
const std::string kHead = "<variable name=\"a\"/><variable name=\"b\"/>";

absl::StatusOr<sparql::ServiceAnswer> Read(const std::string& text, Limits limits = {}) {
  MemoryUse memory(SIZE_MAX);
  return ReadXmlAnswer(text, limits, nullptr, &memory);
}

TEST(ServiceAnswerXml, RowsAreRead) {
  const auto answer = Read(Answer(
      kHead,
      "<results>\n" +
          Row(Binding("a", "<uri>urn:x</uri>") + Binding("b", "<literal xml:lang=\"EN\">h&lt;i</literal>")) +
          Row(Binding("b", "<literal datatype=\"http://www.w3.org/2001/XMLSchema#integer\">1</literal>")) +
          Row(Binding("a", "<bnode>nodeID://b1</bnode>") + Binding("b", "<bnode>nodeID://b1</bnode>")) +
          Row(Binding("b", "<literal></literal>")) + Row("") + "</results>"));
  ASSERT_TRUE(answer.ok()) << answer.status();
  ASSERT_EQ(answer->rows.size(), 5u);
  EXPECT_EQ(answer->rows[0][0], Term::Iri("urn:x"));
  EXPECT_EQ(answer->rows[0][1], Term::LangString("h<i", "en"));
  EXPECT_EQ(answer->rows[1][0], std::nullopt);
  EXPECT_EQ(answer->rows[1][1], Term::Integer(1));
  EXPECT_EQ(answer->rows[2][0], Term::Blank("nodeID://b1"))
      << "whoever takes the answer gives it another label";
  EXPECT_EQ(answer->rows[2][1], Term::Blank("nodeID://b1"));
  EXPECT_EQ(answer->rows[3][1], Term::Literal(""));
  EXPECT_EQ(answer->rows[4][1], std::nullopt);
}

TEST(ServiceAnswerXml, WhatIsNoAnswerIsAnError) {
  for (const std::string& text :
       {std::string("<html/>"), std::string("<sparql"), Answer("", "<boolean>true</boolean>"),
        Answer("<variable name=\"a\"/><variable name=\"a\"/>", "<results/>"),
        Answer(kHead, "<results>" + Row(Binding("a", "<uri>not an iri</uri>")) + "</results>"),
        Answer(kHead, "<results>" + Row(Binding("a", "<literal xml:lang=\"en . &lt;x>\">t</literal>")) +
                          "</results>"),
        Answer(kHead,
               "<results>" + Row(Binding("a", "<literal datatype=\"no iri\">t</literal>")) + "</results>"),
        Answer(kHead, "<results>" + Row("") + "<variable name=\"c\"/>" +
                          Row(Binding("c", "<uri>urn:x</uri>")) + "</results>"),
        Answer(kHead, "<results>" + Row(Binding("a", "<uri>urn:x</uri>") + Binding("a", "<uri>urn:y</uri>")) +
                          "</results>")}) {
    EXPECT_EQ(Read(text).status().code(), absl::StatusCode::kUnknown) << text;
  }
  EXPECT_TRUE(Read(Answer(kHead, "<results/>")).ok());
}

TEST(ServiceAnswerXml, RowsAreLimited) {
  const std::string two = Answer(kHead, "<results>" + Row("") + Row("") + "</results>");
  Limits limits;
  limits.remote_rows = 2;
  EXPECT_TRUE(Read(two, limits).ok());
  limits.remote_rows = 1;
  EXPECT_THAT(std::string(Read(two, limits).status().message()), HasSubstr("remote_rows = 1"));
}

TEST(ServiceAnswerXml, WhatIsKeptIsCounted) {
  std::string rows;
  for (int i = 0; i < 5000; ++i) rows += Row(Binding("a", "<uri>urn:x</uri>"));
  MemoryUse memory(1 << 20);
  const auto answer = ReadXmlAnswer(Answer(kHead, "<results>" + rows + "</results>"), {}, nullptr, &memory);
  EXPECT_THAT(std::string(answer.status().message()), HasSubstr("query_memory_bytes"));
  EXPECT_EQ(memory.used(), 0u);
}

}  // namespace
}  // namespace docent::server
