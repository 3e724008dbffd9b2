// Saved runs as files: a case as JSON text, for people to read and for version control (docs/reference/file_formats.md). Facts are
// N-Quads, one a line, sorted; times are UTC. Pure functions; any thread.
#ifndef DOCENT_KB_SERVER_REPLAY_CASE_FILE_H_
#define DOCENT_KB_SERVER_REPLAY_CASE_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "graph/base/replay_limits.h"
#include "kb_server/replay/run_case.h"

namespace docent::server {

inline constexpr char kCaseFormat[] = "docent-saved-run";
// Grows when an older program could not read the file, or would misread it.
inline constexpr int kCaseVersion = 1;

std::string EncodeCase(const RunCase& saved);

// INVALID_ARGUMENT naming `file` and the place in it: it is no saved run, is damaged, or of a newer format. RESOURCE_EXHAUSTED
// naming the limit.
absl::StatusOr<RunCase> DecodeCase(const std::string& text, const std::string& file,
                                   const ReplayLimits& limits = {});

// The case without the workflows that neither its document starts as a sub-flow, nor one of those that it starts.
RunCase WithoutOtherWorkflows(RunCase recorded);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_CASE_FILE_H_
