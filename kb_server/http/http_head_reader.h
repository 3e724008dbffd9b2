// Reader of the head of one HTTP/1.1 request: request line, header fields, and how the body is framed.
//
// It is strict (RFC 9112 sections 2 to 6): where a proxy before the server may see another end of the request than the
// server does, the request is refused and its connection is closed, since what follows could be read as a request that
// nobody sent. Bytes come in pieces of any size; what is kept is bounded by HttpHeadLimits. One thread.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_HEAD_READER_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_HEAD_READER_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "graph/base/limits.h"
#include "kb_server/work/http_message.h"

namespace docent::server {

struct HttpHeadLimits {
  size_t bytes = Limits{}.http_header_bytes;    // beyond: 414 in the request line, 431 in the fields
  size_t fields = Limits{}.http_header_fields;  // beyond: 431
};

struct HttpHead {
  std::string method;
  std::string target;     // as it was sent
  int minor_version = 1;  // of HTTP/1
  HttpFields fields;      // names in lower case, in order; values without white space around them
  bool chunked = false;   // the body comes in chunks
  uint64_t length = 0;    // of the body, unless it comes in chunks
  bool keep_alive = true;
  bool expects_continue = false;  // the client waits for "100 Continue" before it sends the body

  bool has_body() const { return chunked || length > 0; }
};

// The value of field `name` where there is one; nullopt where there is none or more than one.
std::optional<std::string_view> SingleField(const HttpFields& fields, std::string_view name);

// True for a token (RFC 9110 section 5.6.2), such as a method or a field's name.
bool IsHttpToken(std::string_view text);

// A field line without its end, "Name: value": into `*name` (lower case) and `*value`; false where it is none.
bool SplitFieldLine(std::string_view line, std::string* name, std::string* value);

class HttpHeadReader {
 public:
  explicit HttpHeadReader(HttpHeadLimits limits = {}) : limits_(limits) {}

  enum class State { kMore, kDone, kRefused };
  // Takes bytes from the front of `*input` up to the end of the head. kRefused: see refusal().
  State Read(std::string_view* input);

  // True once a byte of the request has come.
  bool begun() const { return bytes_ > 0; }
  // After kDone.
  HttpHead& head() { return head_; }
  // After kRefused: the answer; then the connection has to be closed.
  HttpResponse& refusal() { return refusal_; }

 private:
  // What is wrong is in refusal_ where these give false.
  bool TakeBytes(std::string_view bytes);
  bool TakeLine();
  bool TakeRequestLine(std::string_view line);
  bool TakeField(std::string_view line);
  bool Finish();
  bool FrameByLength();
  bool FrameByTransferEncoding(bool has_length);
  bool Refuse(int status, std::string text);

  const HttpHeadLimits limits_;
  HttpHead head_;
  HttpResponse refusal_;
  std::string line_;  // so far, with its end
  size_t bytes_ = 0;
  bool has_request_line_ = false;
  bool done_ = false;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_HEAD_READER_H_
