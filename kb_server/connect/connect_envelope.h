// Enveloped messages of Connect's streams: a byte of flags, four bytes of length (big-endian), the message. Pure functions.
#ifndef DOCENT_KB_SERVER_CONNECT_CONNECT_ENVELOPE_H_
#define DOCENT_KB_SERVER_CONNECT_CONNECT_ENVELOPE_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace docent::server {

constexpr uint8_t kCompressedFlag = 1;
constexpr uint8_t kEndStreamFlag = 2;
constexpr size_t kEnvelopeHead = 5;  // bytes before the message

struct ConnectEnvelope {
  uint8_t flags = 0;
  std::string_view data;
};

std::string Enveloped(uint8_t flags, std::string_view data);

// All envelopes of a request's body, in order; they point into it. INVALID_ARGUMENT for one that is cut, and for flags that
// a client does not send. RESOURCE_EXHAUSTED for more than `most`.
absl::StatusOr<std::vector<ConnectEnvelope>> SplitEnvelopes(std::string_view body, size_t most);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CONNECT_CONNECT_ENVELOPE_H_
