// A server stream of gRPC's callback API that other threads feed through a bounded queue.
//
// Pushing never waits: a producer that serves many clients ends the stream of one that is too slow; a
// producer with a thread of its own waits for room with `AwaitRoom`, which gives up on a client that takes
// nothing for Limits::slow_client_ms. `End` closes the stream after what is queued, and cuts it if that is
// not taken in the same time: so a client that does not read holds neither a thread nor memory for long. The
// object deletes itself when gRPC is done with it; a producer holds a StreamHandle, which outlives it.
// Thread-safe.
#ifndef DOCENT_KB_SERVER_GRPC_STREAM_REACTOR_H_
#define DOCENT_KB_SERVER_GRPC_STREAM_REACTOR_H_

#include <grpc/grpc.h>
#include <grpcpp/alarm.h>
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "graph/base/limits.h"

namespace docent {

template <typename Message>
class StreamReactor;

// The producer's side; thread-safe.
template <typename Message>
class StreamHandle : public std::enable_shared_from_this<StreamHandle<Message>> {
 public:
  StreamHandle(grpc::CallbackServerContext* context, const Limits& limits)
      : limits_(limits), context_(context) {}

  // False: the queue is full (stream_messages, stream_bytes), or the client has gone or the stream has ended.
  bool TryPush(Message message) {
    const size_t bytes = message.ByteSizeLong();
    absl::MutexLock lock(&mutex_);
    if (ending_ || IsFull()) return false;
    queue_bytes_ += bytes;
    queue_.emplace_back(std::move(message), bytes);
    Pump();
    return true;
  }

  bool full() const {
    absl::MutexLock lock(&mutex_);
    return !ending_ && IsFull();
  }

  // Waits until half of the queue is free. False: the client has gone, or it took nothing for slow_client_ms
  // (the stream is cut with RESOURCE_EXHAUSTED), or `deadline` has passed (with DEADLINE_EXCEEDED).
  bool AwaitRoom(absl::Time deadline) {
    const absl::Duration patience = absl::Milliseconds(limits_.slow_client_ms);
    absl::MutexLock lock(&mutex_);
    while (true) {
      const uint64_t taken = taken_;
      const absl::Time until = std::min(deadline, absl::Now() + patience);
      if (mutex_.AwaitWithDeadline(absl::Condition(this, &StreamHandle::HasRoomOrEnds), until))
        return !ending_;
      if (absl::Now() >= deadline) {
        Cut(grpc::Status(grpc::StatusCode::DEADLINE_EXCEEDED,
                         "the client did not take the whole answer before the time limit of the request"));
        return false;
      }
      if (taken_ != taken) continue;
      Cut(TooSlow());
      return false;
    }
  }

  // Closes the stream after the queued messages. The first End counts.
  void End(grpc::Status status) {
    absl::MutexLock lock(&mutex_);
    if (ending_) return;
    ending_ = true;
    status_ = std::move(status);
    Pump();
    if (!finished_) CutIfNothingIsTaken();
  }

  // Called once when the client goes away before the end: from a gRPC thread, or at once if it has gone
  // already.
  void OnGone(std::function<void()> callback) {
    {
      absl::MutexLock lock(&mutex_);
      if (!cancelled_) {
        on_gone_ = std::move(callback);
        return;
      }
    }
    callback();
  }

 private:
  friend class StreamReactor<Message>;

