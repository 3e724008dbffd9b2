#include "kb_server/grpc/stream_arrival.h"

#include <grpc/grpc.h>
#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>

#include <chrono>
#include <memory>
#include <string_view>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"

namespace docent::server {
namespace {

constexpr std::string_view kReflection = "/grpc.reflection.";
constexpr char kLate[] = "no message of the call arrived in time (grpc_arrival_ms)";

class TimedCall final : public grpc::experimental::Interceptor {
 public:
  TimedCall(grpc::ServerContextBase* context, int arrival_ms)
      : call_(std::make_shared<Call>(context)), arrival_ms_(arrival_ms) {
    Begin();
  }
  ~TimedCall() override {
    absl::MutexLock lock(&call_->mutex);
    call_->context = nullptr;
  }

  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    using Point = grpc::experimental::InterceptionHookPoints;
    if (methods->QueryInterceptionHookPoint(Point::POST_RECV_MESSAGE)) Begin();
    methods->Proceed();
  }

 private:
  // Outlives the call while its alarm ends.
  struct Call {
    explicit Call(grpc::ServerContextBase* context) : context(context) {}
    absl::Mutex mutex;
    grpc::ServerContextBase* context ABSL_GUARDED_BY(mutex);  // null: the call is over
  };

  void Begin() {
    alarm_ = std::make_unique<grpc::Alarm>();  // the one before is cancelled
    alarm_->Set(std::chrono::system_clock::now() + std::chrono::milliseconds(arrival_ms_), [call = call_](
                                                                                               bool expired) {
      absl::MutexLock lock(&call->mutex);
      if (!expired || call->context == nullptr) return;
      grpc_call_cancel_with_status(call->context->c_call(), GRPC_STATUS_DEADLINE_EXCEEDED, kLate, nullptr);
    });
  }

  const std::shared_ptr<Call> call_;
  const int arrival_ms_;
  std::unique_ptr<grpc::Alarm> alarm_;
};

}  // namespace

grpc::experimental::Interceptor* StreamArrival::CreateServerInterceptor(
    grpc::experimental::ServerRpcInfo* info) {
  if (!std::string_view(info->method()).starts_with(kReflection)) return nullptr;
  return new TimedCall(info->server_context(), arrival_ms_);
}

}  // namespace docent::server
