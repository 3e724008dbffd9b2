// A server stream of gRPC's callback API that other threads feed through a bounded queue.
//
// Pushing never waits: a producer that serves many clients ends the stream of one that is too slow; a
// producer with a thread of its own waits for room with `AwaitRoom`, which gives up on a client that takes
// nothing for Limits::slow_client_ms. `End` closes the stream after what is queued, and cuts it if that is
// not taken in the same time: so a client that does not read holds neither a thread nor memory for long. A producer holds a
// StreamHandle, which outlives the stream. Thread-safe.
#ifndef DOCENT_KB_SERVER_GRPC_STREAM_REACTOR_H_
#define DOCENT_KB_SERVER_GRPC_STREAM_REACTOR_H_

#include <grpcpp/alarm.h>
#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "graph/base/limits.h"
#include "kb_server/grpc/write_pump.h"

namespace docent::server {

template <typename Message>
class StreamHandle;

template <typename Message>
class StreamReactor final : public WritePump<grpc::ServerWriteReactor<Message>, Message> {
 public:
  // `budget`: may be null.
  StreamReactor(grpc::CallbackServerContext* context, const Limits& limits, SendBudget* budget)
      : WritePump<grpc::ServerWriteReactor<Message>, Message>(context, budget),
        handle_(std::make_shared<StreamHandle<Message>>(this, limits)) {}
  const std::shared_ptr<StreamHandle<Message>>& handle() const { return handle_; }

 private:
  friend class StreamHandle<Message>;

  bool FillNext(Message* message, grpc::WriteOptions*) override { return handle_->Pop(message); }
  void OnIdle() override {
    if (handle_->ending_) this->End(handle_->status_);
  }
  void OnTaken(bool) override { ++handle_->taken_; }
  void OnEnding() override { handle_->Drop(); }
  void OnGone() override { handle_->TellGone(); }
  void OnEnd() override {
    absl::MutexLock lock(&this->link()->mutex);
    handle_->reactor_ = nullptr;
    handle_->alarm_.reset();
  }

  const std::shared_ptr<StreamHandle<Message>> handle_;
};

// The producer's side; thread-safe.
template <typename Message>
class StreamHandle : public std::enable_shared_from_this<StreamHandle<Message>> {
 public:
  StreamHandle(StreamReactor<Message>* reactor, const Limits& limits)
      : limits_(limits), link_(reactor->link()), reactor_(reactor) {}

  // False: the queue is full (stream_messages, stream_bytes), or the client has gone or the stream has ended.
  bool TryPush(Message message) {
    const size_t bytes = message.ByteSizeLong();
    absl::MutexLock lock(&link_->mutex);
    if (ending_ || IsFull()) return false;
    queue_bytes_ += bytes;
    reactor_->share().Add(bytes);
    queue_.emplace_back(std::move(message), bytes);
    reactor_->Advance();
    return true;
  }

  bool full() const {
    absl::MutexLock lock(&link_->mutex);
    return !ending_ && IsFull();
  }

  // Waits until half of the queue is free. False: the client has gone, or it took nothing for slow_client_ms (the stream is
  // cut with RESOURCE_EXHAUSTED), or `give_up`, which is called now and then, is true (likewise), or `deadline` has passed
  // (with DEADLINE_EXCEEDED).
  bool AwaitRoom(absl::Time deadline, const std::function<bool()>& give_up) {
    const absl::Duration patience = absl::Milliseconds(limits_.slow_client_ms);
    absl::MutexLock lock(&link_->mutex);
    uint64_t taken = taken_;
    for (absl::Time until = absl::Now() + patience;;) {
      const absl::Time look = std::min({deadline, until, absl::Now() + kLookAround});
      if (link_->mutex.AwaitWithDeadline(absl::Condition(this, &StreamHandle::HasRoomOrEnds), look))
        return !ending_;
      const absl::Time now = absl::Now();
      if (now >= deadline) {
        Cut(grpc::Status(grpc::StatusCode::DEADLINE_EXCEEDED,
                         "the client did not take the whole answer before the time limit of the request"));
        return false;
      }
      if (give_up()) {
        Cut(Crowded());
        return false;
      }
      if (taken_ != taken) {
        taken = taken_;
        until = now + patience;
      } else if (now >= until) {
        Cut(TooSlow());
        return false;
      }
    }
  }

