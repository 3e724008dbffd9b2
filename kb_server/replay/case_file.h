// Saved runs as files: a case as JSON text (docs/reference/file_formats.md). What was told, asked and done is there for people to
// read and for version control, facts as N-Quads, one a line, and times in UTC; the state before the run is packed. Pure functions;
// any thread.
#ifndef DOCENT_KB_SERVER_REPLAY_CASE_FILE_H_
#define DOCENT_KB_SERVER_REPLAY_CASE_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "graph/base/replay_limits.h"
#include "kb_server/replay/run_case.h"

namespace docent::server {

inline constexpr char kCaseFormat[] = "docent-saved-run";
// Grows when an older program could not read the file, or would misread it.
inline constexpr int kCaseVersion = 2;

// Of a case that has a state.
std::string EncodeCase(const RunCase& saved);

// Of this version, or an older one: that is a world. INVALID_ARGUMENT naming `file` and the place in it: it is no saved run, is
// damaged, or of a newer format. RESOURCE_EXHAUSTED naming the limit.
absl::StatusOr<RunCase> DecodeCase(const std::string& text, const std::string& file,
                                   const ReplayLimits& limits = {});

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_CASE_FILE_H_
