// The gRPC services of proto/docent/v1 as handlers: each turns a message into a batch for the door or into a
// read of the newest version, and the answer into a message. gRPC callback API: handlers return at once; a
// batch is answered by the committer thread when it is durable, a query from a worker. One file an RPC group
// (context_*.cc, ontologies_service.cc, …).
#ifndef DOCENT_KB_SERVER_GRPC_GRPC_SERVICES_H_
#define DOCENT_KB_SERVER_GRPC_GRPC_SERVICES_H_

#include <grpcpp/grpcpp.h>

#include <memory>
#include <string>
#include <vector>

#include "docent/v1/context.grpc.pb.h"
#include "docent/v1/fleet.grpc.pb.h"
#include "docent/v1/ontologies.grpc.pb.h"
#include "docent/v1/robot_services.grpc.pb.h"
#include "docent/v1/workflows.grpc.pb.h"
#include "kb_server/door/ports.h"
#include "kb_server/grpc/adapter_probes.h"
#include "kb_server/robots/fleet_leases.h"
#include "kb_server/robots/reservations.h"

namespace docent::server {

class ContextService final : public v1::Context::CallbackService {
 public:
  explicit ContextService(const ServicePorts& ports) : ports_(ports) {}
  grpc::ServerUnaryReactor* Assert(grpc::CallbackServerContext* context, const v1::AssertRequest* request,
                                   v1::AssertReply* reply) override;
  grpc::ServerBidiReactor<v1::AssertRequest, v1::AssertStreamReply>* AssertStream(
      grpc::CallbackServerContext* context) override;
  grpc::ServerWriteReactor<v1::QueryReply>* Query(grpc::CallbackServerContext* context,
                                                  const v1::QueryRequest* request) override;
  grpc::ServerUnaryReactor* Update(grpc::CallbackServerContext* context, const v1::UpdateRequest* request,
                                   v1::AssertReply* reply) override;
  grpc::ServerUnaryReactor* Explain(grpc::CallbackServerContext* context, const v1::ExplainRequest* request,
                                    v1::ExplainReply* reply) override;
  grpc::ServerUnaryReactor* WhatIf(grpc::CallbackServerContext* context, const v1::WhatIfRequest* request,
                                   v1::WhatIfReply* reply) override;
  grpc::ServerWriteReactor<v1::SubscribeReply>* Subscribe(grpc::CallbackServerContext* context,
                                                          const v1::SubscribeRequest* request) override;
  grpc::ServerBidiReactor<v1::SubscribeStreamRequest, v1::SubscribeStreamReply>* SubscribeStream(
      grpc::CallbackServerContext* context) override;
  grpc::ServerUnaryReactor* Status(grpc::CallbackServerContext* context, const v1::StatusRequest* request,
                                   v1::StatusReply* reply) override;

 private:
  const ServicePorts& ports_;
};

class OntologiesService final : public v1::Ontologies::CallbackService {
 public:
  explicit OntologiesService(const RunPorts& ports) : ports_(ports) {}
  grpc::ServerUnaryReactor* Load(grpc::CallbackServerContext* context, const v1::LoadRequest* request,
                                 v1::LoadReply* reply) override;
  grpc::ServerUnaryReactor* Check(grpc::CallbackServerContext* context, const v1::LoadRequest* request,
                                  v1::CheckModuleReply* reply) override;
  grpc::ServerUnaryReactor* Validate(grpc::CallbackServerContext* context, const v1::ValidateRequest* request,
                                     v1::ValidateReply* reply) override;
  grpc::ServerUnaryReactor* List(grpc::CallbackServerContext* context,
                                 const v1::ListOntologiesRequest* request,
                                 v1::ListOntologiesReply* reply) override;
  grpc::ServerUnaryReactor* Prefixes(grpc::CallbackServerContext* context, const v1::PrefixesRequest* request,
                                     v1::PrefixesReply* reply) override;
  grpc::ServerUnaryReactor* Remove(grpc::CallbackServerContext* context,
                                   const v1::RemoveOntologyRequest* request, v1::LoadReply* reply) override;
  grpc::ServerUnaryReactor* PreviewRules(grpc::CallbackServerContext* context,
                                         const v1::PreviewRulesRequest* request,
                                         v1::PreviewRulesReply* reply) override;

