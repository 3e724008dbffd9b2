#include "kb_server/door/message_sizes.h"

#include <gtest/gtest.h>

namespace docent::server {
namespace {

TEST(MessageSizesTest, EachMethodHasTheSizeOfWhatItTakes) {
  const Limits limits;
  EXPECT_EQ(LargestMessage("docent.v1.Ontologies.Load", limits, kNetworkLimits).bytes,
            limits.document_bytes + (1u << 20));
  EXPECT_EQ(LargestMessage("docent.v1.Context.Update", limits, kNetworkLimits).limit, "update_text_bytes");
  EXPECT_EQ(LargestMessage("docent.v1.Fleet.List", limits, kNetworkLimits).bytes,
            kNetworkLimits.request_bytes);
  EXPECT_EQ(LargestMessage("docent.v1.New.Method", limits, kNetworkLimits).bytes,
            kNetworkLimits.request_bytes);
  EXPECT_EQ(LargestJson("docent.v1.Ontologies.Load", limits, kNetworkLimits).bytes, limits.http_body_bytes);
  EXPECT_EQ(LargestJson("docent.v1.Fleet.List", limits, kNetworkLimits).bytes,
            2 * kNetworkLimits.request_bytes);
}

TEST(MessageSizesTest, AMessageAtTheLimitPassesAndOneBeyondIsRefusedByName) {
  const MessageSize largest{1000, "some_bytes"};
  EXPECT_TRUE(CheckMessageSize("a.B", 1000, largest).ok());
  const absl::Status beyond = CheckMessageSize("a.B", 1001, largest);
  EXPECT_TRUE(absl::IsResourceExhausted(beyond));
  EXPECT_NE(beyond.message().find("some_bytes"), absl::string_view::npos);
  EXPECT_NE(beyond.message().find("a.B"), absl::string_view::npos);
}

}  // namespace
}  // namespace docent::server
