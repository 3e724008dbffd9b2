#include "kb_server/live/websocket.h"

#include <openssl/sha.h>

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/base/text.h"
#include "graph/rdf/utf8.h"

namespace docent::server {
namespace {

constexpr char kGuid[] = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";  // section 1.3
constexpr size_t kKeyBytes = 16;
constexpr size_t kControlBytes = 125;  // section 5.5
constexpr uint8_t kLast = 0x80, kReserved = 0x70, kOpcode = 0x0f, kMasked = 0x80, kLength = 0x7f;
constexpr uint8_t kLength16 = 126, kLength64 = 127;

bool ListHas(std::string_view list, std::string_view token) {
  for (absl::string_view one : absl::StrSplit(ToAbsl(list), ',')) {
    if (absl::EqualsIgnoreCase(absl::StripAsciiWhitespace(one), ToAbsl(token))) return true;
  }
  return false;
}

HttpResponse UpgradeRequired(std::string text) {
  HttpResponse response = TextResponse(426, std::move(text));
  response.headers = {{"Upgrade", "websocket"}, {"Connection", "Upgrade"}, {"Sec-WebSocket-Version", "13"}};
  return response;
}

bool IsControl(WebSocketOpcode opcode) {
  return opcode >= WebSocketOpcode::kClose;
}

bool IsKnown(WebSocketOpcode opcode) {
  return opcode <= WebSocketOpcode::kBinary || (IsControl(opcode) && opcode <= WebSocketOpcode::kPong);
}

void AppendNumber(uint64_t number, int bytes, std::string* out) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) *out += static_cast<char>(number >> shift & 0xff);
}

// Section 7.4: those that may stand in a frame.
bool IsCloseCode(uint16_t code) {
  return (code >= 1000 && code <= 1014 && code != 1004 && code != 1005 && code != 1006) ||
         (code >= 3000 && code <= 4999);
}

}  // namespace

std::optional<HttpResponse> AcceptWebSocket(const HttpRequest& request, HttpFields* headers) {
  if (!ListHas(request.Header("upgrade"), "websocket") || !ListHas(request.Header("connection"), "upgrade"))
    return UpgradeRequired(
        "this address speaks WebSocket: open it with new WebSocket(\"ws://HOST:PORT/live\")");
  if (request.Header("sec-websocket-version") != "13")
    return UpgradeRequired("this server speaks version 13 of WebSocket (RFC 6455)");
  const std::string key = request.Header("sec-websocket-key");
  std::string decoded;
  if (!absl::Base64Unescape(key, &decoded) || decoded.size() != kKeyBytes)
    return TextResponse(400, "Sec-WebSocket-Key is not the base64 of 16 bytes");
  const std::string text = Concat(key, kGuid);
  unsigned char digest[SHA_DIGEST_LENGTH];
  SHA1(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest);
  const absl::string_view bytes(reinterpret_cast<const char*>(digest), sizeof(digest));
  *headers = {{"Upgrade", "websocket"},
              {"Connection", "Upgrade"},
              {"Sec-WebSocket-Accept", absl::Base64Escape(bytes)}};
  return std::nullopt;
}

std::string WebSocketFrame(WebSocketOpcode opcode, std::string_view payload) {
  std::string frame;
  frame.reserve(payload.size() + 10);
  frame += static_cast<char>(kLast | static_cast<uint8_t>(opcode));
  if (payload.size() < kLength16) {
    frame += static_cast<char>(payload.size());
  } else if (payload.size() <= 0xffff) {
    frame += static_cast<char>(kLength16);
    AppendNumber(payload.size(), 2, &frame);
  } else {
    frame += static_cast<char>(kLength64);
    AppendNumber(payload.size(), 8, &frame);
  }
  frame += payload;
  return frame;
}

std::string WebSocketClose(uint16_t code, std::string_view reason) {
  std::string payload;
  AppendNumber(code, 2, &payload);
  size_t length = std::min(reason.size(), kControlBytes - 2);
  while (length > 0 && length < reason.size() && (static_cast<unsigned char>(reason[length]) & 0xC0) == 0x80)
    --length;
  payload += reason.substr(0, length);
  return WebSocketFrame(WebSocketOpcode::kClose, payload);
}

