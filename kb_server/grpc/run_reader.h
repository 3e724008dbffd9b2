// Workflow runs as the graph docent:runs has them → messages.
#ifndef DOCENT_KB_SERVER_GRPC_RUN_READER_H_
#define DOCENT_KB_SERVER_GRPC_RUN_READER_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "docent/v1/workflows.pb.h"
#include "graph/store/graph_reader.h"

namespace docent::server {

// False: the graph has no run of this id.
bool ReadRun(const GraphReader& graph, const std::string& id, v1::Run* run);

// Cuts its texts to so many bytes, and where it would not fit into a message, more: listed_bytes of graph/base/text_limits.h.
// Nodes beyond are left out. Run.texts_cut says it.
void FitRun(size_t text_bytes, v1::Run* run);

// A page of the runs that the request asks for, newest first. INVALID_ARGUMENT: an unknown state or page token.
absl::Status ReadRuns(const GraphReader& graph, const v1::ListRunsRequest& request, v1::ListRunsReply* reply);

// How many runs of the workflow have not ended.
uint32_t LiveRunsOf(const GraphReader& graph, const std::string& workflow);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_RUN_READER_H_
