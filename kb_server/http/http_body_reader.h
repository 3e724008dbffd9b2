// Reader of the body of one HTTP/1.1 request: so many bytes, or chunks (RFC 9112 section 7.1).
//
// The data is bounded by HttpBodyLimits::bytes; what stands around it in chunks, extensions and trailer fields, is
// checked, counted and dropped, all of one body together within HttpBodyLimits::overhead. Bytes come in pieces of any
// size. One thread.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_BODY_READER_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_BODY_READER_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "graph/base/limits.h"
#include "kb_server/http/http_head_reader.h"
#include "kb_server/work/http_message.h"

namespace docent::server {

struct HttpBodyLimits {
  size_t bytes = Limits{}.http_body_bytes;       // beyond: 413
  size_t overhead = Limits{}.http_header_bytes;  // beyond: 400 in an extension, 431 in trailer fields
};

class HttpBodyReader {
 public:
  // `head`: how the body is framed; not kept.
  HttpBodyReader(const HttpHead& head, HttpBodyLimits limits);

  enum class State { kMore, kDone, kRefused };
  // The state before anything is read: kRefused for a length beyond the limit.
  State state() const { return state_; }
  // Takes bytes from the front of `*input` up to the end of the body; appends data to `*body`.
  State Read(std::string_view* input, std::string* body);

  // After kRefused: the answer; then the connection has to be closed.
  HttpResponse& refusal() { return refusal_; }

 private:
  enum class Part { kData, kSizeLine, kDataEnd, kTrailer };

  void TakeData(std::string_view* input, std::string* body);
  // Lines are put together in line_; true: one is there, without its end.
  bool TakeLine(std::string_view* input);
  void EndLine(std::string_view line);
  void TakeSize(std::string_view line);
  bool CountOverhead(size_t bytes);
  State Refuse(int status, std::string text);
  State RefuseLength();

  const HttpBodyLimits limits_;
  const bool chunked_;
  State state_ = State::kMore;
  Part part_;
  uint64_t left_ = 0;  // of the data, or of this chunk
  size_t data_ = 0;    // announced so far
  size_t overhead_ = 0;
  std::string line_;  // so far, with its end
  HttpResponse refusal_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_BODY_READER_H_
