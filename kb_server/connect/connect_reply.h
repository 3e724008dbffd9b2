// The answer of one call over HTTP: a sink that writes what the call says as Connect has it. Private to this folder.
#ifndef DOCENT_KB_SERVER_CONNECT_CONNECT_REPLY_H_
#define DOCENT_KB_SERVER_CONNECT_CONNECT_REPLY_H_

#include <memory>

#include "kb_server/connect/connect_request.h"
#include "kb_server/connect/connect_routes.h"
#include "kb_server/http/http_exchange.h"

namespace docent::server {

// Messages beyond are converted by a worker: the threads of the network and of gRPC serve others meanwhile.
constexpr size_t kLargeMessageBytes = 64u << 10;

// `head` is that of the request.
std::shared_ptr<RpcSink> MakeConnectReply(const ConnectPorts* ports,
                                          const google::protobuf::MethodDescriptor* method,
                                          const ConnectHead& head, std::shared_ptr<HttpExchange> exchange);

// The answer to a request whose body is not good: `status`, as a stream has it or as a unary call.
void RefuseConnect(const ConnectHead& head, const absl::Status& status, HttpExchange* exchange);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CONNECT_CONNECT_REPLY_H_
