// Client that sends the updates of a benchmark over one AssertStream.
#ifndef DOCENT_BENCH_ASSERT_CLIENT_H_
#define DOCENT_BENCH_ASSERT_CLIENT_H_

#include <grpcpp/grpcpp.h>

#include <deque>
#include <memory>

#include "absl/synchronization/mutex.h"
#include "docent/v1/context.grpc.pb.h"

namespace docent::bench {

// Requests go out in order, answers are read as they come; refusals are printed on standard error. One thread
// sends; gRPC's threads call in.
class AssertClient final : public grpc::ClientBidiReactor<v1::AssertRequest, v1::AssertStreamReply> {
 public:
  explicit AssertClient(const std::shared_ptr<grpc::Channel>& channel);
  // Does not block.
  void Send(v1::AssertRequest request);
  // Waits until every request is answered. Once, before the object's end.
  void Finish();

 private:
  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  const std::unique_ptr<v1::Context::Stub> stub_;
  grpc::ClientContext context_;
  v1::AssertStreamReply reply_;
  absl::Mutex mutex_;
  std::deque<v1::AssertRequest> waiting_ ABSL_GUARDED_BY(mutex_);  // the first is being written
  bool closing_ ABSL_GUARDED_BY(mutex_) = false;
  bool done_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace docent::bench

#endif  // DOCENT_BENCH_ASSERT_CLIENT_H_
