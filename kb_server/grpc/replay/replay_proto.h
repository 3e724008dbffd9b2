// Replays ↔ messages. Pure functions; any thread.
#ifndef DOCENT_KB_SERVER_GRPC_REPLAY_REPLAY_PROTO_H_
#define DOCENT_KB_SERVER_GRPC_REPLAY_REPLAY_PROTO_H_

#include <string>

#include "absl/status/statusor.h"
#include "docent/v1/replays.pb.h"
#include "kb_server/replay/run_replays.h"

namespace docent::server {

void ToProto(const Replayed& replayed, v1::ReplayReply* reply);
void ToProto(const Trial& trial, const std::string& node, v1::TryNodeReply* reply);
void ToProto(const Simulation& simulation, v1::SimulateReply* reply);
// INVALID_ARGUMENT naming the place. Without time and flow of time.
absl::StatusOr<SimulationRequest> FromProto(const v1::SimulateRequest& request, const Limits& limits);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_REPLAY_REPLAY_PROTO_H_
