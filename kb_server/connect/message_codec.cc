#include "kb_server/connect/message_codec.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/zero_copy_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/type_resolver_util.h>

#include <algorithm>
#include <climits>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/network_limits.h"
#include "graph/base/text.h"
#include "graph/wire/message_memory.h"

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

// What the conversion takes: the text without its escapes, twice the result, which grows, and what is noted of each value.
size_t MemoryOfJson(std::string_view text) {
  constexpr size_t kCopies = 3, kValue = 32;
  return kCopies * text.size() + kValue * ValuesInJson(text);
}

// Gives a text in pieces, until it is not wanted any more.
class TextPieces : public pb::io::ZeroCopyInputStream {
 public:
  TextPieces(std::string_view text, Cancellation* cancellation) : text_(text), cancellation_(cancellation) {}

  bool Next(const void** data, int* size) override {
    if (status_.ok() && cancellation_ != nullptr) status_ = cancellation_->CheckNow();
    const std::string_view piece = text_.substr(at_, kPiece);
    if (!status_.ok() || piece.empty()) return false;
    *data = piece.data();
    *size = static_cast<int>(piece.size());
    at_ += piece.size();
    return true;
  }
  void BackUp(int count) override { at_ -= static_cast<size_t>(count); }
  bool Skip(int count) override {
    at_ = std::min(text_.size(), at_ + static_cast<size_t>(count));
    return at_ < text_.size();
  }
  int64_t ByteCount() const override { return static_cast<int64_t>(at_); }
  const absl::Status& status() const { return status_; }

 private:
  static constexpr size_t kPiece = 64u << 10;

  const std::string_view text_;
  Cancellation* const cancellation_;
  size_t at_ = 0;
  absl::Status status_;
};

// Straight to the binary form: an object of the message would take many times as much.
absl::StatusOr<std::string> JsonToBinary(const pb::Descriptor& type, std::string_view text,
                                         Cancellation* cancellation) {
  static const std::string kPrefix = "type.googleapis.com";
  static pb::util::TypeResolver* const resolver =
      pb::util::NewTypeResolverForDescriptorPool(kPrefix, pb::DescriptorPool::generated_pool());
  std::string binary;
  TextPieces pieces(text, cancellation);
  pb::io::StringOutputStream output(&binary);
  const auto status =
      pb::util::JsonToBinaryStream(resolver, absl::StrCat(kPrefix, "/", type.full_name()), &pieces, &output);
  if (!pieces.status().ok()) return pieces.status();
  if (status.ok()) return binary;
  return NotOfType(type, "JSON", std::string_view(status.message().data(), status.message().size()));
}

absl::Status TooMuchMemory(const pb::Descriptor& type) {
  return absl::ResourceExhaustedError(absl::StrCat(
      "a ", type.full_name(), " of so many parts takes more memory than the limit request_memory_bytes = ",
      kNetworkLimits.request_memory_bytes, "; send it in several"));
}

}  // namespace

size_t ValuesInJson(std::string_view text) {
  size_t values = 1;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') in_string = !in_string;
    if (in_string && c == '\\') ++i;
    if (!in_string && (c == ',' || c == '{' || c == '[')) ++values;
  }
  return values;
}

const pb::ServiceDescriptor* FindService(const std::string& name) {
  return pb::DescriptorPool::generated_pool()->FindServiceByName(name);
}

absl::StatusOr<std::string> ToBinary(const pb::Descriptor& type, MessageCodec codec, std::string_view text,
                                     MemoryUse* memory, Cancellation* cancellation) {
  if (text.size() > INT_MAX) return absl::ResourceExhaustedError("the message has more than 2 GiB");
  if (text.empty()) return std::string();
  const bool json = codec == MessageCodec::kJson;
  const size_t needed = json ? MemoryOfJson(text) : text.size();
  if (memory != nullptr && !memory->Add(needed)) {
    memory->Release(needed);
    return memory->Refusal(absl::ResourceExhaustedError("the message is too large"), needed);
  }
  absl::StatusOr<std::string> binary = json ? JsonToBinary(type, text, cancellation) : std::string(text);
  if (binary.ok()) {
    const std::optional<size_t> parsed = MemoryOfMessage(type, *binary, kNetworkLimits.request_memory_bytes);
    if (!parsed) binary = NotOfType(type, "its binary form", "");
    if (parsed && *parsed > kNetworkLimits.request_memory_bytes) binary = TooMuchMemory(type);
  }
  if (memory != nullptr) memory->Release(binary.ok() ? needed - std::min(needed, binary->size()) : needed);
  return binary;
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