 private:
  const RunPorts& ports_;
};

class WorkflowsService final : public v1::Workflows::CallbackService {
 public:
  explicit WorkflowsService(const RunPorts& ports) : ports_(ports) {}
  grpc::ServerUnaryReactor* Check(grpc::CallbackServerContext* context, const v1::CheckRequest* request,
                                  v1::CheckReply* reply) override;
  grpc::ServerUnaryReactor* Deploy(grpc::CallbackServerContext* context, const v1::DeployRequest* request,
                                   v1::DeployReply* reply) override;
  grpc::ServerUnaryReactor* List(grpc::CallbackServerContext* context,
                                 const v1::ListWorkflowsRequest* request,
                                 v1::ListWorkflowsReply* reply) override;
  grpc::ServerUnaryReactor* Undeploy(grpc::CallbackServerContext* context, const v1::UndeployRequest* request,
                                     v1::UndeployReply* reply) override;
  grpc::ServerUnaryReactor* SetEnabled(grpc::CallbackServerContext* context,
                                       const v1::SetEnabledRequest* request, v1::Workflow* reply) override;
  grpc::ServerUnaryReactor* ListVersions(grpc::CallbackServerContext* context,
                                         const v1::ListVersionsRequest* request,
                                         v1::ListVersionsReply* reply) override;
  grpc::ServerUnaryReactor* Start(grpc::CallbackServerContext* context, const v1::StartRequest* request,
                                  v1::StartReply* reply) override;
  grpc::ServerUnaryReactor* Get(grpc::CallbackServerContext* context, const v1::GetRunRequest* request,
                                v1::Run* reply) override;
  grpc::ServerUnaryReactor* ListRuns(grpc::CallbackServerContext* context, const v1::ListRunsRequest* request,
                                     v1::ListRunsReply* reply) override;
  grpc::ServerWriteReactor<v1::RunEvent>* Watch(grpc::CallbackServerContext* context,
                                                const v1::WatchRequest* request) override;
  grpc::ServerUnaryReactor* Cancel(grpc::CallbackServerContext* context, const v1::CancelRunRequest* request,
                                   v1::Run* reply) override;
  grpc::ServerUnaryReactor* Pause(grpc::CallbackServerContext* context, const v1::PauseRequest* request,
                                  v1::PauseReply* reply) override;
  grpc::ServerUnaryReactor* Resume(grpc::CallbackServerContext* context, const v1::ResumeRequest* request,
                                   v1::ResumeReply* reply) override;
  grpc::ServerUnaryReactor* Settle(grpc::CallbackServerContext* context, const v1::SettleRequest* request,
                                   v1::Run* reply) override;
  grpc::ServerUnaryReactor* SetVariable(grpc::CallbackServerContext* context,
                                        const v1::SetVariableRequest* request, v1::Run* reply) override;
  grpc::ServerUnaryReactor* Explain(grpc::CallbackServerContext* context,
                                    const v1::ExplainRunRequest* request,
                                    v1::ExplainRunReply* reply) override;

 private:
  const RunPorts& ports_;
};

class RobotServicesService final : public v1::RobotServices::CallbackService {
 public:
  explicit RobotServicesService(const RunPorts& ports) : ports_(ports) {}
  grpc::ServerUnaryReactor* Register(grpc::CallbackServerContext* context, const v1::RegisterRequest* request,
                                     v1::RegisterReply* reply) override;
  grpc::ServerUnaryReactor* Check(grpc::CallbackServerContext* context, const v1::RegisterRequest* request,
                                  v1::RegisterReply* reply) override;
  grpc::ServerUnaryReactor* Remove(grpc::CallbackServerContext* context,
                                   const v1::RemoveServicesRequest* request,
                                   v1::RemoveServicesReply* reply) override;
  grpc::ServerUnaryReactor* ListVersions(grpc::CallbackServerContext* context,
                                         const v1::ListServiceVersionsRequest* request,
                                         v1::ListVersionsReply* reply) override;
  grpc::ServerUnaryReactor* Generate(grpc::CallbackServerContext* context, const v1::GenerateRequest* request,
                                     v1::GenerateReply* reply) override;
  grpc::ServerUnaryReactor* ImportTemplates(grpc::CallbackServerContext* context,
                                            const v1::ImportTemplatesRequest* request,
                                            v1::ImportTemplatesReply* reply) override;
  grpc::ServerUnaryReactor* List(grpc::CallbackServerContext* context, const v1::ListServicesRequest* request,
                                 v1::ListServicesReply* reply) override;
  grpc::ServerUnaryReactor* Describe(grpc::CallbackServerContext* context,
                                     const v1::DescribeServiceRequest* request,
                                     v1::RobotService* reply) override;
  grpc::ServerWriteReactor<v1::InvokeServiceReply>* Invoke(grpc::CallbackServerContext* context,
                                                           const v1::InvokeServiceRequest* request) override;

 private:
  const RunPorts& ports_;
};

void ToProto(const engine::Reservation& reservation, v1::RobotReservation* out);

class FleetService final : public v1::Fleet::CallbackService {
 public:
  FleetService(const WritePorts& ports, FleetLeases* leases) : ports_(ports), leases_(*leases) {}
  grpc::ServerUnaryReactor* Join(grpc::CallbackServerContext* context, const v1::JoinRequest* request,
                                 v1::JoinReply* reply) override;
  grpc::ServerUnaryReactor* Leave(grpc::CallbackServerContext* context, const v1::LeaveRequest* request,
                                  v1::LeaveReply* reply) override;
  grpc::ServerUnaryReactor* List(grpc::CallbackServerContext* context, const v1::ListRobotsRequest* request,
                                 v1::ListRobotsReply* reply) override;
  grpc::ServerUnaryReactor* TakeOutOfService(grpc::CallbackServerContext* context,
                                             const v1::TakeOutOfServiceRequest* request,
                                             v1::ServiceStateReply* reply) override;
  grpc::ServerUnaryReactor* PutInService(grpc::CallbackServerContext* context,
                                         const v1::PutInServiceRequest* request,
                                         v1::ServiceStateReply* reply) override;
  grpc::ServerUnaryReactor* Reserve(grpc::CallbackServerContext* context, const v1::ReserveRequest* request,
                                    v1::ReserveReply* reply) override;
  grpc::ServerUnaryReactor* Release(grpc::CallbackServerContext* context, const v1::ReleaseRequest* request,
                                    v1::ReleaseReply* reply) override;

 private:
  // Another adapter, at `speaker`, speaks for the robot, as its lease says; `gone`: surely nothing is there any more.
  void ClaimFrom(const std::string& speaker, bool gone, grpc::ServerUnaryReactor* reactor,
                 const v1::JoinRequest& request, v1::JoinReply* reply);
  void Accept(grpc::ServerUnaryReactor* reactor, const v1::JoinRequest& request, v1::JoinReply* reply);

  const WritePorts& ports_;
  FleetLeases& leases_;
  AdapterProbes probes_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_GRPC_SERVICES_H_
