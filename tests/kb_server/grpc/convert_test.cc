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

}  // namespace
}  // namespace docent::server
