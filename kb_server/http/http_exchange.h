// One request being answered: what a handler holds while it works, on whatever thread it likes.
//
// A handler answers once: `Respond` with the whole response, or `Begin`, `Write` …, `End` for one that is
// made while it is sent. It may keep the exchange (shared_ptr) and answer later from another thread.
// Thread-safe. An exchange that is dropped without an answer is answered with 500.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_EXCHANGE_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_EXCHANGE_H_

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "kb_server/door/client.h"
#include "kb_server/door/send_budget.h"
#include "kb_server/work/http_message.h"

namespace docent {
class MemoryUse;
}  // namespace docent

namespace docent::server {

// Reader of what a client sends on a connection that is no longer HTTP (RFC 9110 section 7.8).
class HttpUpgradeReader {
 public:
  virtual ~HttpUpgradeReader() = default;
  // The next bytes. On a network thread, one call at a time: it must not block.
  virtual void OnBytes(std::string_view bytes) = 0;
};

// What the connection and the handler share. Handlers use HttpExchange below.
class HttpAnswer {
 public:
  // The connection's side: what came since the last call.
  struct Progress {
    std::optional<HttpResponse> head;             // once. Its body belongs to the answer
    bool streamed = false;                        // with head: more may follow
    std::shared_ptr<HttpUpgradeReader> upgraded;  // with head: what follows is not HTTP
    std::string data;
    bool ended = false;    // all has been said
    bool aborted = false;  // ended before all was said

    size_t bytes() const { return data.size() + (head ? head->body.size() : 0); }
  };
  Progress Take();
  // `wake` is called, from any thread, when Take has something new. Called at most once between two Takes.
  void OnProgress(std::function<void()> wake);
  // What is not taken yet counts in `share`, until SetGone; who takes it releases it there. Before the handler has it.
  void CountIn(SendBudget::Share* share);
  // The client is gone, or the server stops: nothing will be sent any more.
  void SetGone();

 private:
  friend class HttpExchange;
  static constexpr size_t kBufferBytes = 1u << 20;  // not yet sent; Write waits beyond

  void Count(size_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (share_ != nullptr) share_->Add(bytes);
  }
  void Wake() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool HasRoom() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return gone_ || progress_.data.size() < kBufferBytes;
  }

  absl::Mutex mutex_;
  Progress progress_ ABSL_GUARDED_BY(mutex_);
  bool begun_ ABSL_GUARDED_BY(mutex_) = false;
  bool gone_ ABSL_GUARDED_BY(mutex_) = false;
  bool woken_ ABSL_GUARDED_BY(mutex_) = false;
  SendBudget::Share* share_ ABSL_GUARDED_BY(mutex_) = nullptr;
  std::function<void()> wake_ ABSL_GUARDED_BY(mutex_);
  std::vector<std::function<void()>> on_gone_ ABSL_GUARDED_BY(mutex_);
  std::vector<std::function<void()>> on_room_ ABSL_GUARDED_BY(mutex_);
};

class HttpExchange {
 public:
  // `memory`: counts the request's body, and lives as long. `client`: who asks; null: the server itself.
  HttpExchange(HttpRequest request, std::shared_ptr<HttpAnswer> answer,
               std::shared_ptr<MemoryUse> memory = nullptr, ClientPtr client = nullptr)
      : request_(std::move(request)),
        answer_(std::move(answer)),
        memory_(std::move(memory)),
        client_(std::move(client)) {}
  ~HttpExchange();
  HttpExchange(const HttpExchange&) = delete;
  HttpExchange& operator=(const HttpExchange&) = delete;

  const HttpRequest& request() const { return request_; }
  // What the request takes, of its body's first byte on; may be null. For one thread at a time: whoever works on it.
  MemoryUse* memory() const { return memory_.get(); }
  const ClientPtr& client() const { return client_; }

  // The whole answer. Later calls of any answering method do nothing.
  void Respond(HttpResponse response);

  // Status and headers of a streamed answer; its body is the first piece.
  void Begin(HttpResponse head);
  // True once part of the answer is given.
  bool begun() const;
  // True if the next Write would wait now.
  bool full() const;
  // The next piece. Waits while the client is slower than the answer is made: never call it on a network
  // thread. `give_up` is called now and then meanwhile; where it is true the answer is aborted. False: stop, the client is
  // gone or given up.
  bool Write(std::string_view piece, const std::function<bool()>& give_up = nullptr);
  // The next piece, without waiting, for a thread that may not wait: it looks at full() before, and goes on when OnRoom
  // says so. False: the client is gone.
  bool Push(std::string_view piece);
  // `callback` is called once when the next Write would not wait: at once, or on a network thread. It must not block. It is
  // not called for a client that goes away first.
  void OnRoom(std::function<void()> callback);
  // The answer 101 with `headers`; what is pushed then goes to the client as it is, and what it sends to `reader`. End closes
  // the connection.
  void Upgrade(HttpFields headers, std::shared_ptr<HttpUpgradeReader> reader);
  void End();
  // The answer cannot be completed: the connection is cut, so that the client sees that something is missing.
  void Abort();

  // `callback` is called once, from any thread, when the client has gone before the answer was complete; at
  // once if it already has. It must not block.
  void OnGone(std::function<void()> callback);

 private:
  const HttpRequest request_;
  const std::shared_ptr<HttpAnswer> answer_;
  const std::shared_ptr<MemoryUse> memory_;
  const ClientPtr client_;
};

using HttpHandler = std::function<void(std::shared_ptr<HttpExchange>)>;

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_EXCHANGE_H_
