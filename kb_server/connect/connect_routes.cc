#include "kb_server/connect/connect_routes.h"

#include <google/protobuf/descriptor.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "kb_server/connect/connect_error.h"
#include "kb_server/connect/connect_reply.h"
#include "kb_server/connect/connect_request.h"

namespace docent::server {
namespace {

namespace pb = google::protobuf;

HttpResponse NoSuchMethod(const pb::ServiceDescriptor& service, const std::string& path) {
  std::string known;
  for (int i = 0; i < service.method_count(); ++i)
    absl::StrAppend(&known, i == 0 ? "" : ", ", service.method(i)->name());
  HttpResponse response = ConnectErrorResponse(
      {grpc::StatusCode::UNIMPLEMENTED,
       absl::StrCat("there is no method at ", path, "; ", service.full_name(), " has ", known)});
  response.status = 404;
  return response;
}

void Call(const ConnectPorts* ports, const pb::MethodDescriptor* method, const ConnectHead& head,
          const std::shared_ptr<HttpExchange>& exchange) {
  const auto cancellation = std::make_shared<Cancellation>();
  exchange->OnGone([cancellation] { cancellation->Cancel(); });
  absl::StatusOr<std::vector<std::string>> messages;
  {
    const WorkerPool::SharedWork shared(ports->workers, cancellation.get());
    messages = ReadConnectMessages(exchange->request(), *method, head, ports->limits, exchange->memory(),
                                   cancellation.get());
  }
  if (!messages.ok()) return RefuseConnect(head, messages.status(), exchange.get());
  const std::weak_ptr<RpcCall> call = ports->calls->Start(
      absl::StrCat("/", method->service()->full_name(), "/", method->name()), *std::move(messages),
      absl::Now() + head.timeout, MakeConnectReply(ports, method, head, exchange), exchange->client());
  exchange->OnGone([call] {
    if (const std::shared_ptr<RpcCall> running = call.lock()) running->Cancel();
  });
}

void Handle(const ConnectPorts* ports, const pb::ServiceDescriptor* service,
            std::shared_ptr<HttpExchange> exchange) {
  const HttpRequest& http = exchange->request();
  const pb::MethodDescriptor* method = service->FindMethodByName(http.path.substr(http.path.rfind('/') + 1));
  if (method == nullptr || http.path != absl::StrCat("/", service->full_name(), "/", method->name()))
    return exchange->Respond(NoSuchMethod(*service, http.path));
  ConnectHead head;
  if (std::optional<HttpResponse> refusal = ReadConnectHead(http, *method, &head))
    return exchange->Respond(*std::move(refusal));
  // What is packed may become a thousand times as much.
  const bool quick = http.body.size() <= kLargeMessageBytes && !head.gzip_request;
  if (ports->workers == nullptr || quick) return Call(ports, method, head, exchange);
  ports->workers->Submit(
      {.run = [ports, method, head, exchange] { Call(ports, method, head, exchange); },
       .refuse = [head, exchange](const absl::Status& why) { RefuseConnect(head, why, exchange.get()); },
       .client = exchange->client()});
}

}  // namespace

void AddConnectRoutes(HttpRoutes* routes, const std::vector<std::string>& services,
                      const ConnectPorts* ports) {
  for (const std::string& name : services) {
    const pb::ServiceDescriptor* service = FindService(name);
    if (service == nullptr) continue;
    const HttpHandler handler = [ports, service](std::shared_ptr<HttpExchange> exchange) {
      Handle(ports, service, std::move(exchange));
    };
    const std::string path = absl::StrCat("/", name, "/*");
    routes->AddAnyEncoding("GET", path, handler);
    routes->AddAnyEncoding("POST", path, handler);
  }
}

}  // namespace docent::server
