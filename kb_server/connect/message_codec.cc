#include "kb_server/connect/message_codec.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/stubs/logging.h>
#include <google/protobuf/util/json_util.h>

#include <climits>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::server {
namespace {

namespace pb = google::protobuf;

// Of the classes that are compiled in, which is quicker than a DynamicMessage.
std::unique_ptr<pb::Message> NewMessage(const pb::Descriptor& type) {
  return std::unique_ptr<pb::Message>(pb::MessageFactory::generated_factory()->GetPrototype(&type)->New());
}

absl::Status NotOfType(const pb::Descriptor& type, std::string_view form, std::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat("the message is not a ", type.full_name(), " in ",
                                                 ToAbsl(form), reason.empty() ? "" : ": ", ToAbsl(reason)));
}

}  // namespace

const pb::ServiceDescriptor* FindService(const std::string& name) {
  return pb::DescriptorPool::generated_pool()->FindServiceByName(name);
}

absl::StatusOr<std::string> ToBinary(const pb::Descriptor& type, MessageCodec codec, std::string_view text) {
  if (text.size() > INT_MAX) return absl::ResourceExhaustedError("the message has more than 2 GiB");
  if (text.empty()) return std::string();
  const std::unique_ptr<pb::Message> message = NewMessage(type);
  if (codec == MessageCodec::kProto) {
    const pb::LogSilencer quiet;  // the client is told
    if (!message->ParseFromArray(text.data(), static_cast<int>(text.size())))
      return NotOfType(type, "its binary form", "");
    return std::string(text);
  }
  const auto status = pb::util::JsonStringToMessage({text.data(), text.size()}, message.get());
  if (!status.ok()) {
    return NotOfType(type, "JSON", std::string_view(status.message().data(), status.message().size()));
  }
  return message->SerializeAsString();
}

absl::StatusOr<std::string> FromBinary(const pb::Descriptor& type, MessageCodec codec, std::string bytes) {
  if (codec == MessageCodec::kProto) return bytes;
  const std::unique_ptr<pb::Message> message = NewMessage(type);
  std::string json;
  if (!message->ParseFromString(bytes) || !pb::util::MessageToJsonString(*message, &json).ok()) {
    return absl::InternalError(absl::StrCat("an answer cannot be written as JSON: ", type.full_name()));
  }
  return json;
}

}  // namespace docent::server
