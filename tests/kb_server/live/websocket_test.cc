#include "kb_server/live/websocket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/kb_server/live/websocket_client.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

HttpRequest Handshake() {
  HttpRequest request;
  request.method = "GET";
  request.headers = {{"connection", "keep-alive, Upgrade"},
                     {"upgrade", "websocket"},
                     {"sec-websocket-version", "13"},
                     {"sec-websocket-key", "dGhlIHNhbXBsZSBub25jZQ=="}};
  return request;
}

// The example of RFC 6455, section 1.3.
TEST(WebSocketTest, AcceptsAHandshake) {
  HttpFields headers;
  EXPECT_FALSE(AcceptWebSocket(Handshake(), &headers));
  EXPECT_EQ(headers.back().second, "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
  for (const auto& [name, value, status] :
       std::vector<std::tuple<std::string, std::string, int>>{{"upgrade", "h2c", 426},
                                                              {"connection", "close", 426},
                                                              {"sec-websocket-version", "8", 426},
                                                              {"sec-websocket-key", "short", 400},
                                                              {"sec-websocket-key", "", 400}}) {
    HttpRequest request = Handshake();
    for (auto& field : request.headers) {
      if (field.first == name) field.second = value;
    }
    const auto refusal = AcceptWebSocket(request, &headers);
    ASSERT_TRUE(refusal) << name;
    EXPECT_EQ(refusal->status, status) << name;
  }
}

std::vector<WebSocketReader::Event> ReadBytewise(WebSocketReader* reader, const std::string& bytes) {
  std::vector<WebSocketReader::Event> events;
  for (const char c : bytes) {
    for (auto& event : reader->Read(std::string_view(&c, 1))) events.push_back(std::move(event));
  }
  return events;
}

TEST(WebSocketTest, ReadsMessagesInPiecesOfAnySize) {
  for (const size_t size : {size_t{0}, size_t{5}, size_t{125}, size_t{126}, size_t{65535}, size_t{65536}}) {
    const std::string text(size, 'x');
    WebSocketReader reader(1u << 20);
    const auto events = ReadBytewise(&reader, ClientFrame(0x81, text) + ClientFrame(0x89, "p"));
    ASSERT_EQ(events.size(), 2u) << size;
    EXPECT_EQ(events[0].payload, text);
    EXPECT_EQ(events[1].opcode, WebSocketOpcode::kPing);
    EXPECT_EQ(events[1].payload, "p");
  }
  WebSocketReader reader(100);
  // A message in three frames, with a pong between them.
  const auto events = reader.Read(ClientFrame(0x01, "a\xC3") + ClientFrame(0x8a, "") +
                                  ClientFrame(0x00, "\xBC") + ClientFrame(0x80, "b"));
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].opcode, WebSocketOpcode::kPong);
  EXPECT_EQ(events[1].payload, "aüb");
}

TEST(WebSocketTest, WhatIsWrongEndsTheConnectionWithItsCode) {
  struct Case {
    std::string bytes;
    uint16_t code;
  };
  const std::vector<Case> cases = {
      {ClientFrame(0x88, std::string("\x03\xe9", 2)), 1001},
      {ClientFrame(0x88, ""), 1000},
      {ClientFrame(0x88, "x"), 1002},
      {ClientFrame(0x88, std::string("\x03\xed", 2)), 1002},  // 1005 is for no frame
      {ClientFrame(0x88, std::string("\x03\xe8\xff", 3)), 1007},
      {ClientFrame(0x82, "x"), 1003},
      {ClientFrame(0xC1, "x"), 1002},
      {ClientFrame(0x83, "x"), 1002},
      {ClientFrame(0x80, "x"), 1002},
      {ClientFrame(0x09, "x"), 1002},
      {ClientFrame(0x89, std::string(126, 'x')), 1002},
      {ClientFrame(0x01, "x") + ClientFrame(0x81, "x"), 1002},
      {ClientFrame(0x81, "\xff"), 1007},
      {ClientFrame(0x81, std::string(101, 'x')), 1009},
      {ClientFrame(0x01, std::string(60, 'x')) + ClientFrame(0x80, std::string(60, 'x')), 1009},
      {std::string("\x81\xff\xff\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14), 1009},
      {WebSocketFrame(WebSocketOpcode::kText, "not masked"), 1002},
  };
  for (size_t i = 0; i < cases.size(); ++i) {
    WebSocketReader reader(100);
    const auto events = reader.Read(cases[i].bytes + ClientFrame(0x81, "after"));
    ASSERT_EQ(events.size(), 1u) << i;
    EXPECT_EQ(events[0].opcode, WebSocketOpcode::kClose) << i;
    const auto code = static_cast<uint16_t>(static_cast<uint8_t>(events[0].payload[2]) << 8 |
                                            static_cast<uint8_t>(events[0].payload[3]));
    EXPECT_EQ(code, cases[i].code) << i;
    EXPECT_TRUE(reader.closed());
    EXPECT_TRUE(reader.Read(ClientFrame(0x81, "x")).empty());
  }
  WebSocketReader reader(100);
  EXPECT_EQ(reader.Read(ClientFrame(0x81, std::string(100, 'x'))).front().payload.size(), 100u);
  EXPECT_THAT(WebSocketReader(1).Read(ClientFrame(0x81, "xx")).front().payload,
              HasSubstr("live_message_bytes = 1"));
}

TEST(WebSocketTest, AReasonIsCutAtACharacter) {
  std::string reason;
  for (int i = 0; i < 100; ++i) reason += "ü";
  const std::string frame = WebSocketClose(1000, reason);
  EXPECT_EQ(frame.size(), 2u + 2u + 122u);
  EXPECT_TRUE(frame.ends_with("ü"));
}

}  // namespace
}  // namespace docent::server
