#include "kb_server/grpc/one_callback_thread.h"

#include <gmock/gmock.h>
#include <grpc/support/cpu.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "absl/synchronization/mutex.h"

namespace docent::server {
namespace {

// The threads on which `count` concurrent calls end.
std::set<std::thread::id> CallbackThreads(int count) {
  struct Call {
    grpc::ClientContext context;
    grpc::Slice nothing;
    grpc::ByteBuffer request{&nothing, 1}, reply;
  };
  grpc::GenericStub stub(grpc::CreateChannel("none", nullptr));  // its calls fail at once
  std::vector<Call> calls(static_cast<size_t>(count));
  absl::Mutex mutex;
  std::set<std::thread::id> threads;
  int ended = 0;
  for (Call& call : calls) {
    stub.UnaryCall(&call.context, "/none", grpc::StubOptions(), &call.request, &call.reply,
                   [&](const grpc::Status&) {
                     std::this_thread::sleep_for(
                         std::chrono::milliseconds(1));  // so that another thread takes the next one
                     absl::MutexLock lock(&mutex);
                     threads.insert(std::this_thread::get_id());
                     ++ended;
                   });
  }
  const auto all = [&] { return ended == count; };
  absl::MutexLock lock(&mutex);
  mutex.Await(absl::Condition(&all));
  return threads;
}

TEST(OneCallbackThreadTest, CallbacksRunOnOneThreadWhileItLives) {
  {
    const OneCallbackThread one;
    const bool grpc_has_two = gpr_cpu_num_cores() <= 5;
    EXPECT_LE(CallbackThreads(40).size(), grpc_has_two ? 1u : gpr_cpu_num_cores());
  }
  EXPECT_GE(CallbackThreads(40).size(), 1u);  // and they run when it has gone
}

TEST(OneCallbackThreadTest, CallbacksComeAtOnceAfterQuietSeconds) {
  OneCallbackThread one;
  int quick = 0;
  for (int i = 0; i < 5; ++i) {
    for (int half = 0; half < 2; ++half) {
      one.KeepAwake();
      std::this_thread::sleep_for(std::chrono::milliseconds(530));
    }
    const auto start = std::chrono::steady_clock::now();
    CallbackThreads(1);
    // Without KeepAwake it sleeps for up to 100 ms here. A busy machine may be late at times.
    const auto took = std::chrono::steady_clock::now() - start;
    quick += took < std::chrono::milliseconds(30);
  }
  EXPECT_GE(quick, 3);
}

TEST(OneCallbackThreadTest, ComesAndGoesAgain) {
  for (int i = 0; i < 20; ++i) {
    const OneCallbackThread one;
    EXPECT_GE(CallbackThreads(2).size(), 1u);
  }
}

}  // namespace
}  // namespace docent::server
