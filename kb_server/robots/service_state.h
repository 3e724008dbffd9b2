// Robots that are taken out of service: docent:outOfService, which operators tell. Any thread.
#ifndef DOCENT_KB_SERVER_ROBOTS_SERVICE_STATE_H_
#define DOCENT_KB_SERVER_ROBOTS_SERVICE_STATE_H_

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_reader.h"
#include "graph/store/graph_version.h"
#include "graph/store/write_batch.h"

namespace docent::server {

// Adds to `batch` what takes the robot out of service (`reason`: why, for people; empty: the one that it has been out for, if it is
// out already) or puts it in service again (nullopt).
// NOT_FOUND: the graph has no such robot.
absl::Status SetServiceState(const std::string& robot, const std::optional<std::string>& reason,
                             const Dictionary& dictionary, const GraphVersion& graph, WriteBatch* batch);

// Why the robot is out of service, for people; nullopt: it is in service.
std::optional<std::string> OutOfServiceReason(const GraphReader& graph, const std::string& robot);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_ROBOTS_SERVICE_STATE_H_
