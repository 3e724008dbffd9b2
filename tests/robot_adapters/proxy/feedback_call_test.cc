#include "robot_adapters/proxy/feedback_call.h"

#include <gtest/gtest.h>

#include <atomic>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "absl/synchronization/notification.h"

namespace docent::proxy {
namespace {

// Tells as much progress as it can, and then the end.
class TalkativeAdapter final : public v1::RobotAdapter::Service {
 public:
  TalkativeAdapter() {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~TalkativeAdapter() override { server_->Shutdown(std::chrono::system_clock::now()); }
  std::string address() const { return absl::StrCat("127.0.0.1:", port_); }

  grpc::Status Invoke(grpc::ServerContext*, const v1::InvokeRequest*,
                      grpc::ServerWriter<v1::Feedback>* writer) override {
    v1::Feedback feedback;
    feedback.set_state(v1::Feedback::RUNNING);
    for (int i = 0; i < 3; ++i) writer->Write(feedback);
    feedback.set_state(v1::Feedback::SUCCEEDED);
    writer->Write(feedback);
    written.Notify();
    return grpc::Status::OK;
  }
  absl::Notification written;

 private:
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

TEST(FeedbackCallTest, TheNextMessageIsReadWhenTheOneBeforeIsDoneWith) {
  TalkativeAdapter adapter;
  absl::Mutex mutex;
  int seen = 0;
  FeedbackCall* waiting = nullptr;
  absl::Notification ended;
  std::shared_ptr<v1::RobotAdapter::Stub> stub =
      v1::RobotAdapter::NewStub(grpc::CreateChannel(adapter.address(), grpc::InsecureChannelCredentials()));
  std::shared_ptr<FeedbackCall> kept;  // not let go of on gRPC's thread
  FeedbackCall::Start(
      1, stub, v1::InvokeRequest(), std::chrono::system_clock::now() + std::chrono::minutes(1),
      [&](const v1::Feedback&, FeedbackCall* call) {
        absl::MutexLock lock(&mutex);
        ++seen;
        waiting = call;
      },
      [&](const grpc::Status& status, std::shared_ptr<FeedbackCall> call) {
        EXPECT_TRUE(status.ok());
        kept = std::move(call);
        ended.Notify();
      });
  const auto has_one = [&] { return waiting != nullptr; };
  for (int message = 1; message <= 4; ++message) {
    FeedbackCall* call = nullptr;
    {
      absl::MutexLock lock(&mutex);
      mutex.Await(absl::Condition(&has_one));
      adapter.written.WaitForNotification();
      EXPECT_EQ(seen, message) << "the others wait, though they are there";
      EXPECT_FALSE(ended.HasBeenNotified());
      call = std::exchange(waiting, nullptr);
    }
    call->Next();
  }
  ended.WaitForNotification();
  EXPECT_EQ(seen, 4);
}

}  // namespace
}  // namespace docent::proxy
