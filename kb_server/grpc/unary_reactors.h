// Reactors of unary calls.
#ifndef DOCENT_KB_SERVER_GRPC_UNARY_REACTORS_H_
#define DOCENT_KB_SERVER_GRPC_UNARY_REACTORS_H_

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <utility>

#include "graph/base/cancellation.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {

// Of a call that is answered at once.
inline grpc::ServerUnaryReactor* FinishNow(grpc::CallbackServerContext* context, const grpc::Status& status) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(status);
  return reactor;
}

// Of a call whose answer takes more than moments, for which gRPC's callback thread has others to serve: `work`, which
// finishes the reactor, runs on a worker. RESOURCE_EXHAUSTED if too much waits.
inline grpc::ServerUnaryReactor* OnWorker(grpc::ServerUnaryReactor* reactor, WorkerPool* workers,
                                          std::function<void(grpc::ServerUnaryReactor*)> work) {
  const absl::Status accepted = workers->Submit([reactor, work = std::move(work)] { work(reactor); });
  if (!accepted.ok()) reactor->Finish(ToGrpc(accepted));
  return reactor;
}

// Of a call whose work stops when the caller goes away. Deletes itself when gRPC is done with it.
class CancellableReactor final : public grpc::ServerUnaryReactor {
 public:
  explicit CancellableReactor(std::shared_ptr<Cancellation> cancellation)
      : cancellation_(std::move(cancellation)) {}
  void OnCancel() override { cancellation_->Cancel(); }
  void OnDone() override { delete this; }

 private:
  const std::shared_ptr<Cancellation> cancellation_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_UNARY_REACTORS_H_
