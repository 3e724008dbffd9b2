// The body of one HTTP answer that a worker makes: a short one is sent whole, with its length; of a longer one the pieces
// that are ready. While a slow client takes them others are served, and the work counts as open.
#ifndef DOCENT_KB_SERVER_HTTP_LONG_ANSWER_H_
#define DOCENT_KB_SERVER_HTTP_LONG_ANSWER_H_

#include <cstddef>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "graph/base/cancellation.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/http/http_exchange.h"

namespace docent::server {

// Used on a worker's thread.
class LongAnswer {
 public:
  static constexpr size_t kPieceBytes = 64u << 10;  // worth sending

  // `head` has no body. `exchange` must outlive it.
  LongAnswer(HttpResponse head, HttpExchange* exchange) : head_(std::move(head)), exchange_(*exchange) {}

  // The next piece, which is empty then. False: the client has gone.
  bool Send(std::string* piece);
  // The last piece.
  bool End(std::string piece);
  // A text that is known at once. CANCELLED if the client has gone, and what `cancellation` says: then it is cut.
  absl::Status SendAll(std::string text, Cancellation* cancellation);

 private:
  HttpResponse head_;
  HttpExchange& exchange_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_LONG_ANSWER_H_
