// Workflow runs as the graph docent:runs has them → messages.
#ifndef DOCENT_KB_SERVER_GRPC_RUN_READER_H_
#define DOCENT_KB_SERVER_GRPC_RUN_READER_H_

#include <string>
#include <vector>

#include "docent/v1/workflows.pb.h"
#include "graph/store/graph_reader.h"

namespace docent::server {

// False: the graph has no run of this id.
bool ReadRun(const GraphReader& graph, const std::string& id, v1::Run* run);

// Ids of all runs, oldest first.
std::vector<std::string> RunIds(const GraphReader& graph, bool live_only);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_RUN_READER_H_
