// Memory of one query, update or graph: it counts from the text to the answer, with the limits of the request and of all.
#ifndef DOCENT_KB_SERVER_DOOR_QUERY_MEMORY_H_
#define DOCENT_KB_SERVER_DOOR_QUERY_MEMORY_H_

#include <memory>

#include "graph/base/memory_budget.h"
#include "kb_server/door/ports.h"

namespace docent::server {

// `ports.query_memory` must outlive it.
inline std::shared_ptr<MemoryUse> MemoryOfRequest(const ReadPorts& ports) {
  return std::make_shared<MemoryUse>(ports.limits.query_memory_bytes, ports.query_memory);
}

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_QUERY_MEMORY_H_
