#include "robot_adapters/sdk/operation.h"

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::robot {

absl::StatusOr<Term> OperationContext::Argument(std::string_view name) const {
  for (const auto& [argument, value] : arguments()) {
    if (argument == name) return value;
  }
  return absl::InvalidArgumentError(absl::StrCat("the command gives no argument \"", ToAbsl(name), "\""));
}

}  // namespace docent::robot
