// One live connection: reads what the tab asks for, and sends what its streams say. Private to this folder.
#ifndef DOCENT_KB_SERVER_LIVE_LIVE_SESSION_H_
#define DOCENT_KB_SERVER_LIVE_LIVE_SESSION_H_

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "kb_server/http/http_exchange.h"
#include "kb_server/live/live.h"
#include "kb_server/live/live_request.h"
#include "kb_server/live/websocket.h"

namespace docent::server {

// What a tab follows under one id. Thread-safe.
class LiveStream {
 public:
  virtual ~LiveStream() = default;
  // Before the first message. `request` is JSON, `newest` the newest revision. `cancellation`, if there is one, is looked at
  // while the request is read.
  virtual absl::Status Begin(std::string_view request, uint64_t newest, Cancellation* cancellation) = 0;
  // What it keeps of the request.
  virtual size_t kept_bytes() const { return 0; }
  // Now and then. Must not block.
  virtual void Look(absl::Time /*now*/, uint64_t /*newest*/) {}
  // When it last began to look for an answer: who has waited for the longest goes first.
  virtual absl::Time asked() const { return absl::InfinitePast(); }
  // Nothing more is sent under its id.
  virtual void End() = 0;
};

class LiveSession final : public HttpUpgradeReader, public std::enable_shared_from_this<LiveSession> {
 public:
  LiveSession(const LivePorts* ports, const std::shared_ptr<HttpExchange>& exchange);
  // When the connection is upgraded.
  void Begin();
  void OnBytes(std::string_view bytes) override;
  void Look(absl::Time now, uint64_t newest);
  // The server stops: ends what the tab follows. What it has sent and sends is dropped from now on. Any thread.
  void Stop();

  // For its streams, any thread.

  const LivePorts& ports() const { return ports_; }
  // Reads that are followed have live_reads_asked places in a connection, however many there are: one that is asked holds a
  // place until it is answered, and then for as long again. False: they are taken.
  bool TakeReadPlace(absl::Time now);
  void LeaveReadPlace(absl::Time asked, absl::Time answered);
  // One message, whole JSON. Its stream asks `exchange` for room before it makes the next one.
  void Send(std::string_view json);
  // `stream` ends by itself: says so, unless the tab has ended it.
  void StreamEnded(const LiveStream* stream, const std::string& id, const grpc::Status& status);
  const std::shared_ptr<HttpExchange>& exchange() const { return exchange_; }
  const ClientPtr& client() const { return exchange_->client(); }

 private:
  // Takes a message: at once where it is small and none waits, else on a worker, in the order in which they came.
  void Receive(std::string text);
  void TakeNextOnWorker();
  void TakeNext(Cancellation* cancellation);
  void Take(const std::string& text, Cancellation* cancellation);
  // Counts what is held of messages. False: there is no room for it, and the connection is closed.
  bool CountHeld();
  // Null: there is none, or it is not `only`.
  std::shared_ptr<LiveStream> Remove(const std::string& id, const LiveStream* only = nullptr);
  void BeginStream(const LiveRequest& request, Cancellation* cancellation);
  // False: the tab goes on asking and does not read the answers.
  bool HasPatience() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void EndAll();
  void Close(std::string_view frame);

  const LivePorts& ports_;
  const std::shared_ptr<HttpExchange> exchange_;
  WebSocketReader reader_;  // of the network thread
  absl::Mutex mutex_;
  // A message that waits for a worker, or that one takes, and what that needs.
  struct Waiting {
    std::string text;
    size_t bytes = 0;
  };
  std::deque<Waiting> waiting_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<Cancellation> taking_ ABSL_GUARDED_BY(mutex_);  // of the worker that takes one, or will
  size_t begun_bytes_ ABSL_GUARDED_BY(mutex_) = 0;                // of the message that is not whole
  size_t whole_bytes_ ABSL_GUARDED_BY(mutex_) = 0;                // of waiting_, and of what is being taken
  size_t kept_bytes_ ABSL_GUARDED_BY(mutex_) = 0;                 // of requests that are followed
  size_t counted_ ABSL_GUARDED_BY(mutex_) = 0;                    // of all three
  struct Followed {
    std::shared_ptr<LiveStream> stream;
    size_t kept_bytes = 0;
  };
  absl::flat_hash_map<std::string, Followed> streams_ ABSL_GUARDED_BY(mutex_);  // by id
  absl::Time heard_ ABSL_GUARDED_BY(mutex_);                                    // when the tab sent something
  absl::Time probed_ ABSL_GUARDED_BY(mutex_);                                   // when it was pinged
  size_t reads_asked_ ABSL_GUARDED_BY(mutex_) = 0;
  std::vector<absl::Time> resting_ ABSL_GUARDED_BY(mutex_);  // places of reads that are answered: until when
  size_t unread_ ABSL_GUARDED_BY(mutex_) = 0;                // messages of the tab since it last read
  absl::Time begun_ ABSL_GUARDED_BY(mutex_) =
      absl::InfiniteFuture();  // when the message began that is not whole
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
};

// A stream of messages, or a read that is asked again and again: as the method is.
std::shared_ptr<LiveStream> MakeLiveStream(const std::shared_ptr<LiveSession>& session,
                                           const LiveRequest& request);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_LIVE_LIVE_SESSION_H_
