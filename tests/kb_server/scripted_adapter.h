// Robot adapter that does at once what a test tells it: real gRPC on a free port of loopback.
#ifndef DOCENT_TESTS_KB_SERVER_SCRIPTED_ADAPTER_H_
#define DOCENT_TESTS_KB_SERVER_SCRIPTED_ADAPTER_H_

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "docent/v1/robot_adapter.grpc.pb.h"

namespace docent::server::test {

class ScriptedAdapter final : public v1::RobotAdapter::Service {
 public:
  // `act` gives the final feedback of each command; default: SUCCEEDED.
  using Act = std::function<v1::Feedback(const v1::InvokeRequest&)>;

  explicit ScriptedAdapter(Act act = nullptr) : act_(std::move(act)) {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
    address_ = absl::StrCat("127.0.0.1:", port);
  }
  ~ScriptedAdapter() override { server_->Shutdown(std::chrono::system_clock::now()); }

  const std::string& address() const { return address_; }
  std::vector<std::string> commands() const {
    absl::MutexLock lock(&mutex_);
    return commands_;
  }
  void WaitForCommands(size_t count) const {
    absl::MutexLock lock(&mutex_);
    auto there = [&]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return commands_.size() >= count; };
    mutex_.AwaitWithTimeout(absl::Condition(&there), absl::Seconds(20));
  }

  grpc::Status Invoke(grpc::ServerContext*, const v1::InvokeRequest* request,
                      grpc::ServerWriter<v1::Feedback>* writer) override {
    {
      absl::MutexLock lock(&mutex_);
      commands_.push_back(request->command_id());
    }
    v1::Feedback feedback;
    if (act_)
      feedback = act_(*request);
    else
      feedback.set_state(v1::Feedback::SUCCEEDED);
    feedback.set_command_id(request->command_id());
    feedback.set_incarnation("i1");
    writer->Write(feedback);
    return grpc::Status::OK;
  }
  grpc::Status Attach(grpc::ServerContext*, const v1::AttachRequest*,
                      grpc::ServerWriter<v1::Feedback>*) override {
    return grpc::Status(grpc::StatusCode::NOT_FOUND, "never begun");
  }

 private:
  const Act act_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
  mutable absl::Mutex mutex_;
  std::vector<std::string> commands_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_SCRIPTED_ADAPTER_H_
