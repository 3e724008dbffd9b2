// Frames of a WebSocket client, and a blocking client on a real socket.
#ifndef DOCENT_TESTS_KB_SERVER_LIVE_WEBSOCKET_CLIENT_H_
#define DOCENT_TESTS_KB_SERVER_LIVE_WEBSOCKET_CLIENT_H_

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <string>

namespace docent::server {

// `first`: the byte of flags and opcode.
inline std::string ClientFrame(uint8_t first, const std::string& payload) {
  const char mask[4] = {'\x11', '\x72', '\x00', '\x7f'};
  std::string frame(1, static_cast<char>(first));
  if (payload.size() < 126) {
    frame += static_cast<char>(0x80 | payload.size());
  } else {
    const int bytes = payload.size() <= 0xffff ? 2 : 8;
    frame += static_cast<char>(0x80 | (bytes == 2 ? 126 : 127));
    for (int i = bytes - 1; i >= 0; --i) frame += static_cast<char>(payload.size() >> (8 * i) & 0xff);
  }
  frame.append(mask, 4);
  for (size_t i = 0; i < payload.size(); ++i) frame += static_cast<char>(payload[i] ^ mask[i % 4]);
  return frame;
}

class WebSocketClient {
 public:
  explicit WebSocketClient(uint16_t port, const std::string& headers = "")
      : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    timeval patience{60, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0) return;
    SendBytes("GET /live HTTP/1.1\r\nHost: localhost:" + std::to_string(port) +
              "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
              "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
              headers + "\r\n");
    while (buffer_.find("\r\n\r\n") == std::string::npos && More()) {
    }
    head_ = buffer_.substr(0, buffer_.find("\r\n\r\n"));
    buffer_.erase(0, head_.size() + 4);
  }
  ~WebSocketClient() { Close(); }
  WebSocketClient(const WebSocketClient&) = delete;
  WebSocketClient& operator=(const WebSocketClient&) = delete;

  void Close() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }
  // The head of the handshake's answer.
  const std::string& head() const { return head_; }
  void Send(const std::string& text) { SendBytes(ClientFrame(0x81, text)); }
  void SendBytes(const std::string& bytes) { (void)send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }

  // The payload of the next frame; `*first` is its first byte, 0 at the end of the connection.
  std::string Receive(uint8_t* first = nullptr) {
    uint8_t unused = 0;
    if (first == nullptr) first = &unused;
    *first = 0;
    if (!Have(2)) return "";
    size_t length = static_cast<uint8_t>(buffer_[1]) & 0x7f, head = 2;
    if (length >= 126) {
      const size_t bytes = length == 126 ? 2 : 8;
      if (!Have(2 + bytes)) return "";
      length = 0;
      for (size_t i = 0; i < bytes; ++i) length = length << 8 | static_cast<uint8_t>(buffer_[2 + i]);
      head += bytes;
    }
    if (!Have(head + length)) return "";
    *first = static_cast<uint8_t>(buffer_[0]);
    std::string payload = buffer_.substr(head, length);
    buffer_.erase(0, head + length);
    return payload;
  }
  // True at the end of the connection, which it waits for.
  bool Ended() { return !Have(1); }

 private:
  bool Have(size_t bytes) {
    while (buffer_.size() < bytes) {
      if (!More()) return false;
    }
    return true;
  }
  bool More() {
    char bytes[65536];
    const ssize_t got = recv(fd_, bytes, sizeof(bytes), 0);
    if (got <= 0) return false;
    buffer_.append(bytes, static_cast<size_t>(got));
    return true;
  }

  int fd_;
  std::string head_;
  std::string buffer_;
};

}  // namespace docent::server

#endif  // DOCENT_TESTS_KB_SERVER_LIVE_WEBSOCKET_CLIENT_H_
