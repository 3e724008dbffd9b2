#include "robot_adapters/sdk/server_link.h"

#include <grpcpp/grpcpp.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/wire/term_proto.h"

namespace docent::robot {
namespace {

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address) {
  grpc::ChannelArguments arguments;
  // A robot should notice within a second or two that the server is back.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 5000);  // this long one attempt to connect may take
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

absl::Status FromGrpc(const grpc::Status& status) {
  if (status.ok()) return absl::OkStatus();
  return absl::Status(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
}

}  // namespace

// A call in flight, known to the link so that Shutdown reaches it.
class ServerLink::Call {
 public:
  Call(ServerLink* link, absl::Duration timeout) : link_(link) {
    context_.set_deadline(absl::ToChronoTime(absl::Now() + timeout));
    absl::MutexLock lock(&link_->mutex_);
    if (link_->shut_down_) context_.TryCancel();
    link_->calls_.insert(&context_);
  }
  ~Call() {
    absl::MutexLock lock(&link_->mutex_);
    link_->calls_.erase(&context_);
  }
  grpc::ClientContext* context() { return &context_; }

 private:
  ServerLink* const link_;
  grpc::ClientContext context_;
};

ServerLink::ServerLink(const std::string& address) {
  auto channel = MakeChannel(address);
  context_ = v1::Context::NewStub(channel);
  fleet_ = v1::Fleet::NewStub(channel);
}

absl::Status ServerLink::Assert(const v1::AssertRequest& request, v1::AssertReply* reply,
                                absl::Duration timeout) {
  Call call(this, timeout);
  return FromGrpc(context_->Assert(call.context(), request, reply));
}

absl::Status ServerLink::Join(const v1::JoinRequest& request, v1::JoinReply* reply, absl::Duration timeout) {
  Call call(this, timeout);
  return FromGrpc(fleet_->Join(call.context(), request, reply));
}

absl::Status ServerLink::Leave(const v1::LeaveRequest& request, v1::LeaveReply* reply,
                               absl::Duration timeout) {
  Call call(this, timeout);
  return FromGrpc(fleet_->Leave(call.context(), request, reply));
}

absl::StatusOr<QueryAnswer> ServerLink::Query(const std::string& sparql, absl::Duration timeout,
                                              uint64_t min_revision) {
  Call call(this, timeout);
  v1::QueryRequest request;
  request.set_query(sparql);
  request.set_min_revision(min_revision);
  request.set_timeout_ms(static_cast<uint32_t>(absl::ToInt64Milliseconds(timeout)));
  QueryAnswer answer;
  auto stream = context_->Query(call.context(), request);
  for (v1::QueryReply reply; stream->Read(&reply);) {
    if (reply.has_header()) {
      answer.variables.assign(reply.header().variables().begin(), reply.header().variables().end());
      answer.boolean = reply.header().boolean();
      answer.revision = reply.header().revision();
    } else if (reply.has_row()) {
      auto& row = answer.rows.emplace_back();
      for (const v1::Term& value : reply.row().values()) row.push_back(FromProto(value));
      row.resize(answer.variables.size());
    }
  }
  if (absl::Status status = FromGrpc(stream->Finish()); !status.ok()) return status;
  return answer;
}

void ServerLink::Shutdown() {
  absl::MutexLock lock(&mutex_);
  shut_down_ = true;
  for (grpc::ClientContext* context : calls_) context->TryCancel();
}

}  // namespace docent::robot
