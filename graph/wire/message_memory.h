// Memory that a message takes when it is parsed, told from its bytes: a field of two bytes may become an object of hundreds.
// Any thread.
#ifndef DOCENT_GRAPH_WIRE_MESSAGE_MEMORY_H_
#define DOCENT_GRAPH_WIRE_MESSAGE_MEMORY_H_

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/zero_copy_stream.h>

#include <cstddef>
#include <optional>
#include <string_view>

namespace docent {

// About the bytes of memory of a message of `type`, rather more than less. Counting ends where they exceed `most`. nullopt: the
// bytes are no message.
std::optional<size_t> MemoryOfMessage(const google::protobuf::Descriptor& type,
                                      google::protobuf::io::ZeroCopyInputStream* bytes, size_t most);
std::optional<size_t> MemoryOfMessage(const google::protobuf::Descriptor& type, std::string_view bytes,
                                      size_t most);

}  // namespace docent

#endif  // DOCENT_GRAPH_WIRE_MESSAGE_MEMORY_H_
