// Plain blocking HTTP client on a real socket: it sends exactly the bytes of the test.
#ifndef DOCENT_TESTS_KB_SERVER_HTTP_HTTP_CLIENT_H_
#define DOCENT_TESTS_KB_SERVER_HTTP_HTTP_CLIENT_H_

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>
#include <string>

namespace docent::server {

struct HttpReply {
  int status = 0;                              // 0: no answer
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;
  bool whole = false;  // the body came to its end
};

class HttpClient {
 public:
  explicit HttpClient(uint16_t port) : port_(port), fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    timeval patience{60, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0) Close();
  }
  ~HttpClient() { Close(); }
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  void Close() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }

  bool Send(const std::string& bytes) {
    size_t at = 0;
    while (at < bytes.size()) {
      const ssize_t sent = send(fd_, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
      if (sent <= 0) return false;
      at += static_cast<size_t>(sent);
    }
    return true;
  }

  // Waits until an answer begins, and reads nothing of it.
  bool AwaitAnswer() {
    char byte;
    return recv(fd_, &byte, 1, MSG_PEEK) == 1;
  }

  // Adds Host unless `headers` has one, and Content-Length for a body. `headers`: whole lines.
  HttpReply Ask(const std::string& method, const std::string& target, const std::string& headers = "",
                const std::string& body = "") {
    std::string text = method + " " + target + " HTTP/1.1\r\n" + headers;
    if (headers.find("Host:") == std::string::npos)
      text += "Host: localhost:" + std::to_string(port_) + "\r\n";
    if (!body.empty()) text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
    Send(text + "\r\n" + body);
    return Receive(method == "HEAD");
  }

  HttpReply Receive(bool head_only = false) {
    HttpReply reply;
    while (buffer_.find("\r\n\r\n") == std::string::npos) {
      if (!More()) return reply;
    }
    const size_t end = buffer_.find("\r\n\r\n");
    ParseHead(buffer_.substr(0, end), &reply);
    buffer_.erase(0, end + 4);
    if (head_only || reply.status == 100) {
      reply.whole = true;
    } else if (reply.headers.count("content-length") > 0) {
      const size_t length = std::strtoul(reply.headers["content-length"].c_str(), nullptr, 10);
      while (buffer_.size() < length && More()) {
      }
      reply.whole = buffer_.size() >= length;
      reply.body = buffer_.substr(0, length);
      buffer_.erase(0, length);
    } else if (reply.headers.count("transfer-encoding") > 0) {
      ReceiveChunks(&reply);
    } else {
      while (More()) {
      }
      reply.body.swap(buffer_);
      reply.whole = true;
    }
    return reply;
  }

  // True if the server has closed the connection (waits for it).
  bool Ended() {
    char byte;
    return buffer_.empty() && recv(fd_, &byte, 1, 0) <= 0;
  }

 private:
  bool More() {
    char bytes[65536];
    const ssize_t got = recv(fd_, bytes, sizeof(bytes), 0);
    if (got <= 0) return false;
    buffer_.append(bytes, static_cast<size_t>(got));
    return true;
  }

  static void ParseHead(const std::string& head, HttpReply* reply) {
    reply->status = std::atoi(head.substr(9, 3).c_str());
    for (size_t at = head.find("\r\n"); at != std::string::npos;) {
      const size_t next = head.find("\r\n", at + 2);
      const std::string line = head.substr(at + 2, next == std::string::npos ? next : next - at - 2);
      std::string name = line.substr(0, line.find(':'));
      std::transform(name.begin(), name.end(), name.begin(), ::tolower);
      reply->headers[name] = line.substr(line.find(':') + 2);
      at = next;
    }
  }

  void ReceiveChunks(HttpReply* reply) {
    while (true) {
      while (buffer_.find("\r\n") == std::string::npos) {
        if (!More()) return;
      }
      const size_t length = std::strtoul(buffer_.c_str(), nullptr, 16);
      const size_t start = buffer_.find("\r\n") + 2;
      while (buffer_.size() < start + length + 2) {
        if (!More()) return;
      }
      reply->body += buffer_.substr(start, length);
      buffer_.erase(0, start + length + 2);
      if (length == 0) {
        reply->whole = true;
        return;
      }
    }
  }

  const uint16_t port_;
  int fd_;
  std::string buffer_;
};

}  // namespace docent::server

#endif  // DOCENT_TESTS_KB_SERVER_HTTP_HTTP_CLIENT_H_
