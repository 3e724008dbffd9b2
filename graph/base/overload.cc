#include "graph/base/overload.h"

#include "absl/strings/cord.h"
#include "graph/base/text.h"

namespace docent {
namespace {

constexpr char kOverload[] = "docent/overload";

}  // namespace

absl::Status OverloadError(std::string_view message) {
  absl::Status status = absl::ResourceExhaustedError(ToAbsl(message));
  status.SetPayload(kOverload, absl::Cord());
  return status;
}

bool IsOverload(const absl::Status& status) {
  return absl::IsResourceExhausted(status) && status.GetPayload(kOverload).has_value();
}

absl::Status WithMessage(const absl::Status& status, std::string_view message) {
  return IsOverload(status) ? OverloadError(message) : absl::Status(status.code(), ToAbsl(message));
}

}  // namespace docent
