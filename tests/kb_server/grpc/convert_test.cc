#include "kb_server/grpc/convert.h"

#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"

namespace docent::server {
namespace {

TEST(ToGrpcTest, KeepsCodeAndMessage) {
  grpc::Status status = ToGrpc(absl::ResourceExhaustedError("over the limit batch_operations = 100000"));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(status.error_message(), "over the limit batch_operations = 100000");
  EXPECT_TRUE(ToGrpc(absl::OkStatus()).ok());
}

// A message that does not fit into the headers would reach the client as "received initial metadata size
// exceeds limit".
TEST(ToGrpcTest, CutsWhatDoesNotFitIntoHeadersAtALineAndSaysSo) {
  std::string message;
  for (int i = 0; i < 1000; ++i) absl::StrAppend(&message, "line ", i, " is wrong\n");
  std::string cut = ToGrpc(absl::InvalidArgumentError(message)).error_message();
  EXPECT_LT(cut.size(), 6100u);
  EXPECT_GT(cut.size(), 3000u);
  EXPECT_EQ(cut.substr(0, 16), "line 0 is wrong\n");
  size_t end = cut.rfind('\n');
  EXPECT_EQ(message.substr(0, end + 1), cut.substr(0, end + 1));
  EXPECT_EQ(cut.substr(end + 1), absl::StrCat("… (", message.size() - end - 1, " more bytes)"));
}

TEST(ToGrpcTest, CutsOneLongLineBetweenCodePoints) {
  std::string message = "a";
  while (message.size() < 50000) message += "ä";
  std::string cut = ToGrpc(absl::InvalidArgumentError(message)).error_message();
  size_t end = cut.find("…");
  ASSERT_NE(end, std::string::npos);
  EXPECT_EQ(end % 2, 1u);
  EXPECT_LT(3 * end, 6010u);
}

// What comes by gRPC, Connect and /live, and by name: values of runs, facts of a what-if, of why and of a simulation.
TEST(FromProtoTest, WhatIsNoTermIsRefusedWithItsPlace) {
  std::vector<v1::Term> terms(7);
  terms[0].set_iri("here");
  terms[1].set_iri("http://e/a b");
  terms[2].set_blank("nodeID://b1");
  terms[3].set_blank("");
  terms[4].mutable_literal()->set_language("en . <x> <y> <z>");
  terms[5].mutable_literal()->set_datatype("http://e/a b");
  terms[6].mutable_literal()->set_datatype("urn:t");
  terms[6].mutable_literal()->set_language("en");
  terms.emplace_back();
  for (const v1::Term& term : terms) {
    const absl::Status status = FromProto(term, "value", Limits{}).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << term.ShortDebugString();
    EXPECT_EQ(std::string(status.message()).substr(0, 5), "value");
    v1::Quad quad;
    quad.mutable_subject()->set_iri("urn:s");
    quad.mutable_predicate()->set_iri("urn:p");
    *quad.mutable_object() = term;
    EXPECT_EQ(FromProto(quad, "add[3]", Limits{}).status().message(),
              absl::StrCat("add[3].object", status.message().substr(5)));
  }
}

TEST(FromProtoTest, ATermAtTheLimitIsTakenAndOnePastIsNot) {
  Limits limits;
  limits.term_bytes = 5;
  v1::Term term;
  term.mutable_literal()->set_lexical("12345");
  EXPECT_TRUE(FromProto(term, "value", limits).ok());
  term.mutable_literal()->set_lexical("123456");
  EXPECT_EQ(FromProto(term, "value", limits).status().message(),
            "value: the literal has 6 bytes, the limit term_bytes is 5");
}

}  // namespace
}  // namespace docent::server
