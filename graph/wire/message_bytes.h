// The bytes of a message, the same each time that it says the same. Any thread.
#ifndef DOCENT_GRAPH_WIRE_MESSAGE_BYTES_H_
#define DOCENT_GRAPH_WIRE_MESSAGE_BYTES_H_

#include <google/protobuf/message.h>

#include <string>

namespace docent {

// Protobuf's deterministic form: fields by their numbers, maps by their keys.
std::string StableBytes(const google::protobuf::Message& message);

}  // namespace docent

#endif  // DOCENT_GRAPH_WIRE_MESSAGE_BYTES_H_
