#include "kb_server/grpc/one_callback_thread.h"

#include <grpc/support/cpu.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>

#include <functional>
#include <utility>

#include "absl/synchronization/notification.h"

namespace docent::server {

// A call that fails at once, since its channel has no credentials; its end comes on a callback thread.
struct OneCallbackThread::Call {
  Call(grpc::GenericStub* stub, std::function<void()> on_end) {
    stub->UnaryCall(&context, "/none", grpc::StubOptions(), &request, &reply,
                    [this, on_end = std::move(on_end)](const grpc::Status&) {
                      if (on_end) on_end();
                      ended.Notify();
                    });
  }
  // gRPC 1.51 crashes when one of its own threads lets go of the last channel: a call does not end its own life.
  ~Call() { ended.WaitForNotification(); }

  grpc::ClientContext context;
  const grpc::Slice nothing;
  const grpc::ByteBuffer request{&nothing, 1};
  grpc::ByteBuffer reply;
  absl::Notification ended;
};

struct OneCallbackThread::KeptThread {
  ~KeptThread() { free.Notify(); }

  grpc::GenericStub stub{grpc::CreateChannel("none", nullptr)};
  absl::Notification free;
  Call waiting{&stub, [this] { free.WaitForNotification(); }};
  std::unique_ptr<Call> event;
};

OneCallbackThread::OneCallbackThread() {
  const bool two_threads = gpr_cpu_num_cores() / 2 <= 2;
  if (two_threads) kept_ = std::make_unique<KeptThread>();
}

OneCallbackThread::~OneCallbackThread() = default;

void OneCallbackThread::KeepAwake() {
  if (kept_ == nullptr || (kept_->event != nullptr && !kept_->event->ended.HasBeenNotified())) return;
  kept_->event = std::make_unique<Call>(&kept_->stub, nullptr);
}

}  // namespace docent::server
