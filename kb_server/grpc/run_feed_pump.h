// Pump of a gRPC stream that tells a client of events of runs, read from the feed at the client's pace. It holds a place
// in the feed and no events of its own, so a slow client costs nothing; one that falls behind what the feed keeps is told
// that it is too slow. Threads as in write_pump.h.
#ifndef DOCENT_KB_SERVER_GRPC_RUN_FEED_PUMP_H_
#define DOCENT_KB_SERVER_GRPC_RUN_FEED_PUMP_H_

#include <cstdint>

#include "kb_server/door/ports.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/write_pump.h"

namespace docent::server {

template <typename Message>
class RunFeedPump : public WritePump<grpc::ServerWriteReactor<Message>, Message> {
 public:
  using Pump = WritePump<grpc::ServerWriteReactor<Message>, Message>;

  RunFeedPump(grpc::CallbackServerContext* context, const RunPorts& ports)
      : Pump(context, ports.send_budget), feed_(*ports.feed) {
    subscription_ = feed_.Subscribe([this] {
      absl::MutexLock lock(&this->link()->mutex);
      this->Advance();
    });
  }

 protected:
  RunFeed& feed() { return feed_; }

  // Both with the mutex held.

  // The message that tells of `event`. False: the client does not want it.
  virtual bool Tell(const RunEvent& event, Message* message) = 0;
  // The number of the first event that is told, if it wants it, or why there is none. Before, nothing is sent.
  void BeginAt(const absl::StatusOr<uint64_t>& first) {
    if (!first.ok()) return this->End(ToGrpc(first.status()));
    next_ = *first;
    this->Advance();
  }

  // The next event that the client wants, if it is there.
  bool FillNext(Message* message, grpc::WriteOptions*) override {
    while (next_ != 0) {
      absl::StatusOr<RunEventPtr> event = feed_.Get(next_);
      if (!event.ok()) this->End(ToGrpc(event.status()));
      if (!event.ok() || *event == nullptr) return false;
      ++next_;
      if (Tell(**event, message)) return true;
    }
    return false;
  }
  void OnEnd() override {
    feed_.Unsubscribe(subscription_);  // waits for the committer's thread if that is in Advance
  }

 private:
  RunFeed& feed_;
  uint64_t subscription_ = 0;
  uint64_t next_ = 0;  // number of the next event; 0: not known yet
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_RUN_FEED_PUMP_H_
