// Reactors of unary calls.
#ifndef DOCENT_KB_SERVER_GRPC_UNARY_REACTORS_H_
#define DOCENT_KB_SERVER_GRPC_UNARY_REACTORS_H_

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <string_view>
#include <utility>

#include "graph/base/cancellation.h"
#include "graph/base/ids.h"
#include "kb_server/door/await_version.h"
#include "kb_server/door/followed_reads.h"
#include "kb_server/door/ports.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/grpc/client_of.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {

// Of a call that is answered at once.
inline grpc::ServerUnaryReactor* FinishNow(grpc::CallbackServerContext* context, const grpc::Status& status) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(status);
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

// The trace that a call within this process fills; null: none.
inline std::shared_ptr<ReadTrace> TraceOf(const grpc::CallbackServerContext& context,
                                          FollowedReads* followed) {
  const auto named = context.client_metadata().find(kTraceKey);
  if (followed == nullptr || named == context.client_metadata().end()) return nullptr;
  if (IsOverNetwork(context.peer())) return nullptr;
  return followed->Find(std::string_view(named->second.data(), named->second.size()));
}

// What `read` says, which reads the newest version and the catalog on this thread and rests on nothing else of the server. A clock
// that it looks at is noted by it (ReadTrace::NoteAnything).
template <typename Read>
auto Traced(ReadTrace* trace, Read read) {
  const ReadTrace::Scope scope(trace);
  auto status = read();
  if (trace != nullptr) trace->SetWhole();
  return status;
}

// Work of a unary call, which finishes the reactor.
using UnaryWork = std::function<void(grpc::ServerUnaryReactor*)>;

// Of a call whose answer takes more than moments, for which gRPC's callback thread has others to serve: `work` runs on a
// worker. It is short, or ends by itself.
inline grpc::ServerUnaryReactor* OnWorker(const ReadPorts& ports, grpc::CallbackServerContext* context,
                                          UnaryWork work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports.workers->Submit({.run = [reactor, work = std::move(work)] { work(reactor); },
                         .refuse = [reactor](const absl::Status& why) { reactor->Finish(ToGrpc(why)); },
                         .client = ClientOf(*context, ports.clients)});
  return reactor;
}

// The same for work that stops by `cancellation`, which has its time limit. It begins when there is a version that is at least
// `revision`.
inline grpc::ServerUnaryReactor* OnWorker(const ReadPorts& ports, grpc::CallbackServerContext* context,
                                          std::shared_ptr<Cancellation> cancellation, UnaryWork work,
                                          Revision revision = Revision()) {
  auto* reactor = new CancellableReactor(cancellation);
  const absl::Time until = absl::Now() + absl::FromChrono(cancellation->Left());
  SubmitOnVersion(ports, revision,
                  {.run = [reactor, work = std::move(work)] { work(reactor); },
                   .refuse = [reactor](const absl::Status& why) { reactor->Finish(ToGrpc(why)); },
                   .client = ClientOf(*context, ports.clients),
                   .until = until,
                   .cancellation = std::move(cancellation)});
  return reactor;
}

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_UNARY_REACTORS_H_
