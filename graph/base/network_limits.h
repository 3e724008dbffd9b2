// Limits of what clients send, until a handler has it. The rules of limits.h hold here; separate, since few include it.
#ifndef DOCENT_GRAPH_BASE_NETWORK_LIMITS_H_
#define DOCENT_GRAPH_BASE_NETWORK_LIMITS_H_

#include <cstddef>

namespace docent {

struct NetworkLimits {
  size_t request_bytes = 4u << 20;  // message of a method that takes neither a document nor an update
  size_t request_memory_bytes = 256u << 20;  // memory of one message that is read
  size_t grpc_requests_bytes = 512u << 20;   // messages of all gRPC calls that arrive or are in work
  // It covers what grpc_requests_bytes does not count: messages of AssertStream, health and reflection until they are whole, and
  // what arrives of another call before its message is let in. A half-sent message of AssertStream or health has no deadline: gRPC
  // does not report it.
  size_t grpc_memory_bytes =
      768u << 20;  // what gRPC holds of all connections; beyond, it takes no more, or ends calls
  size_t grpc_connection_bytes = 128u
                                 << 20;  // messages that arrive on one gRPC connection; one may exceed it
  size_t grpc_waiting = 1024;            // calls whose message waits for room to arrive
  size_t grpc_streams = 1000;            // calls of one gRPC connection at the same time
  int grpc_reflection_calls = 64;        // calls of gRPC's reflection at the same time
  // A call of reflection has the same time for each message.
  int grpc_arrival_ms = 30000;         // time in which the message of a call arrives
  int grpc_crowded_arrival_ms = 5000;  // the same time, while the messages of others wait for room
};

inline constexpr NetworkLimits kNetworkLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_NETWORK_LIMITS_H_