  bool IsFull() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return queue_.size() >= limits_.stream_messages || queue_bytes_ >= limits_.stream_bytes;
  }
  bool HasRoomOrEnds() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return ending_ ||
           (queue_.size() <= limits_.stream_messages / 2 && queue_bytes_ <= limits_.stream_bytes / 2);
  }

  void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (writing_ || finished_) return;
    if (!queue_.empty()) {
      writing_ = true;
      current_ = std::move(queue_.front().first);
      queue_bytes_ -= queue_.front().second;
      queue_.pop_front();
      reactor_->StartWrite(&current_);
    } else if (ending_) {
      finished_ = true;
      reactor_->Finish(status_);
    }
  }

  grpc::Status TooSlow() const {
    return {grpc::StatusCode::RESOURCE_EXHAUSTED,
            absl::StrCat("the client took nothing of the answer for the time of the limit slow_client_ms = ",
                         limits_.slow_client_ms)};
  }

  // Nothing more is written.
  void Drop(grpc::Status status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    queue_.clear();
    queue_bytes_ = 0;
    if (!ending_) status_ = std::move(status);
    ending_ = true;
    Pump();
  }

  // Ends the stream although a write is stuck: gRPC sends the status past it and fails the write, see
  // OnWriteDone.
  void Cut(grpc::Status status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    status_ = std::move(status);
    ending_ = true;
    Drop(status_);
    if (finished_) return;
    grpc_call_cancel_with_status(context_->c_call(), static_cast<grpc_status_code>(status_.error_code()),
                                 status_.error_message().c_str(), nullptr);
  }

  // Looks again after slow_client_ms, as long as there is something to take.
  void CutIfNothingIsTaken() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    alarm_ = std::make_unique<grpc::Alarm>();
    const auto deadline =
        std::chrono::system_clock::now() + std::chrono::milliseconds(limits_.slow_client_ms);
    alarm_->Set(deadline, [self = this->shared_from_this(), taken = taken_](bool expired) {
      absl::MutexLock lock(&self->mutex_);
      if (!expired || self->finished_) return;
      if (self->taken_ != taken) {
        self->CutIfNothingIsTaken();
      } else {
        self->Cut(self->TooSlow());
      }
    });
  }

  const Limits limits_;
  mutable absl::Mutex mutex_;
  grpc::CallbackServerContext* const context_;                         // until finished_
  StreamReactor<Message>* reactor_ ABSL_GUARDED_BY(mutex_) = nullptr;  // likewise
  std::deque<std::pair<Message, size_t>> queue_ ABSL_GUARDED_BY(mutex_);
  size_t queue_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  uint64_t taken_ ABSL_GUARDED_BY(mutex_) = 0;  // messages that gRPC has taken over
  Message current_;                             // being written: gRPC reads it until OnWriteDone
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool ending_ ABSL_GUARDED_BY(mutex_) = false;    // nothing more is accepted
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;  // gRPC has been told
  bool cancelled_ ABSL_GUARDED_BY(mutex_) = false;
  grpc::Status status_ ABSL_GUARDED_BY(mutex_);
  std::function<void()> on_gone_ ABSL_GUARDED_BY(mutex_);
  std::unique_ptr<grpc::Alarm> alarm_ ABSL_GUARDED_BY(mutex_);
};

template <typename Message>
class StreamReactor final : public grpc::ServerWriteReactor<Message> {
 public:
  StreamReactor(grpc::CallbackServerContext* context, const Limits& limits)
      : handle_(std::make_shared<StreamHandle<Message>>(context, limits)) {
    absl::MutexLock lock(&handle_->mutex_);
    handle_->reactor_ = this;
  }
  const std::shared_ptr<StreamHandle<Message>>& handle() const { return handle_; }

  void OnWriteDone(bool ok) override {
    absl::MutexLock lock(&handle_->mutex_);
    handle_->writing_ = false;
    ++handle_->taken_;
    if (ok) {
      handle_->Pump();
    } else {
      handle_->Drop(Gone());
    }
  }
  void OnCancel() override {
    std::function<void()> callback;
    {
      absl::MutexLock lock(&handle_->mutex_);
      handle_->Drop(Gone());
      handle_->cancelled_ = true;
      callback = std::move(handle_->on_gone_);
    }
    if (callback) callback();
  }
  void OnDone() override {
    {
      absl::MutexLock lock(&handle_->mutex_);
      handle_->alarm_.reset();
    }
    delete this;
  }

 private:
  static grpc::Status Gone() { return {grpc::StatusCode::CANCELLED, "the client went away"}; }

  const std::shared_ptr<StreamHandle<Message>> handle_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_GRPC_STREAM_REACTOR_H_
