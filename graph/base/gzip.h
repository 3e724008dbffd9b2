// gzip (RFC 1952): packs and unpacks the texts of files and HTTP requests. Any thread.
#ifndef DOCENT_GRAPH_BASE_GZIP_H_
#define DOCENT_GRAPH_BASE_GZIP_H_

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/memory_budget.h"

namespace docent {

// True if the bytes begin with the gzip signature.
inline bool IsGzip(std::string_view bytes) {
  return bytes.starts_with("\x1F\x8B\x08");
}

// The unpacked bytes of all members. INVALID_ARGUMENT: the data is damaged or truncated. RESOURCE_EXHAUSTED
// naming `limit_name`: the data unpacks to more than `most_bytes`; unpacking stops there.
// `memory`, if there is one, counts the unpacked bytes while they are made: where it refuses them, its error is the result,
// and nothing is counted of them any more. Otherwise they stay counted, and the caller releases them. `cancellation`, if there
// is one, is looked at all the while: where it is over, its error is the result.
absl::StatusOr<std::string> Gunzip(std::string_view bytes, size_t most_bytes, std::string_view limit_name,
                                   MemoryUse* memory = nullptr, Cancellation* cancellation = nullptr);

// The bytes as one member, packed quickly rather than tightly.
std::string Gzip(std::string_view bytes);

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_GZIP_H_
