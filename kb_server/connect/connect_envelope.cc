#include "kb_server/connect/connect_envelope.h"

#include "absl/strings/str_cat.h"

namespace docent::server {

std::string Enveloped(uint8_t flags, std::string_view data) {
  std::string out;
  out.reserve(kEnvelopeHead + data.size());
  out += static_cast<char>(flags);
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>((data.size() >> shift) & 0xff);
  out += data;
  return out;
}

absl::StatusOr<std::vector<ConnectEnvelope>> SplitEnvelopes(std::string_view body, size_t most) {
  std::vector<ConnectEnvelope> envelopes;
  for (size_t at = 0; at < body.size();) {
    if (envelopes.size() == most) {
      return absl::ResourceExhaustedError(
          absl::StrCat("the body has more enveloped messages than ", most, ", the limit stream_messages"));
    }
    if (body.size() - at < kEnvelopeHead) {
      return absl::InvalidArgumentError(
          absl::StrCat("the body ends inside the head of an envelope, at byte ", at,
                       ": before each message stand a byte of flags and four bytes of length, big-endian"));
    }
    const auto flags = static_cast<uint8_t>(body[at]);
    uint64_t length = 0;
    for (size_t i = 1; i < kEnvelopeHead; ++i) length = length << 8 | static_cast<uint8_t>(body[at + i]);
    if ((flags & ~kCompressedFlag) != 0) {
      return absl::InvalidArgumentError(
          absl::StrCat("the envelope at byte ", at, " has the flags ", static_cast<int>(flags),
                       "; a request has only 0, and 1 for a compressed message"));
    }
    if (length > body.size() - at - kEnvelopeHead) {
      return absl::InvalidArgumentError(absl::StrCat("the envelope at byte ", at,
                                                     " says that its message has ", length, " bytes, and ",
                                                     body.size() - at - kEnvelopeHead, " follow"));
    }
    envelopes.push_back({flags, body.substr(at + kEnvelopeHead, length)});
    at += kEnvelopeHead + length;
  }
  return envelopes;
}

}  // namespace docent::server
