// One Invoke or Attach call to an adapter, from its start until gRPC is done with it. Callback API. Each message is read when
// the one before is done with: an adapter that tells more than is used waits.
#ifndef DOCENT_ROBOT_ADAPTERS_PROXY_FEEDBACK_CALL_H_
#define DOCENT_ROBOT_ADAPTERS_PROXY_FEEDBACK_CALL_H_

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <variant>

#include "docent/v1/robot_adapter.grpc.pb.h"

namespace docent::proxy {

class FeedbackCall final : public grpc::ClientReadReactor<v1::Feedback> {
 public:
  using Request = std::variant<v1::InvokeRequest, v1::AttachRequest>;
  // Gets the call, too, whose Next it has to call, then or later.
  using FeedbackCallback = std::function<void(v1::Feedback, FeedbackCall*)>;
  // Takes over the call. Must not let go of it on the thread that it runs on: a call may hold the last
  // reference to its channel, and gRPC 1.51 crashes when one of its own callback threads destroys the last
  // channel of a process.
  using DoneCallback = std::function<void(const grpc::Status&, std::shared_ptr<FeedbackCall>)>;

  // The callbacks run on gRPC's threads, in the order of events, `on_done` last and exactly once. The call
  // keeps itself alive until then.
  static std::shared_ptr<FeedbackCall> Start(uint64_t serial, std::shared_ptr<v1::RobotAdapter::Stub> stub,
                                             Request request, std::chrono::system_clock::time_point deadline,
                                             FeedbackCallback on_feedback, DoneCallback on_done) {
    auto call = std::shared_ptr<FeedbackCall>(new FeedbackCall(serial, std::move(stub), std::move(request),
                                                               std::move(on_feedback), std::move(on_done)));
    call->self_ = call;
    call->context_.set_deadline(deadline);
    if (const auto* invoke = std::get_if<v1::InvokeRequest>(&call->request_)) {
      call->stub_->async()->Invoke(&call->context_, invoke, call.get());
    } else {
      call->stub_->async()->Attach(&call->context_, &std::get<v1::AttachRequest>(call->request_), call.get());
    }
    call->AddHold();  // while reads are started from outside; until one fails
    call->StartRead(&call->message_);
    call->StartCall();
    return call;
  }

  // Reads the next message. Once for each message, any thread. The call is there until then.
  void Next() { StartRead(&message_); }

  // Unique to this call, so that a late callback is not taken for one of the next call.
  uint64_t serial() const { return serial_; }
  bool is_attach() const { return std::holds_alternative<v1::AttachRequest>(request_); }
  // Ends the call soon, with CANCELLED. Any thread.
  void Cancel() { context_.TryCancel(); }

 private:
  FeedbackCall(uint64_t serial, std::shared_ptr<v1::RobotAdapter::Stub> stub, Request request,
               FeedbackCallback on_feedback, DoneCallback on_done)
      : serial_(serial),
        stub_(std::move(stub)),
        request_(std::move(request)),
        on_feedback_(std::move(on_feedback)),
        on_done_(std::move(on_done)) {}

  void OnReadDone(bool ok) override {
    if (!ok) return RemoveHold();
    on_feedback_(std::exchange(message_, {}), this);
  }
  void OnDone(const grpc::Status& status) override {
    DoneCallback on_done = std::move(on_done_);  // the call may be gone before it returns
    on_done(status, std::move(self_));
  }

  const uint64_t serial_;
  const std::shared_ptr<v1::RobotAdapter::Stub> stub_;
  const Request request_;
  const FeedbackCallback on_feedback_;
  DoneCallback on_done_;
  grpc::ClientContext context_;
  v1::Feedback message_;
  std::shared_ptr<FeedbackCall> self_;
};

}  // namespace docent::proxy

#endif  // DOCENT_ROBOT_ADAPTERS_PROXY_FEEDBACK_CALL_H_
