// The gRPC server: its services, its listener, health and reflection.
#ifndef DOCENT_KB_SERVER_GRPC_GRPC_SERVER_H_
#define DOCENT_KB_SERVER_GRPC_GRPC_SERVER_H_

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "kb_server/grpc/grpc_listener.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/message_gate.h"

namespace docent::server {

class GrpcServer {
 public:
  // Serves at `address`, see GrpcListener::Listen; at most `connections` at one time. All pointers and `ports` must
  // outlive it. `replays`: the service Replays, of a folder above; null: it is not served.
  static absl::StatusOr<std::unique_ptr<GrpcServer>> Start(const std::string& address, size_t connections,
                                                           const ServicePorts& ports, FleetLeases* leases,
                                                           grpc::Service* replays = nullptr);
  // No new connections and calls from now on; those that are under way may go on until `deadline`.
  void Stop(std::chrono::system_clock::time_point deadline);

  // Full names of its services, "docent.v1.Fleet", but for health and reflection.
  static std::vector<std::string> ServiceNames();
  // To call it without a network.
  std::shared_ptr<grpc::Channel> InProcess();

  GrpcListener& listener() { return *listener_; }
  const MessageGate& gate() const { return gate_; }

 private:
  GrpcServer(const ServicePorts& ports, FleetLeases* leases);
  absl::Status Build(const Limits& limits, grpc::Service* replays);

  ContextService context_;
  OntologiesService ontologies_;
  WorkflowsService workflows_;
  RobotServicesService robot_services_;
  FleetService fleet_;
  MessageGate gate_;
  std::unique_ptr<GrpcListener> listener_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_GRPC_SERVER_H_
