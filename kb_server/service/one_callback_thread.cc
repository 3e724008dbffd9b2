#include "kb_server/service/one_callback_thread.h"

#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>

#include <thread>

#include "absl/synchronization/notification.h"

namespace docent {
namespace {

constexpr unsigned kProcessorsWithTwoThreads = 5;  // gRPC has max(2, processors / 2)

}  // namespace

// A call that fails at once, since its channel has no credentials: its end comes on one of the threads, which waits there.
struct OneCallbackThread::KeptThread {
  KeptThread() {
    stub.UnaryCall(&context, "/none", grpc::StubOptions(), &request, &reply, [this](const grpc::Status&) {
      free.WaitForNotification();
      freed.Notify();
    });
  }
  ~KeptThread() {
    free.Notify();
    freed.WaitForNotification();
  }

  grpc::GenericStub stub{grpc::CreateChannel("none", nullptr)};
  grpc::ClientContext context;
  const grpc::Slice nothing;
  const grpc::ByteBuffer request{&nothing, 1};
  grpc::ByteBuffer reply;
  absl::Notification free, freed;
};

OneCallbackThread::OneCallbackThread() {
  if (std::thread::hardware_concurrency() <= kProcessorsWithTwoThreads) kept_ = std::make_unique<KeptThread>();
}

OneCallbackThread::~OneCallbackThread() = default;

}  // namespace docent
