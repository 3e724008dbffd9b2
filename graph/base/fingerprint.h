// FNV-1a, 64 bits (Fowler, Noll, Vo): a fingerprint, the same in every process; no defence against chosen
// texts. For a text in parts, the fingerprint of the part before is the basis of the next. Any thread.
#ifndef DOCENT_GRAPH_BASE_FINGERPRINT_H_
#define DOCENT_GRAPH_BASE_FINGERPRINT_H_

#include <cstdint>
#include <string_view>

namespace docent {

inline constexpr uint64_t kFingerprintBasis = 0xCBF29CE484222325;

constexpr uint64_t Fingerprint(std::string_view bytes, uint64_t basis = kFingerprintBasis) {
  for (const char c : bytes) basis = (basis ^ static_cast<unsigned char>(c)) * 0x100000001B3;
  return basis;
}

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_FINGERPRINT_H_
