// Context.Update: a SPARQL Update.
#include <algorithm>
#include <chrono>
#include <utility>

#include "graph/sparql/syntax/parser.h"
#include "kb_server/door/query_memory.h"
#include "kb_server/door/request_memory.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/work/known_prefixes.h"
#include "kb_server/work/update_runner.h"

namespace docent::server {

grpc::ServerUnaryReactor* ContextService::Update(grpc::CallbackServerContext* context,
                                                 const v1::UpdateRequest* request, v1::AssertReply* reply) {
  int timeout_ms = ports_.limits.query_timeout_ms;
  if (request->timeout_ms() > 0) timeout_ms = std::min<int64_t>(timeout_ms, request->timeout_ms());
  auto cancellation = std::make_shared<Cancellation>(std::chrono::milliseconds(timeout_ms));
  const ClientPtr client = ClientOf(*context, ports_.clients);
  const auto work = [this, client, cancellation, request, reply](grpc::ServerUnaryReactor* reactor) {
    const auto known = KnownNames(ports_);
    sparql::ParseOptions options = sparql::ParseOptionsWith(ports_.limits, ports_.functions);
    options.known = known.get();
    UpdateRequest update;
    update.memory = MemoryOfRequest(ports_);
    update.cancellation = cancellation;
    options.memory = update.memory.get();
    options.cancellation = update.cancellation.get();
    sparql::ParsedUpdate parsed;
    {
      const WorkerPool::SharedWork shared(ports_.workers, cancellation.get());
      parsed = sparql::ParseUpdate(request->update(), options);
    }
    if (!parsed.ok()) return reactor->Finish(ToGrpc(ToStatus(parsed, request->update())));
    update.update = std::move(parsed.update);
    update.request_id = request->request_id();
    update.request_digest = RequestDigest("update", {request->update()});
    update.min_revision = Revision(request->min_revision());
    update.client = client;
    update.timeout = absl::FromChrono(cancellation->Left());
    ports_.updates->Submit(std::move(update), [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
      if (outcome.ok()) ToProto(*outcome, reply);
      reactor->Finish(ToGrpc(outcome.status()));
    });
  };
  return OnWorker(ports_, context, cancellation, work);
}

}  // namespace docent::server
