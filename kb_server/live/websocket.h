// WebSocket (RFC 6455), the server's side, without input or output: the handshake's answer, frames, and the reader of a
// client's frames. One thread.
#ifndef DOCENT_KB_SERVER_LIVE_WEBSOCKET_H_
#define DOCENT_KB_SERVER_LIVE_WEBSOCKET_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kb_server/work/http_message.h"

namespace docent::server {

enum class WebSocketOpcode : uint8_t {
  kContinuation = 0,
  kText = 1,
  kBinary = 2,
  kClose = 8,
  kPing = 9,
  kPong = 10
};

// Status codes of the end of a connection (section 7.4.1).
constexpr uint16_t kWebSocketNormal = 1000, kWebSocketGoingAway = 1001, kWebSocketProtocolError = 1002,
                   kWebSocketUnsupported = 1003, kWebSocketInvalidData = 1007, kWebSocketPolicy = 1008,
                   kWebSocketTooLarge = 1009, kWebSocketTryAgain = 1013;

// Checks the request of a handshake (section 4.2.1). Fills `*headers` of the answer 101; or the refusal: 400, or 426 for a
// request that asks for no WebSocket, or for another version.
std::optional<HttpResponse> AcceptWebSocket(const HttpRequest& request, HttpFields* headers);

// One whole message, or control frame, of the server.
std::string WebSocketFrame(WebSocketOpcode opcode, std::string_view payload);
// A frame that says why the connection ends. Of `reason` as much as fits.
std::string WebSocketClose(uint16_t code, std::string_view reason);

class WebSocketReader {
 public:
  // Most bytes of a message; beyond: kWebSocketTooLarge.
  explicit WebSocketReader(size_t message_bytes) : limit_(message_bytes) {}

  struct Event {
    WebSocketOpcode opcode;  // kText, kPing, kPong, kClose
    std::string payload;     // of kClose: the frame to answer with
  };
  // The events in the next bytes, in order. After kClose there are none: what is wrong with the client's frames ends the
  // connection like a close frame of its own.
  std::vector<Event> Read(std::string_view bytes);
  bool closed() const { return closed_; }
  // Bytes of messages and frames that are not whole.
  size_t held() const { return buffer_.size() + (text_ ? text_->size() : 0); }

 private:
  struct Head {
    bool last = false;
    WebSocketOpcode opcode = WebSocketOpcode::kContinuation;
    uint64_t length = 0;
    size_t bytes = 0;  // of the head itself
    uint8_t mask[4] = {};
  };
  // The head at `at` in buffer_; nullopt: it is not whole, or (closed_) not good.
  std::optional<Head> ReadHead(size_t at, std::vector<Event>* events);
  void TakeFrame(const Head& head, std::string payload, std::vector<Event>* events);
  void TakeClose(const std::string& payload, std::vector<Event>* events);
  void Fail(uint16_t code, std::string_view reason, std::vector<Event>* events);

  const size_t limit_;
  std::string buffer_;               // not read yet
  std::optional<std::string> text_;  // of a message whose end has not come
  bool closed_ = false;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_LIVE_WEBSOCKET_H_
