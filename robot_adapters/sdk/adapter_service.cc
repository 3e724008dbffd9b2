#include "robot_adapters/sdk/adapter_service.h"

#include <optional>
#include <string>
#include <utility>

namespace docent::robot {
namespace {

bool IsFinal(const v1::Feedback& feedback) {
  return feedback.state() == v1::Feedback::SUCCEEDED || feedback.state() == v1::Feedback::FAILED ||
         feedback.state() == v1::Feedback::CANCELLED;
}

grpc::Status ToGrpc(const absl::Status& status) {
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), std::string(status.message()));
}

// One feedback stream. A slow reader gets the newest state, not every one; it always gets the final one.
class FeedbackStream final : public grpc::ServerWriteReactor<v1::Feedback>, public FeedbackWatcher {
 public:
  explicit FeedbackStream(absl::StatusOr<std::shared_ptr<RunningCommand>> command) {
    if (!command.ok()) {
      Finish(ToGrpc(command.status()));
      return;
    }
    command_ = *std::move(command);
    command_->Watch(this);
  }

  void OnFeedback(const v1::Feedback& feedback) override {
    absl::MutexLock lock(&mutex_);
    next_ = feedback;
    Pump();
  }

  void OnWriteDone(bool ok) override {
    absl::MutexLock lock(&mutex_);
    writing_ = false;
    gone_ = gone_ || !ok;
    Pump();
  }

  void OnCancel() override {
    absl::MutexLock lock(&mutex_);
    gone_ = true;
    Pump();
  }

  void OnDone() override {
    if (command_) command_->Unwatch(this);
    delete this;
  }

 private:
  void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (writing_ || finished_) return;
    if (gone_ || (!next_ && IsFinal(current_))) {
      finished_ = true;
      Finish(grpc::Status::OK);
    } else if (next_) {
      current_ = *std::exchange(next_, std::nullopt);
      writing_ = true;
      StartWrite(&current_);
    }
  }

  std::shared_ptr<RunningCommand> command_;
  absl::Mutex mutex_;
  std::optional<v1::Feedback> next_ ABSL_GUARDED_BY(mutex_);
  v1::Feedback current_;  // gRPC reads it until OnWriteDone
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  bool gone_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace

grpc::ServerUnaryReactor* AdapterService::Describe(grpc::CallbackServerContext* context,
                                                   const v1::DescribeRequest*, v1::RobotDescription* reply) {
  *reply = description_;
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(grpc::Status::OK);
  return reactor;
}

grpc::ServerWriteReactor<v1::Feedback>* AdapterService::Invoke(grpc::CallbackServerContext*,
                                                               const v1::InvokeRequest* request) {
  return new FeedbackStream(commands_->Begin(*request));
}

grpc::ServerUnaryReactor* AdapterService::Cancel(grpc::CallbackServerContext* context,
                                                 const v1::CancelRequest* request, v1::CancelReply* reply) {
  commands_->Cancel(CommandId(request->command_id()));
  reply->set_known(true);
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(grpc::Status::OK);
  return reactor;
}

grpc::ServerWriteReactor<v1::Feedback>* AdapterService::Attach(grpc::CallbackServerContext*,
                                                               const v1::AttachRequest* request) {
  return new FeedbackStream(commands_->Find(CommandId(request->command_id())));
}

}  // namespace docent::robot
