// What a why-not does not offer: changes that would violate a shape of the server. Any thread.
#ifndef DOCENT_KB_SERVER_GRPC_POSSIBLE_CHANGES_H_
#define DOCENT_KB_SERVER_GRPC_POSSIBLE_CHANGES_H_

#include "graph/base/cancellation.h"
#include "kb_server/door/history_port.h"
#include "kb_server/door/ports.h"
#include "reasoner/explain/why_not.h"

namespace docent::server {

// By the shapes and rules that `graph` has. `ports`, `graph` and `cancellation` must outlive the result.
explain::MayChange MayChangeOf(const RunPorts& ports, const QueryGraph& graph, Cancellation* cancellation);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_POSSIBLE_CHANGES_H_
