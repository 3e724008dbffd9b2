// Messages between their binary form, which gRPC carries, and JSON, by descriptors alone: a message that is new in proto needs
// no code. Pure functions; any thread.
#ifndef DOCENT_KB_SERVER_CONNECT_MESSAGE_CODEC_H_
#define DOCENT_KB_SERVER_CONNECT_MESSAGE_CODEC_H_

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/memory_budget.h"

namespace google::protobuf {
class Descriptor;
class ServiceDescriptor;
}  // namespace google::protobuf

namespace docent::server {

enum class MessageCodec { kJson, kProto };

// A service of this program by its full name, "docent.v1.Fleet"; null: there is none.
const google::protobuf::ServiceDescriptor* FindService(const std::string& name);

// Number of values in a text that may be JSON, about: so many parts need memory while it is read.
size_t ValuesInJson(std::string_view text);

// What a client sent as the binary form. An empty text as JSON is a message without fields. INVALID_ARGUMENT where it is no
// message of this type; JSON has no fields that the type does not have. RESOURCE_EXHAUSTED where it would take more memory
// than the limit request_memory_bytes. `memory`, if there is one, counts what the conversion needs before it begins, and
// then the result, which the caller releases. `cancellation`, if there is one, is looked at all the while: where it is over, its
// error is the result.
absl::StatusOr<std::string> ToBinary(const google::protobuf::Descriptor& type, MessageCodec codec,
                                     std::string_view text, MemoryUse* memory = nullptr,
                                     Cancellation* cancellation = nullptr);

// The binary form as the client wants it. INTERNAL where it is none.
absl::StatusOr<std::string> FromBinary(const google::protobuf::Descriptor& type, MessageCodec codec,
                                       std::string bytes);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CONNECT_MESSAGE_CODEC_H_
