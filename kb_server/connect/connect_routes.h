// The gRPC services over HTTP by the Connect protocol (connectrpc.com/docs/protocol): one bridge for all of their methods, by
// descriptors. POST /docent.v1.Fleet/List with JSON or binary proto, GET for methods that only read, server streams as
// enveloped messages. A method that is new in proto is there without code.
#ifndef DOCENT_KB_SERVER_CONNECT_CONNECT_ROUTES_H_
#define DOCENT_KB_SERVER_CONNECT_CONNECT_ROUTES_H_

#include <string>
#include <vector>

#include "graph/base/limits.h"
#include "kb_server/connect/rpc_call.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/http/http_server.h"

namespace docent::server {

struct ConnectPorts {
  RpcChannel* calls = nullptr;
  WorkerPool* workers = nullptr;  // for large messages; null: none are large
  Limits limits;
};

// `services`: full names, "docent.v1.Fleet". `ports` must outlive the server.
void AddConnectRoutes(HttpRoutes* routes, const std::vector<std::string>& services,
                      const ConnectPorts* ports);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CONNECT_CONNECT_ROUTES_H_
