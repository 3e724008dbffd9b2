// A server stream of gRPC's callback API that other threads feed through a bounded queue.
//
// `Push` may be called from any thread; it waits while the queue is full (a slow client slows its own
// producer, nobody else's) and returns false when the client has gone. `End` closes the stream after what is
// queued. The object deletes itself when gRPC is done with it, so a producer holds a StreamHandle, which
// outlives it.
#ifndef DOCENT_KB_SERVER_SERVICE_STREAM_REACTOR_H_
#define DOCENT_KB_SERVER_SERVICE_STREAM_REACTOR_H_

#include <grpcpp/grpcpp.h>

#include <deque>
#include <functional>
#include <memory>
#include <utility>

#include "absl/synchronization/mutex.h"

namespace docent {

template <typename Message>
class StreamReactor;

// The producer's side; thread-safe.
template <typename Message>
class StreamHandle {
 public:
  static constexpr size_t kQueueLimit = 1024;

  // Waits while the queue is full; false: the client has gone or the stream has ended, stop producing.
  bool Push(Message message) {
    absl::MutexLock lock(&mutex_);
    mutex_.Await(absl::Condition(this, &StreamHandle::HasRoomOrDead));
    if (dead_ || ending_) return false;
    queue_.push_back(std::move(message));
    Pump();
    return true;
  }
  // As Push, but false instead of waiting: for producers that serve many clients.
  bool TryPush(Message message) {
    absl::MutexLock lock(&mutex_);
    if (dead_ || ending_ || queue_.size() >= kQueueLimit) return false;
    queue_.push_back(std::move(message));
    Pump();
    return true;
  }
  // Closes the stream after the queued messages. The first End counts.
  void End(grpc::Status status) {
    absl::MutexLock lock(&mutex_);
    if (dead_ || ending_) return;
    ending_ = true;
    status_ = std::move(status);
    Pump();
  }
  bool gone() const {
    absl::MutexLock lock(&mutex_);
    return dead_;
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

  bool HasRoomOrDead() const { return dead_ || ending_ || queue_.size() < kQueueLimit; }

  void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (dead_ || writing_ || finished_) return;
    if (!queue_.empty()) {
      writing_ = true;
      current_ = std::move(queue_.front());
      queue_.pop_front();
      reactor_->StartWrite(&current_);
    } else if (ending_) {
      finished_ = true;
      reactor_->Finish(status_);
    }
  }

  mutable absl::Mutex mutex_;
  StreamReactor<Message>* reactor_ ABSL_GUARDED_BY(mutex_) = nullptr;
  std::deque<Message> queue_ ABSL_GUARDED_BY(mutex_);
  Message current_;  // being written: gRPC reads it until OnWriteDone
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool ending_ ABSL_GUARDED_BY(mutex_) = false;
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  bool dead_ ABSL_GUARDED_BY(mutex_) = false;
  bool cancelled_ ABSL_GUARDED_BY(mutex_) = false;
  grpc::Status status_ ABSL_GUARDED_BY(mutex_);
  std::function<void()> on_gone_ ABSL_GUARDED_BY(mutex_);
};

template <typename Message>
class StreamReactor final : public grpc::ServerWriteReactor<Message> {
 public:
  StreamReactor() : handle_(std::make_shared<StreamHandle<Message>>()) {
    absl::MutexLock lock(&handle_->mutex_);
    handle_->reactor_ = this;
  }
  const std::shared_ptr<StreamHandle<Message>>& handle() const { return handle_; }

  void OnWriteDone(bool ok) override {
    absl::MutexLock lock(&handle_->mutex_);
    handle_->writing_ = false;
    if (!ok) Kill();
    handle_->Pump();
  }
  void OnCancel() override {
    std::function<void()> callback;
    {
      absl::MutexLock lock(&handle_->mutex_);
      Kill();
      handle_->cancelled_ = true;
      callback = std::move(handle_->on_gone_);
    }
    if (callback) callback();
  }
  void OnDone() override {
    {
      absl::MutexLock lock(&handle_->mutex_);
      handle_->dead_ = true;
      handle_->reactor_ = nullptr;
    }
    delete this;
  }

 private:
  // The client is gone: nothing more is written, but gRPC still wants its Finish.
  void Kill() ABSL_EXCLUSIVE_LOCKS_REQUIRED(handle_->mutex_) {
    handle_->queue_.clear();
    if (!handle_->finished_ && !handle_->writing_) {
      handle_->finished_ = true;
      this->Finish(grpc::Status(grpc::StatusCode::CANCELLED, "the client went away"));
    }
    handle_->dead_ = handle_->finished_;
    handle_->ending_ = true;
    if (handle_->status_.ok())
      handle_->status_ = grpc::Status(grpc::StatusCode::CANCELLED, "the client went away");
  }

  std::shared_ptr<StreamHandle<Message>> handle_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_SERVICE_STREAM_REACTOR_H_
