// Reading files that users name: what is no regular file (a pipe, a device) is refused before anything waits for it.
// Any thread.
#ifndef DOCENT_GRAPH_BASE_REGULAR_FILE_H_
#define DOCENT_GRAPH_BASE_REGULAR_FILE_H_

#include <cstddef>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace docent {

struct RegularFile {
  std::string text;       // at most one byte more than the limit
  std::string real_path;  // of what was read, symbolic links resolved; empty: the system does not say
};

// NOT_FOUND: it cannot be opened; INVALID_ARGUMENT: it is no regular file; UNAVAILABLE: reading failed. The message names
// the path. A pipe that the shell made for the process (/dev/fd/63, /dev/stdin) is read all the same where `shell_pipes`.
absl::StatusOr<RegularFile> ReadRegularFile(const std::string& path, size_t max_bytes,
                                            bool shell_pipes = false);

// The same refusals without reading.
absl::Status CheckRegularFile(const std::string& path);

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_REGULAR_FILE_H_
