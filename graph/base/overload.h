// The two kinds of RESOURCE_EXHAUSTED: a request that is beyond one of its own limits, which it will meet again, and an
// overload, which may pass: too much other work, a full disk. Pure functions.
#ifndef DOCENT_GRAPH_BASE_OVERLOAD_H_
#define DOCENT_GRAPH_BASE_OVERLOAD_H_

#include <string_view>

#include "absl/status/status.h"

namespace docent {

// RESOURCE_EXHAUSTED that may pass.
absl::Status OverloadError(std::string_view message);
bool IsOverload(const absl::Status& status);

// As `status` with another message, as where a place is put before it.
absl::Status WithMessage(const absl::Status& status, std::string_view message);

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_OVERLOAD_H_
