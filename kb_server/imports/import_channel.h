// Channel and context of one import. Private to this folder.
#ifndef DOCENT_KB_SERVER_IMPORTS_IMPORT_CHANNEL_H_
#define DOCENT_KB_SERVER_IMPORTS_IMPORT_CHANNEL_H_

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "graph/base/limits.h"
#include "graph/base/workflow_limits.h"

namespace docent::server {

// No proxy of the environment is asked: what may be reached was decided by the address.
inline std::shared_ptr<grpc::Channel> ImportChannel(const std::string& target) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetMaxReceiveMessageSize(static_cast<int>(Limits().grpc_message_bytes));
  return grpc::CreateCustomChannel(target, grpc::InsecureChannelCredentials(), arguments);
}

// Of a call of an import, which ends at its time limit and with `parent`, if there is one.
inline std::unique_ptr<grpc::ClientContext> ImportContext(const grpc::CallbackServerContext* parent) {
  std::unique_ptr<grpc::ClientContext> context =
      parent == nullptr ? std::make_unique<grpc::ClientContext>()
                        : grpc::ClientContext::FromCallbackServerContext(
                              *parent, grpc::PropagationOptions().disable_deadline_propagation());
  context->set_deadline(std::chrono::system_clock::now() +
                        std::chrono::milliseconds(kWorkflowLimits.import_timeout_ms));
  return context;
}

// In one line.
inline absl::Status ImportError(const std::string& target, const grpc::Status& status,
                                const std::string& what) {
  std::string reason = status.error_message();
  reason = reason.substr(0, reason.find('\n')).substr(0, 300);
  switch (status.error_code()) {
    case grpc::StatusCode::UNAVAILABLE:
      return absl::NotFoundError(absl::StrCat("no gRPC server answers at ", target, " (", reason, ")"));
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return absl::DeadlineExceededError(
          absl::StrCat(target, " did not answer in time; the limit import_timeout_ms is ",
                       kWorkflowLimits.import_timeout_ms));
    case grpc::StatusCode::UNIMPLEMENTED:
      return absl::NotFoundError(absl::StrCat("the server at ", target, " ", what));
    default:
      return absl::UnknownError(
          absl::StrCat(target, " answered with an error: ", reason.empty() ? "no reason given" : reason));
  }
}

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_IMPORTS_IMPORT_CHANNEL_H_
