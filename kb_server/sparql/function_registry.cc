#include "kb_server/sparql/function_registry.h"

#include <algorithm>
#include <utility>

namespace docent::sparql {

absl::Status FunctionRegistry::Register(std::string_view iri, int min_arguments, int max_arguments,
                                        NamedFunction function) {
  if (!function || min_arguments < 0 || min_arguments > max_arguments) {
    return absl::InvalidArgumentError("function <" + std::string(iri) +
                                      ">: empty, or its argument counts are crossed");
  }
  auto entry =
      std::make_unique<FunctionEntry>(FunctionEntry{std::move(function), min_arguments, max_arguments});
  if (!functions_.emplace(std::string(iri), std::move(entry)).second) {
    return absl::AlreadyExistsError("function <" + std::string(iri) + "> is registered already");
  }
  return absl::OkStatus();
}

const FunctionEntry* FunctionRegistry::Find(std::string_view iri) const {
  const auto it = functions_.find(absl::string_view(iri.data(), iri.size()));
  return it == functions_.end() ? nullptr : it->second.get();
}

std::vector<std::string> FunctionRegistry::Names() const {
  std::vector<std::string> names;
  for (const auto& [iri, entry] : functions_) names.push_back(iri);
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace docent::sparql
