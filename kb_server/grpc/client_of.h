// The client of a call: its connection, or the client that a bridge of this process calls for.
#ifndef DOCENT_KB_SERVER_GRPC_CLIENT_OF_H_
#define DOCENT_KB_SERVER_GRPC_CLIENT_OF_H_

#include <grpcpp/grpcpp.h>

#include <string_view>

#include "kb_server/door/client.h"

namespace docent::server {

// Whether a call came over a connection. gRPC gives calls within this process another peer, or none.
bool IsOverNetwork(std::string_view peer);

// Null where `clients` is null. What a call over a network says of its client counts for nothing.
ClientPtr ClientOf(const grpc::CallbackServerContext& context, Clients* clients);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_CLIENT_OF_H_
