#include "kb_server/grpc/grpc_server.h"

#include <google/protobuf/stubs/logging.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/support/server_interceptor.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "docent/v1/replays.grpc.pb.h"
#include "kb_server/door/message_sizes.h"
#include "kb_server/grpc/stream_arrival.h"

namespace docent::server {
namespace {

constexpr int kKeepaliveMs = 60000;
constexpr int kHandshakeMs = 10000;  // from a connection's begin to the first frame of HTTP/2

// What to say to a request that is no message of its type. gRPC itself answers UNIMPLEMENTED without a text to it, which no
// method of ours does (CallbackUnaryHandler in grpcpp/impl/codegen/server_callback_handlers.h).
constexpr char kUnreadable[] =
    "the request is not a message of the type that this method takes: its bytes are damaged or of another "
    "type, or a text in "
    "it is not UTF-8; see the .proto files";

class UnreadableRequest : public grpc::experimental::Interceptor {
 public:
  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    using Point = grpc::experimental::InterceptionHookPoints;
    if (methods->QueryInterceptionHookPoint(Point::PRE_SEND_STATUS)) {
      const grpc::Status status = methods->GetSendStatus();
      if (status.error_code() == grpc::StatusCode::UNIMPLEMENTED && status.error_message().empty())
        methods->ModifySendStatus(grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, kUnreadable));
    }
    methods->Proceed();
  }
};

class UnreadableRequests : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  explicit UnreadableRequests(const MessageGate* gate) : gate_(*gate) {}
  // A method that is not there stays UNIMPLEMENTED.
  grpc::experimental::Interceptor* CreateServerInterceptor(grpc::experimental::ServerRpcInfo* info) override {
    return gate_.TakesOne(info->method()) ? new UnreadableRequest() : nullptr;
  }

 private:
  const MessageGate& gate_;
};

// gRPC unpacks a message whole before it looks at its size: a small one could take all memory. The client is told that
// gzip and deflate are not read, and what it may send.
void RefuseCompression(grpc::ServerBuilder* builder) {
  builder->AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
  for (const auto algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP})
    builder->SetCompressionAlgorithmSupportStatus(algorithm, false);
}

// Of what arrives beside the gate, messages of streams and of gRPC's own services: gRPC takes no more, or ends calls, where it
// holds too much of all of them. Each call of reflection has a thread.
// Streams whose message nobody reads have a window of 64 KiB; gRPC would widen it for quick clients.
void BoundMemory(const Limits& limits, grpc::ServerBuilder* builder) {
  const size_t largest = LargestMessage("docent.v1.Context.AssertStream", limits, kNetworkLimits).bytes;
  builder->SetMaxReceiveMessageSize(static_cast<int>(largest));
  builder->AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, static_cast<int>(kNetworkLimits.grpc_streams));
  builder->AddChannelArgument(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  grpc::ResourceQuota quota("docent");
  quota.Resize(kNetworkLimits.grpc_memory_bytes);
  quota.SetMaxThreads(kNetworkLimits.grpc_reflection_calls);
  builder->SetResourceQuota(quota);
}

}  // namespace

GrpcServer::GrpcServer(const ServicePorts& ports, FleetLeases* leases)
    : context_(ports),
      ontologies_(ports),
      workflows_(ports),
      robot_services_(ports),
      fleet_(ports, leases),
      gate_(ports.limits) {}

absl::StatusOr<std::unique_ptr<GrpcServer>> GrpcServer::Start(const std::string& address, size_t connections,
                                                              const ServicePorts& ports, FleetLeases* leases,
                                                              grpc::Service* replays) {
  absl::StatusOr<std::unique_ptr<GrpcListener>> listener = GrpcListener::Listen(address, connections);
  if (!listener.ok()) return listener.status();
  std::unique_ptr<GrpcServer> server(new GrpcServer(ports, leases));
  server->listener_ = *std::move(listener);
  if (absl::Status status = server->Build(ports.limits, replays); !status.ok()) return status;
  server->listener_->Start();
  return server;
}

absl::Status GrpcServer::Build(const Limits& limits, grpc::Service* replays) {
  google::protobuf::SetLogHandler(nullptr);  // a line for each message that is wrong: its client is told
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  listener_->AddTo(&builder);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);  // a client that vanished is noticed
  BoundMemory(limits, &builder);
  std::vector<std::pair<const char*, grpc::Service*>> services = {
      {v1::Context::service_full_name(), &context_},
      {v1::Ontologies::service_full_name(), &ontologies_},
      {v1::Workflows::service_full_name(), &workflows_},
      {v1::RobotServices::service_full_name(), &robot_services_},
      {v1::Fleet::service_full_name(), &fleet_}};
  if (replays != nullptr) services.emplace_back(v1::Replays::service_full_name(), replays);
  for (const auto& [name, service] : services) {
    const auto* descriptor = google::protobuf::DescriptorPool::generated_pool()->FindServiceByName(name);
    builder.RegisterService(gate_.Guard(service, *descriptor));
  }
  RefuseCompression(&builder);
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> interceptors;
  interceptors.push_back(std::make_unique<UnreadableRequests>(&gate_));
  interceptors.push_back(std::make_unique<StreamArrival>(kNetworkLimits.grpc_arrival_ms));
  builder.experimental().SetInterceptorCreators(std::move(interceptors));
  server_ = builder.BuildAndStart();
  if (server_ == nullptr) return absl::InternalError("the gRPC server does not start");
  for (const auto& [name, service] : services) server_->GetHealthCheckService()->SetServingStatus(name, true);
  return absl::OkStatus();
}

std::vector<std::string> GrpcServer::ServiceNames() {
  return {v1::Context::service_full_name(),   v1::Ontologies::service_full_name(),
          v1::Workflows::service_full_name(), v1::RobotServices::service_full_name(),
          v1::Fleet::service_full_name(),     v1::Replays::service_full_name()};
}

std::shared_ptr<grpc::Channel> GrpcServer::InProcess() {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);  // what the services make is bounded by themselves
  return server_->InProcessChannel(arguments);
}

void GrpcServer::Stop(std::chrono::system_clock::time_point deadline) {
  listener_->Stop();
  gate_.Stop();
  if (server_) server_->Shutdown(deadline);
}

}  // namespace docent::server
