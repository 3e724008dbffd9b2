// Any bytes as what a browser sends: JSON and binary messages, envelopes, WebSocket frames, messages of live connections. What
// is accepted as JSON is written as JSON that means the same.
//
// The first line is "SERVICE/METHOD CONTENT-TYPE [gzip]" or "live"; the rest is the body.
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/stubs/logging.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "docent/v1/context.pb.h"
#include "docent/v1/fleet.pb.h"
#include "docent/v1/ontologies.pb.h"
#include "docent/v1/workflows.pb.h"
#include "graph/rdf/utf8.h"
#include "kb_server/connect/connect_envelope.h"
#include "kb_server/connect/connect_error.h"
#include "kb_server/connect/connect_request.h"
#include "kb_server/live/live_request.h"
#include "kb_server/live/websocket.h"
#include "tests/fuzz/fuzz_check.h"

namespace docent::server {
namespace {

constexpr char kAnyMethod[] = "Context/Assert";

// So that their descriptors are in the program.
void LinkMessages() {
  (void)v1::AssertRequest::descriptor();
  (void)v1::JoinRequest::descriptor();
  (void)v1::LoadRequest::descriptor();
  (void)v1::DeployRequest::descriptor();
}

const google::protobuf::MethodDescriptor& MethodOf(std::string_view name) {
  const size_t slash = name.find('/');
  if (slash != std::string_view::npos) {
    const auto* service = FindService("docent.v1." + std::string(name.substr(0, slash)));
    const auto* method =
        service != nullptr ? service->FindMethodByName(std::string(name.substr(slash + 1))) : nullptr;
    if (method != nullptr) return *method;
  }
  return MethodOf(kAnyMethod);
}

// The codec looks at the bytes' form; the call refuses what its method cannot read, such as texts that are not UTF-8.
bool IsReadable(const google::protobuf::Descriptor& type, const std::string& binary) {
  const google::protobuf::LogSilencer quiet;
  const google::protobuf::Message* prototype =
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(&type);
  return std::unique_ptr<google::protobuf::Message>(prototype->New())->ParseFromString(binary);
}

void CheckMessage(const google::protobuf::Descriptor& type, const std::string& binary) {
  if (!IsReadable(type, binary)) return;
  const absl::StatusOr<std::string> json = FromBinary(type, MessageCodec::kJson, binary);
  fuzz::Require(json.ok(), "an accepted message cannot be written as JSON");
  fuzz::Require(!FindInvalidUtf8(*json), "JSON that is not UTF-8");
  const absl::StatusOr<std::string> back = ToBinary(type, MessageCodec::kJson, *json);
  fuzz::Require(back.ok(), "its own JSON is refused: " + *json);
  const absl::StatusOr<std::string> again = FromBinary(type, MessageCodec::kJson, *back);
  fuzz::Require(again.ok() && *again == *json, "read back otherwise: " + *json);
}

void CheckCall(std::string_view head_line, std::string_view body) {
  HttpRequest http;
  http.method = "POST";
  const size_t blank = head_line.find(' ');
  const auto& method = MethodOf(head_line.substr(0, blank));
  std::string type(blank == std::string_view::npos ? "" : head_line.substr(blank + 1));
  const bool streams = method.client_streaming() || method.server_streaming();
  if (type.ends_with(" gzip")) {
    type.resize(type.size() - 5);
    http.headers.emplace_back(streams ? "connect-content-encoding" : "content-encoding", "gzip");
  }
  http.headers.emplace_back("content-type", type);
  http.body = body;
  ConnectHead head;
  if (const auto refusal = ReadConnectHead(http, method, &head)) {
    fuzz::Require(refusal->status >= 400 && !FindInvalidUtf8(refusal->body), "a refusal that is none");
    return;
  }
  Limits limits;
  limits.http_body_bytes = 1u << 20;
  const absl::StatusOr<std::vector<std::string>> messages = ReadConnectMessages(http, method, head, limits);
  if (!messages.ok()) {
    const grpc::Status status(static_cast<grpc::StatusCode>(messages.status().code()),
                              std::string(messages.status().message()));
    fuzz::Require(!FindInvalidUtf8(ConnectErrorJson(status)), "an error that is not UTF-8");
    return;
  }
  for (const std::string& message : *messages) CheckMessage(*method.input_type(), message);
}

// Whatever the pieces that the bytes come in, the events are the same.
void CheckWebSocket(std::string_view body) {
  WebSocketReader whole(1000), bytewise(1000);
  const auto expected = whole.Read(body);
  std::vector<WebSocketReader::Event> events;
  for (size_t i = 0; i < body.size(); ++i) {
    for (auto& event : bytewise.Read(body.substr(i, 1))) events.push_back(std::move(event));
  }
  fuzz::Require(events.size() == expected.size(), "pieces make other events");
  for (size_t i = 0; i < events.size(); ++i) {
    fuzz::Require(events[i].opcode == expected[i].opcode && events[i].payload == expected[i].payload,
                  "pieces make another event");
    if (events[i].opcode == WebSocketOpcode::kText)
      fuzz::Require(!FindInvalidUtf8(events[i].payload), "a text that is not UTF-8");
  }
}

void CheckOne(std::string_view text) {
  LinkMessages();
  const size_t end = std::min(text.find('\n'), text.size());
  const std::string_view head = text.substr(0, end), body = text.substr(std::min(end + 1, text.size()));
  std::string id;
  const auto request =
      ReadLiveRequest(body, {"docent.v1.Fleet", "docent.v1.Workflows", "docent.v1.Context"}, &id);
  fuzz::Require(!id.empty() && !FindInvalidUtf8(id), "an id that cannot be written");
  if (request.ok() && !request->end) {
    const auto binary = ToBinary(*request->method->input_type(), MessageCodec::kJson, request->request);
    if (binary.ok()) CheckMessage(*request->method->input_type(), *binary);
  }
  CheckWebSocket(body);
  CheckCall(head, body);
}

}  // namespace
}  // namespace docent::server

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  docent::server::CheckOne(std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
}