std::vector<WebSocketReader::Event> WebSocketReader::Read(std::string_view bytes) {
  std::vector<Event> events;
  if (closed_) return events;
  buffer_ += bytes;
  size_t at = 0;
  while (!closed_) {
    const std::optional<Head> head = ReadHead(at, &events);
    if (!head || buffer_.size() - at - head->bytes < head->length) break;
    std::string payload = buffer_.substr(at + head->bytes, head->length);
    for (size_t i = 0; i < payload.size(); ++i)
      payload[i] = static_cast<char>(payload[i] ^ head->mask[i % 4]);
    at += head->bytes + head->length;
    TakeFrame(*head, std::move(payload), &events);
  }
  buffer_.erase(0, at);
  if (buffer_.empty()) buffer_.shrink_to_fit();
  return events;
}

// Section 5.2.
std::optional<WebSocketReader::Head> WebSocketReader::ReadHead(size_t at, std::vector<Event>* events) {
  const size_t there = buffer_.size() - at;
  if (there < 2) return std::nullopt;
  const auto byte = [this, at](size_t i) { return static_cast<uint8_t>(buffer_[at + i]); };
  Head head;
  head.last = (byte(0) & kLast) != 0;
  head.opcode = static_cast<WebSocketOpcode>(byte(0) & kOpcode);
  head.length = byte(1) & kLength;
  const size_t long_bytes = head.length == kLength16 ? 2 : head.length == kLength64 ? 8 : 0;
  const auto fail = [&](uint16_t code, std::string_view reason) {
    Fail(code, reason, events);
    return std::nullopt;
  };
  if ((byte(0) & kReserved) != 0) return fail(kWebSocketProtocolError, "reserved bits are set");
  if (!IsKnown(head.opcode)) return fail(kWebSocketProtocolError, "the opcode is unknown");
  if ((byte(1) & kMasked) == 0) return fail(kWebSocketProtocolError, "a client masks its frames");
  if (IsControl(head.opcode) && (!head.last || long_bytes > 0))
    return fail(kWebSocketProtocolError, "a control frame is in pieces, or too long");
  head.bytes = 2 + long_bytes + sizeof(head.mask);
  if (there < head.bytes) return std::nullopt;
  if (long_bytes > 0) head.length = 0;
  for (size_t i = 0; i < long_bytes; ++i) head.length = head.length << 8 | byte(2 + i);
  for (size_t i = 0; i < sizeof(head.mask); ++i) head.mask[i] = byte(2 + long_bytes + i);
  const size_t held = text_ ? text_->size() : 0;
  if (!IsControl(head.opcode) && head.length > limit_ - std::min(held, limit_))
    return fail(kWebSocketTooLarge, absl::StrCat("a message is larger than live_message_bytes = ", limit_));
  return head;
}

void WebSocketReader::TakeFrame(const Head& head, std::string payload, std::vector<Event>* events) {
  switch (head.opcode) {
    case WebSocketOpcode::kClose:
      return TakeClose(payload, events);
    case WebSocketOpcode::kPing:
    case WebSocketOpcode::kPong:
      events->push_back({head.opcode, std::move(payload)});
      return;
    case WebSocketOpcode::kBinary:
      return Fail(kWebSocketUnsupported, "messages are JSON, in text frames", events);
    case WebSocketOpcode::kText:
      if (text_) return Fail(kWebSocketProtocolError, "a message begins inside another", events);
      text_ = std::move(payload);
      break;
    case WebSocketOpcode::kContinuation:
      if (!text_) return Fail(kWebSocketProtocolError, "no message is begun", events);
      *text_ += payload;
      break;
  }
  if (!head.last) return;
  if (FindInvalidUtf8(*text_)) return Fail(kWebSocketInvalidData, "a text is not UTF-8", events);
  events->push_back({WebSocketOpcode::kText, *std::exchange(text_, std::nullopt)});
}

// Section 5.5.1.
void WebSocketReader::TakeClose(const std::string& payload, std::vector<Event>* events) {
  if (payload.empty()) return Fail(kWebSocketNormal, "", events);
  const uint16_t code =
      payload.size() < 2
          ? 0
          : static_cast<uint16_t>(static_cast<uint8_t>(payload[0]) << 8 | static_cast<uint8_t>(payload[1]));
  if (!IsCloseCode(code))
    return Fail(kWebSocketProtocolError, "the code of the close frame is unknown", events);
  if (FindInvalidUtf8(std::string_view(payload).substr(2)))
    return Fail(kWebSocketInvalidData, "the reason is not UTF-8", events);
  Fail(code, "", events);
}

void WebSocketReader::Fail(uint16_t code, std::string_view reason, std::vector<Event>* events) {
  closed_ = true;
  events->push_back({WebSocketOpcode::kClose, WebSocketClose(code, reason)});
}

}  // namespace docent::server