  // Closes the stream after the queued messages. The first End counts.
  void End(grpc::Status status) {
    absl::MutexLock lock(&link_->mutex);
    if (ending_) return;
    ending_ = true;
    status_ = std::move(status);
    reactor_->Advance();
    if (!reactor_->ended()) CutIfNothingIsTaken();
  }

  // Called once when the client goes away before the end: from a gRPC thread, or at once if it has gone
  // already.
  void OnGone(std::function<void()> callback) {
    {
      absl::MutexLock lock(&link_->mutex);
      if (!gone_) {
        on_gone_ = std::move(callback);
        return;
      }
    }
    callback();
  }

 private:
  friend class StreamReactor<Message>;
  using Link = typename WritePump<grpc::ServerWriteReactor<Message>, Message>::Link;
  static constexpr absl::Duration kLookAround = absl::Milliseconds(100);

  // All of these with the mutex held, but TellGone.
  bool IsFull() const {
    return queue_.size() >= limits_.stream_messages || queue_bytes_ >= limits_.stream_bytes;
  }
  bool HasRoomOrEnds() const {
    return ending_ ||
           (queue_.size() <= limits_.stream_messages / 2 && queue_bytes_ <= limits_.stream_bytes / 2);
  }
  bool Pop(Message* message) {
    if (queue_.empty()) return false;
    *message = std::move(queue_.front().first);
    Forget(queue_.front().second);
    queue_.pop_front();
    return true;
  }
  void Forget(size_t bytes) {
    queue_bytes_ -= bytes;
    reactor_->share().Release(bytes);
  }
  void Drop() {
    ending_ = true;
    Forget(queue_bytes_);
    queue_.clear();
  }
  void Cut(grpc::Status status) {
    if (reactor_ != nullptr) reactor_->Cut(std::move(status));
  }
  void TellGone() {
    std::function<void()> callback;
    {
      absl::MutexLock lock(&link_->mutex);
      gone_ = true;
      callback = std::move(on_gone_);
    }
    if (callback) callback();
  }

  grpc::Status TooSlow() const {
    return {grpc::StatusCode::RESOURCE_EXHAUSTED,
            absl::StrCat("the client took nothing of the answer for the time of the limit slow_client_ms = ",
                         limits_.slow_client_ms)};
  }
  grpc::Status Crowded() const {
    return {grpc::StatusCode::RESOURCE_EXHAUSTED,
            absl::StrCat("the client takes the answer slowly, and others wait for its place; the limits are "
                         "queries_open = ",
                         limits_.queries_open, " and crowded_client_ms = ", limits_.crowded_client_ms)};
  }

  // Looks again after slow_client_ms, as long as there is something to take.
  void CutIfNothingIsTaken() {
    alarm_ = std::make_unique<grpc::Alarm>();
    const auto deadline =
        std::chrono::system_clock::now() + std::chrono::milliseconds(limits_.slow_client_ms);
    alarm_->Set(deadline, [self = this->shared_from_this(), taken = taken_](bool expired) {
      absl::MutexLock lock(&self->link_->mutex);
      if (!expired || self->reactor_ == nullptr) return;
      if (self->taken_ != taken) {
        self->CutIfNothingIsTaken();
      } else {
        self->Cut(self->TooSlow());
      }
    });
  }

  const Limits limits_;
  const std::shared_ptr<Link> link_;
  StreamReactor<Message>* reactor_;  // null: gRPC is done with it
  std::deque<std::pair<Message, size_t>> queue_;
  size_t queue_bytes_ = 0;
  uint64_t taken_ = 0;   // messages that gRPC has taken over
  bool ending_ = false;  // nothing more is accepted
  bool gone_ = false;
  grpc::Status status_;
  std::function<void()> on_gone_;
  std::unique_ptr<grpc::Alarm> alarm_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_STREAM_REACTOR_H_
