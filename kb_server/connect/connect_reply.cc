#include "kb_server/connect/connect_reply.h"

#include <google/protobuf/descriptor.h>

#include <functional>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/gzip.h"
#include "graph/base/text.h"
#include "kb_server/connect/connect_envelope.h"
#include "kb_server/connect/connect_error.h"

namespace docent::server {
namespace {

constexpr size_t kWorthPacking = 1024;  // bytes

grpc::Status ToGrpcStatus(const absl::Status& status) {
  return {static_cast<grpc::StatusCode>(status.code()), std::string(status.message())};
}

// Runs `work` now where `bytes` are few, on a worker otherwise.
void RunWhereThereIsTime(WorkerPool* workers, size_t bytes, Work work) {
  if (workers == nullptr || bytes <= kLargeMessageBytes) return work.run();
  workers->Submit(std::move(work));
}

class UnaryReply final : public RpcSink, public std::enable_shared_from_this<UnaryReply> {
 public:
  UnaryReply(const ConnectPorts* ports, const google::protobuf::MethodDescriptor* method,
             const ConnectHead& head, std::shared_ptr<HttpExchange> exchange)
      : ports_(*ports), method_(*method), head_(head), exchange_(std::move(exchange)) {}

  void OnMessage(std::string bytes, const std::shared_ptr<RpcCall>& call) override {
    message_ = std::move(bytes);
    call->Next();
  }
  void OnEnd(const grpc::Status& status) override {
    if (!status.ok()) return exchange_->Respond(ConnectErrorResponse(status));
    if (!message_)
      return exchange_->Respond(
          ConnectErrorResponse({grpc::StatusCode::INTERNAL, "the call ended without an answer"}));
    RunWhereThereIsTime(ports_.workers, message_->size(),
                        {.run = [self = shared_from_this()] { self->Answer(); },
                         .refuse =
                             [exchange = exchange_](const absl::Status& why) {
                               exchange->Respond(ConnectErrorResponse(ToGrpcStatus(why)));
                             },
                         .client = exchange_->client()});
  }

 private:
  void Answer() {
    absl::StatusOr<std::string> body = FromBinary(*method_.output_type(), head_.codec, *std::move(message_));
    if (!body.ok()) return exchange_->Respond(ConnectErrorResponse(ToGrpcStatus(body.status())));
    HttpResponse response;
    response.content_type = head_.ContentType();
    response.headers = {{"Cache-Control", "no-cache"}, {"Vary", "Accept-Encoding"}};
    if (head_.gzip_reply && body->size() >= kWorthPacking) {
      response.headers.emplace_back("Content-Encoding", "gzip");
      *body = Gzip(*body);
    }
    response.body = *std::move(body);
    exchange_->Respond(std::move(response));
  }

  const ConnectPorts& ports_;
  const google::protobuf::MethodDescriptor& method_;
  const ConnectHead head_;
  const std::shared_ptr<HttpExchange> exchange_;
  std::optional<std::string> message_;
};

HttpResponse StreamHead(const ConnectHead& head) {
  HttpResponse response;
  response.content_type = head.ContentType();
  response.headers = {{"Cache-Control", "no-cache"}};
  if (head.gzip_reply) response.headers.emplace_back("Connect-Content-Encoding", "gzip");
  return response;
}

std::string EndOfStream(const grpc::Status& status) {
  return Enveloped(kEndStreamFlag, status.ok() ? "{}" : Concat("{\"error\":", ConnectErrorJson(status), "}"));
}

class StreamReply final : public RpcSink, public std::enable_shared_from_this<StreamReply> {
 public:
  StreamReply(const ConnectPorts* ports, const google::protobuf::MethodDescriptor* method,
              const ConnectHead& head, std::shared_ptr<HttpExchange> exchange)
      : ports_(*ports), method_(*method), head_(head), exchange_(std::move(exchange)) {}

  void OnHead() override { exchange_->Begin(StreamHead(head_)); }
  void OnMessage(std::string bytes, const std::shared_ptr<RpcCall>& call) override {
    const size_t size = bytes.size();
    RunWhereThereIsTime(
        ports_.workers, size,
        {.run = [self = shared_from_this(), bytes = std::move(bytes),
                 call]() mutable { self->Send(std::move(bytes), call); },
         .refuse = [self = shared_from_this(), call](const absl::Status& why) { self->Fail(why, call); },
         .client = exchange_->client()});
  }
  void OnEnd(const grpc::Status& status) override {
    exchange_->Begin(StreamHead(head_));  // unless it has begun
    exchange_->Push(EndOfStream(failure_.ok() ? status : failure_));
    exchange_->End();
  }

 private:
  void Send(std::string bytes, const std::shared_ptr<RpcCall>& call) {
    absl::StatusOr<std::string> message = FromBinary(*method_.output_type(), head_.codec, std::move(bytes));
    if (!message.ok()) return Fail(message.status(), call);
    const bool packed = head_.gzip_reply && message->size() >= kWorthPacking;
    exchange_->Push(packed ? Enveloped(kCompressedFlag, Gzip(*message)) : Enveloped(0, *message));
    exchange_->OnRoom([waiting = std::weak_ptr<RpcCall>(call)] {
      if (const std::shared_ptr<RpcCall> there = waiting.lock()) there->Next();
    });
  }
  void Fail(const absl::Status& status, const std::shared_ptr<RpcCall>& call) {
    failure_ = ToGrpcStatus(status);
    call->Cancel();
  }

  const ConnectPorts& ports_;
  const google::protobuf::MethodDescriptor& method_;
  const ConnectHead head_;
  const std::shared_ptr<HttpExchange> exchange_;
  grpc::Status failure_;  // of the bridge
};

}  // namespace

std::shared_ptr<RpcSink> MakeConnectReply(const ConnectPorts* ports,
                                          const google::protobuf::MethodDescriptor* method,
                                          const ConnectHead& head, std::shared_ptr<HttpExchange> exchange) {
  if (head.stream) return std::make_shared<StreamReply>(ports, method, head, std::move(exchange));
  return std::make_shared<UnaryReply>(ports, method, head, std::move(exchange));
}

void RefuseConnect(const ConnectHead& head, const absl::Status& status, HttpExchange* exchange) {
  if (!head.stream) return exchange->Respond(ConnectErrorResponse(ToGrpcStatus(status)));
  HttpResponse response = StreamHead(head);
  response.body = EndOfStream(ToGrpcStatus(status));
  exchange->Respond(std::move(response));
}

}  // namespace docent::server
