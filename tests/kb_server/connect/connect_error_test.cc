#include "kb_server/connect/connect_error.h"

#include <google/protobuf/any.pb.h>
#include <google/protobuf/empty.pb.h>
#include <google/protobuf/unknown_field_set.h>
#include <gtest/gtest.h>

namespace docent::server {
namespace {

TEST(ConnectErrorTest, EachCodeHasItsNameAndStatus) {
  EXPECT_EQ(ConnectCodeName(grpc::StatusCode::CANCELLED), "canceled");
  EXPECT_EQ(ConnectCodeName(grpc::StatusCode::UNAUTHENTICATED), "unauthenticated");
  EXPECT_EQ(ConnectCodeName(static_cast<grpc::StatusCode>(99)), "unknown");
  EXPECT_EQ(ConnectHttpStatus(grpc::StatusCode::OK), 200);
  EXPECT_EQ(ConnectHttpStatus(grpc::StatusCode::CANCELLED), 499);
  EXPECT_EQ(ConnectHttpStatus(grpc::StatusCode::INVALID_ARGUMENT), 400);
  EXPECT_EQ(ConnectHttpStatus(grpc::StatusCode::RESOURCE_EXHAUSTED), 429);
  EXPECT_EQ(ConnectHttpStatus(grpc::StatusCode::UNIMPLEMENTED), 501);
}

TEST(ConnectErrorTest, JsonStringsAreAlwaysJson) {
  EXPECT_EQ(JsonString("a\"b\\c\nü"), "\"a\\\"b\\\\c\\u000aü\"");
  EXPECT_EQ(JsonString(std::string("\0\x1f\x7f", 3)), "\"\\u0000\\u001f\\u007f\"");
  EXPECT_EQ(JsonString("a\xff\xc3"), "\"a\xEF\xBF\xBD\xEF\xBF\xBD\"");
  EXPECT_EQ(JsonString(""), "\"\"");
}

TEST(ConnectErrorTest, DetailsAreThoseOfGoogleRpcStatus) {
  EXPECT_EQ(ConnectErrorJson({grpc::StatusCode::NOT_FOUND, "no \"x\""}),
            R"({"code":"not_found","message":"no \"x\""})");
  google::protobuf::Any detail;
  detail.set_type_url("type.googleapis.com/google.rpc.RetryInfo");
  detail.set_value("\x0a\x02\x08\x01");
  google::protobuf::Empty status;
  status.GetReflection()->MutableUnknownFields(&status)->AddLengthDelimited(3, detail.SerializeAsString());
  const grpc::Status with(grpc::StatusCode::UNAVAILABLE, "", status.SerializeAsString());
  EXPECT_EQ(ConnectErrorJson(with),
            R"({"code":"unavailable","details":[{"type":"google.rpc.RetryInfo","value":"CgIIAQ"}]})");
  EXPECT_EQ(ConnectErrorJson({grpc::StatusCode::INTERNAL, "x", "\xff\xff"}),
            R"({"code":"internal","message":"x"})");
}

}  // namespace
}  // namespace docent::server
