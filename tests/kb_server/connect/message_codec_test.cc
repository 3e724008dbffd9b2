#include "kb_server/connect/message_codec.h"

#include <gtest/gtest.h>

#include <string>

#include "docent/v1/context.pb.h"

namespace docent::server {
namespace {

const google::protobuf::Descriptor& Update() {
  return *v1::UpdateRequest::descriptor();
}

// JSON is read in pieces: no character, escape or text is lost where two of them meet.
TEST(MessageCodecTest, LongJsonIsReadAsAWhole) {
  const std::string unit = "a\\n\\u00e4ä\\ud83d\\ude00 ";
  for (size_t first = 0; first < 32; ++first) {
    std::string json = "{\"update\":\"" + std::string(first, 'x'), plain(first, 'x');
    while (json.size() < 200000) {
      json += unit;
      plain += "a\nää😀 ";
    }
    const auto binary =
        ToBinary(Update(), MessageCodec::kJson, json + "\",\"timeoutMs\":" + std::string(first, ' ') + "17}");
    ASSERT_TRUE(binary.ok()) << binary.status();
    v1::UpdateRequest request;
    ASSERT_TRUE(request.ParseFromString(*binary));
    EXPECT_EQ(request.update(), plain) << first;
    EXPECT_EQ(request.timeout_ms(), 17u);
  }
}

TEST(MessageCodecTest, ReadingJsonEndsWhenItIsCancelled) {
  const std::string json = "{\"update\":\"" + std::string(5u << 20, 'x') + "\"}";
  Cancellation cancellation;
  int looks = 0;
  cancellation.OnLook([&](const Cancellation&) {
    if (++looks == 10) cancellation.Cancel();
  });
  EXPECT_EQ(ToBinary(Update(), MessageCodec::kJson, json, nullptr, &cancellation).status().code(),
            absl::StatusCode::kCancelled);
  EXPECT_EQ(looks, 10);
}

}  // namespace
}  // namespace docent::server
