#include "kb_server/door/message_sizes.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::server {
namespace {

constexpr size_t kBesideText = 1u << 20;  // of a message that brings a text
constexpr size_t kJsonFactor = 2;         // a character of three bytes is \uXXXX

}  // namespace

const std::vector<std::string_view>& DocumentMethods() {
  static const std::vector<std::string_view> kMethods = {
      "docent.v1.Context.Assert",
      "docent.v1.Context.AssertStream",
      "docent.v1.Ontologies.Load",
      "docent.v1.Ontologies.Check",
      "docent.v1.Ontologies.Validate",
      "docent.v1.Ontologies.PreviewRules",
      "docent.v1.Workflows.Check",
      "docent.v1.Workflows.Deploy",
      "docent.v1.RobotServices.Register",
      "docent.v1.RobotServices.Check",
      "docent.v1.RobotServices.ImportTemplates",
      "docent.v1.Replays.Replay",
      "docent.v1.Replays.TryNode",
      "docent.v1.Replays.Simulate",
  };
  return kMethods;
}

MessageSize LargestMessage(std::string_view method, const Limits& limits, const NetworkLimits& network) {
  const auto& documents = DocumentMethods();
  if (std::find(documents.begin(), documents.end(), method) != documents.end())
    return {std::max(limits.grpc_message_bytes, limits.document_bytes + kBesideText), "document_bytes"};
  if (method == "docent.v1.Context.Update")
    return {limits.update_text_bytes + kBesideText, "update_text_bytes"};
  return {network.request_bytes, "request_bytes"};
}

MessageSize LargestJson(std::string_view method, const Limits& limits, const NetworkLimits& network) {
  const MessageSize binary = LargestMessage(method, limits, network);
  if (kJsonFactor * binary.bytes > limits.http_body_bytes) return {limits.http_body_bytes, "http_body_bytes"};
  return {kJsonFactor * binary.bytes, binary.limit};
}

absl::Status CheckMessageSize(std::string_view method, size_t bytes, const MessageSize& largest) {
  if (bytes <= largest.bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("a message of ", bytes, " bytes is too large for ",
                                                   ToAbsl(method), ", which takes ", largest.bytes, " (",
                                                   ToAbsl(largest.limit), ")"));
}

}  // namespace docent::server
