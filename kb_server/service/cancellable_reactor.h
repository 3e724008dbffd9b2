// The reactor of a unary call whose work stops when the caller goes away. Deletes itself when gRPC is done with it.
#ifndef DOCENT_KB_SERVER_SERVICE_CANCELLABLE_REACTOR_H_
#define DOCENT_KB_SERVER_SERVICE_CANCELLABLE_REACTOR_H_

#include <grpcpp/grpcpp.h>

#include <memory>
#include <utility>

#include "kb_server/base/cancellation.h"

namespace docent {

class CancellableReactor final : public grpc::ServerUnaryReactor {
 public:
  explicit CancellableReactor(std::shared_ptr<Cancellation> cancellation) : cancellation_(std::move(cancellation)) {}
  void OnCancel() override { cancellation_->Cancel(); }
  void OnDone() override { delete this; }

 private:
  const std::shared_ptr<Cancellation> cancellation_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_SERVICE_CANCELLABLE_REACTOR_H_
