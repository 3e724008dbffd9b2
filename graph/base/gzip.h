// gzip (RFC 1952): texts that files and HTTP requests bring packed. Any thread.
#ifndef DOCENT_GRAPH_BASE_GZIP_H_
#define DOCENT_GRAPH_BASE_GZIP_H_

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace docent {

// Whether the bytes begin as a gzip file does.
inline bool IsGzip(std::string_view bytes) {
  return bytes.starts_with("\x1F\x8B\x08");
}

// The unpacked bytes of all members. INVALID_ARGUMENT: it is damaged, or cut. RESOURCE_EXHAUSTED naming `limit_name`: more
// than `most_bytes` came out, of which no more is unpacked.
absl::StatusOr<std::string> Gunzip(std::string_view bytes, size_t most_bytes, std::string_view limit_name);

// For tests and for what we write ourselves.
std::string Gzip(std::string_view bytes);

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_GZIP_H_
