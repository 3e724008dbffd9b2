// The two kinds of RESOURCE_EXHAUSTED. A request that exceeds one of its own limits fails again when
// repeated. An overload may pass: too much other work, a full disk. Pure functions.
#ifndef DOCENT_GRAPH_BASE_OVERLOAD_H_
#define DOCENT_GRAPH_BASE_OVERLOAD_H_

#include <string_view>

#include "absl/status/status.h"

namespace docent {

// RESOURCE_EXHAUSTED marked as an overload.
absl::Status OverloadError(std::string_view message);
bool IsOverload(const absl::Status& status);

// `status` with another message, for example with a place in front. The kind stays the same.
absl::Status WithMessage(const absl::Status& status, std::string_view message);

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_OVERLOAD_H_
