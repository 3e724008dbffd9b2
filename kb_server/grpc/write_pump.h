// Pump of a gRPC stream to a client: one message is on its way at a time, and the next is made when the client has taken
// it. Base of all streams of the server.
//
// What it does for them: the end comes after the message that is on its way, also where the client goes away; a client
// that takes nothing can be cut; what is on its way counts in the budget of all streams; and others may hold a Link that
// outlives the stream. It deletes itself when gRPC is done with it.
// Threads: all virtual functions of it but OnGone and OnEnd are called with link()->mutex held, on a gRPC thread or on that of
// who calls Advance. Functions that say so want it held.
#ifndef DOCENT_KB_SERVER_GRPC_WRITE_PUMP_H_
#define DOCENT_KB_SERVER_GRPC_WRITE_PUMP_H_

#include <grpc/grpc.h>
#include <grpcpp/grpcpp.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "absl/synchronization/mutex.h"
#include "kb_server/door/send_budget.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {

// `Reactor`: grpc::ServerWriteReactor<Message>, or a grpc::ServerBidiReactor<…, Message>.
template <typename Reactor, typename Message>
class WritePump : public Reactor {
 public:
  struct Link {
    absl::Mutex mutex;
    WritePump* pump = nullptr;  // null: gRPC is done with it
  };

  // `budget`: may be null.
  WritePump(grpc::CallbackServerContext* context, SendBudget* budget)
      : context_(context),
        link_(std::make_shared<Link>()),
        share_(std::in_place, budget, [this](const absl::Status& status) {
          absl::MutexLock lock(&link_->mutex);
          Cut(ToGrpc(status));
        }) {
    link_->pump = this;
  }

  void OnWriteDone(bool ok) final {
    absl::MutexLock lock(&link_->mutex);
    writing_ = false;
    share_->Release(std::exchange(bytes_, 0));
    if (message_bytes_ > kKeptBytes) message_ = Message();  // a large one keeps its memory when it is cleared
    OnTaken(ok);
    if (!ok) End(Gone());
    if (ended_) return FinishNow();
    Advance();
  }
  void OnCancel() final {
    {
      absl::MutexLock lock(&link_->mutex);
      gone_ = true;
      End(Gone());
    }
    OnGone();
  }
  void OnDone() final {
    {
      absl::MutexLock lock(&link_->mutex);
      link_->pump = nullptr;
    }
    OnEnd();
    share_.reset();  // waits for who cuts this stream at the moment
    delete this;
  }

 protected:
  ~WritePump() override = default;

  // The next message into `message`, which is empty; `*options` may be changed. False: there is none now.
  virtual bool FillNext(Message* message, grpc::WriteOptions* options) = 0;
  // There is nothing to fill and nothing on its way: the place to End a stream that has said all.
  virtual void OnIdle() {}
  // Nothing more will be sent.
  virtual void OnEnding() {}
  // A message has been taken, or (not `ok`) will never be.
  virtual void OnTaken(bool /*ok*/) {}
  // The client has gone, or the call was cut. Without the mutex.
  virtual void OnGone() {}
  // Has gRPC end the call with this status, and fail what is on its way.
  virtual void CancelCall(const grpc::Status& status) {
    grpc_call_cancel_with_status(context_->c_call(), static_cast<grpc_status_code>(status.error_code()),
                                 status.error_message().c_str(), nullptr);
  }
  // gRPC is done with it; it is deleted next. Without the mutex.
  virtual void OnEnd() {}

  // All of these with the mutex held.

  // Sends the next message if there is one and no other is on its way.
  void Advance() {
    if (writing_ || ended_) return;
    message_.Clear();
    grpc::WriteOptions options;
    if (!FillNext(&message_, &options)) {
      message_bytes_ = 0;
      if (!ended_) OnIdle();
      return;
    }
    message_bytes_ = message_.ByteSizeLong();
    bytes_ = kCopies * message_bytes_ + 1;
    share_->Add(bytes_);
    writing_ = true;
    Reactor::StartWrite(&message_, options);
  }
  // Ends the stream now, or after the message that is on its way. The first End counts.
  void End(grpc::Status status) {
    if (ended_) return;
    ended_ = true;
    status_ = std::move(status);
    OnEnding();
    if (!writing_) FinishNow();
  }
  // Ends the stream although a message is on its way: gRPC sends the status past it and fails the write.
  void Cut(grpc::Status status) {
    if (finished_) return;
    status_ = std::move(status);
    if (!std::exchange(ended_, true)) OnEnding();
    if (!writing_) return FinishNow();
    if (!gone_) CancelCall(status_);
  }
  bool ended() const { return ended_; }
  bool gone() const { return gone_; }
  // What else the stream holds for its client, beside the message on its way.
  SendBudget::Share& share() { return *share_; }

  static grpc::Status Gone() { return {grpc::StatusCode::CANCELLED, "the client went away"}; }

 public:
  const std::shared_ptr<Link>& link() const { return link_; }

 private:
  static constexpr size_t kCopies = 2;  // as a message, and as what gRPC sends
  static constexpr size_t kKeptBytes = 4096;

  void FinishNow() {
    if (std::exchange(finished_, true)) return;
    Reactor::Finish(status_);
  }

  grpc::CallbackServerContext* const context_;  // until finished_
  const std::shared_ptr<Link> link_;
  std::optional<SendBudget::Share> share_;
  Message message_;  // on its way: gRPC reads it until OnWriteDone
  size_t message_bytes_ = 0;
  size_t bytes_ = 0;  // counted for it
  bool writing_ = false;
  bool ended_ = false;     // nothing more is sent
  bool finished_ = false;  // gRPC has been told
  bool gone_ = false;
  grpc::Status status_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_WRITE_PUMP_H_
