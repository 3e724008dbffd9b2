// The gRPC service RobotAdapter (proto/docent/v1/robot_adapter.proto) on top of a command table.
// Callback API: no thread waits for a stream. gRPC calls it from its threads.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_ADAPTER_SERVICE_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_ADAPTER_SERVICE_H_

#include "docent/v1/robot_adapter.grpc.pb.h"
#include "robot_adapters/sdk/command_table.h"

namespace docent::robot {

class AdapterService final : public v1::RobotAdapter::CallbackService {
 public:
  // `commands` must outlive the service.
  AdapterService(v1::RobotDescription description, CommandTable* commands)
      : description_(std::move(description)), commands_(commands) {}

  grpc::ServerUnaryReactor* Describe(grpc::CallbackServerContext* context, const v1::DescribeRequest* request,
                                     v1::RobotDescription* reply) override;
  grpc::ServerWriteReactor<v1::Feedback>* Invoke(grpc::CallbackServerContext* context,
                                                 const v1::InvokeRequest* request) override;
  grpc::ServerUnaryReactor* Cancel(grpc::CallbackServerContext* context, const v1::CancelRequest* request,
                                   v1::CancelReply* reply) override;
  grpc::ServerWriteReactor<v1::Feedback>* Attach(grpc::CallbackServerContext* context,
                                                 const v1::AttachRequest* request) override;

 private:
  const v1::RobotDescription description_;
  CommandTable* const commands_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_ADAPTER_SERVICE_H_
