#include "kb_server/work/service_answer_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"

namespace docent::server {
namespace {

using testing::HasSubstr;

std::string Results(const std::string& rows) {
  return "\"results\":{\"bindings\":[" + rows + "]}";
}
std::string Answer(const std::string& rows, const std::string& variables = "\"a\",\"b\"") {
  return "{\"head\":{\"vars\":[" + variables + "]}," + Results(rows) + "}";
}
std::string Cell(const std::string& name, const std::string& type, const std::string& value,
                 const std::string& more = "") {
  return "\"" + name + "\":{\"type\":\"" + type + "\",\"value\":\"" + value + "\"" + more + "}";
}
std::string Times(size_t times, const std::string& text) {
  std::string out;
  for (size_t i = 0; i < times; ++i) out += text;
  return out;
}

class ServiceAnswerJson : public testing::Test {
 protected:
  absl::StatusOr<sparql::ServiceAnswer> Read(const std::string& text, const Limits& limits = {},
                                             Cancellation* cancellation = nullptr) {
    return ReadJsonAnswer(text, limits, cancellation, &memory_);
  }
  std::string Refusal(const std::string& text, const Limits& limits = {}) {
    const absl::Status status = Read(text, limits).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
    EXPECT_EQ(memory_.used(), 0u) << "what is refused is given back";
    return std::string(status.message());
  }
  MemoryUse memory_{size_t{1} << 20};
};

const char kRow[] = R"({"a":{"type":"literal","value":"x"}})";

TEST_F(ServiceAnswerJson, RowsAreRead) {
  const std::string rows =
      "{" + Cell("a", "uri", "urn:x") + "," + Cell("b", "literal", "h\\u003Ci", ",\"xml:lang\":\"EN\"") +
      "},{" + Cell("b", "typed-literal", "1", ",\"datatype\":\"http://www.w3.org/2001/XMLSchema#integer\"") +
      "},{" + Cell("a", "bnode", "nodeID://b1") + "," + Cell("unknown", "uri", "urn:y") + "},{}";
  for (const std::string& text : {Answer(rows), "\xEF\xBB\xBF" + Answer(rows),
                                  "{\"x\":[[1,{\"y\":null}],true]," + Results(rows) +
                                      ",\"head\":{\"link\":[\"z\"],\"vars\":[\"a\",\"b\"]}}"}) {
    const auto answer = Read(text);
    ASSERT_TRUE(answer.ok()) << answer.status() << text;
    ASSERT_EQ(answer->rows.size(), 4u);
    EXPECT_EQ(answer->rows[0][0], Term::Iri("urn:x"));
    EXPECT_EQ(answer->rows[0][1], Term::LangString("h<i", "en"));
    EXPECT_EQ(answer->rows[1][0], std::nullopt);
    EXPECT_EQ(answer->rows[1][1], Term::Integer(1));
    EXPECT_EQ(answer->rows[2][0], Term::Blank("nodeID://b1"));
    EXPECT_EQ(answer->rows[3][1], std::nullopt);
    EXPECT_EQ(memory_.used(), answer->counted) << "what is read is counted";
    EXPECT_GT(answer->counted, 8 * sizeof(Term));
    memory_.Release(answer->counted);
  }
  EXPECT_TRUE(Read("{\"head\":{}," + Results("{},{}") + "}").ok()) << "no variables are asked for";
}

TEST_F(ServiceAnswerJson, WhatIsNoAnswerIsAnError) {
  for (const std::string& text :
       {std::string(),
        std::string("[]"),
        std::string("{"),
        Answer("") + "x",
        std::string("{\"head\":{}}"),
        "{" + Results("") + "}",
        "{\"head\":[]," + Results("") + "}",
        std::string("{\"head\":{\"vars\":[]},\"results\":[]}"),
        std::string("{\"head\":{\"vars\":{}},\"boolean\":true}"),
        std::string("{\"head\":{\"vars\":[]},\"results\":{\"bindings\":{}}}"),
        Answer("", "\"a\",\"a\""),
        Answer("", "1"),
        Answer("1"),
        Answer("{\"a\":1}"),
        Answer("{\"a\":{}}"),
        Answer("{\"a\":{\"type\":\"uri\"}}"),
        Answer("{\"a\":{\"type\":\"uri\",\"value\":1}}"),
        Answer("{" + Cell("a", "thing", "urn:x") + "}"),
        Answer("{" + Cell("a", "uri", "no iri") + "}"),
        Answer("{" + Cell("a", "literal", "x", ",\"xml:lang\":\"en . <x>\"") + "}"),
        Answer("{" + Cell("a", "literal", "x", ",\"datatype\":\"no iri\"") + "}"),
        Answer("{" + Cell("a", "uri", "urn:x") + "," + Cell("a", "uri", "urn:y") + "}"),
        "{\"head\":{}," + Results("") + "," + Results("") + "}"}) {
    EXPECT_EQ(Read(text).status().code(), absl::StatusCode::kUnknown) << text;
    EXPECT_EQ(memory_.used(), 0u) << text;
  }
}

TEST_F(ServiceAnswerJson, RowsAndTextsAreLimited) {
  Limits limits;
  limits.remote_rows = 2;
  const std::string two = Answer("{},{}");
  const auto answer = Read(two, limits);
  ASSERT_TRUE(answer.ok());
  memory_.Release(answer->counted);
  limits.remote_rows = 1;
  EXPECT_THAT(Refusal(two, limits), HasSubstr("remote_rows = 1"));
  EXPECT_THAT(Refusal(Answer("{}", R"("a","b","c","d","e")"), limits), HasSubstr("more values"));

  limits = Limits();
  limits.term_bytes = 1000;
  const std::string fits(1000, 'x'), longer(1001, 'x');
  const auto with = [](const std::string& text) { return Answer("{" + Cell("a", "literal", text) + "}"); };
  ASSERT_TRUE(Read(with(fits), limits).ok());
  memory_.Release(memory_.used());
  ASSERT_TRUE(Read(with(Times(1000, "\\u0041")), limits).ok());
  memory_.Release(memory_.used());
  EXPECT_THAT(Refusal(with(longer), limits), HasSubstr("term_bytes"));
  EXPECT_THAT(Refusal("{\"x\":\"" + std::string(10000, 'x') + "\"}", limits), HasSubstr("term_bytes = 1000"));
}

// No part of the answer is kept that is no row, however it is made.
TEST_F(ServiceAnswerJson, WhatIsNotUsedIsNotKept) {
  for (const std::string& text :
       {"{\"head\":{\"vars\":[\"a\"]},\"x\":" + std::string(100000, '['), std::string(100000, '['),
        "{\"head\":{\"vars\":[" + std::string(100, '[')}) {
    EXPECT_EQ(Read(text).status().code(), absl::StatusCode::kUnknown);
    EXPECT_EQ(memory_.used(), 0u);
  }
  const auto answer = Read("{\"x\":[" + Times(500000, "1,{},") + "1]," + Answer(kRow, "\"a\"").substr(1));
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(answer->rows.size(), 1u);
  EXPECT_LT(memory_.used(), 1000u);
}

TEST_F(ServiceAnswerJson, WhatIsKeptIsCounted) {
  EXPECT_THAT(Refusal(Answer(Times(20000, "{},") + "{}")), HasSubstr("query_memory_bytes"));
  EXPECT_THAT(Refusal(Answer("{" + Cell("a", "literal", std::string(1000000, 'x')) + "},{" +
                             Cell("a", "literal", std::string(100000, 'x')) + "}")),
              HasSubstr("query_memory_bytes"));
  std::string names = "\"v\"";
  for (int i = 0; i < 10000; ++i) absl::StrAppend(&names, ",\"v", i, "\"");
  EXPECT_THAT(Refusal(Answer("", names)), HasSubstr("query_memory_bytes"));
}

TEST_F(ServiceAnswerJson, ItIsStoppedWhereverItIs) {
  for (const std::string& text : {Answer(Times(5000, "{},") + "{}"), "{\"x\":[" + Times(5000, "1,") + "1]}",
                                  "{\"x\":{" + Times(5000, "\"y\":{},") + "\"y\":{}}}"}) {
    Cancellation cancellation;
    cancellation.Cancel();
    EXPECT_TRUE(absl::IsCancelled(Read(text, {}, &cancellation).status()));
    EXPECT_EQ(memory_.used(), 0u);
  }
}

}  // namespace
}  // namespace docent::server
