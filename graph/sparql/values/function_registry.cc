#include "graph/sparql/values/function_registry.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/diagnostic.h"
#include "graph/base/text.h"
#include "graph/sparql/values/value.h"

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

std::optional<CallMistake> FindCallMistake(const FunctionRegistry* functions, const std::string& iri,
                                           size_t arguments) {
  const FunctionEntry* entry = functions == nullptr ? nullptr : functions->Find(iri);
  if (entry == nullptr && !IsCast(iri)) {
    std::vector<std::string> names;
    if (functions != nullptr) names = functions->Names();
    const std::string near = Nearest(iri, names);
    return CallMistake{Concat("no function <", iri, "> is known"),
                       !near.empty()   ? Concat("did you mean <", near, ">?")
                       : names.empty() ? ""
                                       : absl::StrCat("beside the casts of xsd: there are <",
                                                      absl::StrJoin(names, ">, <"), ">")};
  }
  const auto least = static_cast<size_t>(entry == nullptr ? 1 : entry->min_arguments);
  const auto most = static_cast<size_t>(entry == nullptr ? 1 : entry->max_arguments);
  if (arguments >= least && arguments <= most) return std::nullopt;
  return CallMistake{
      absl::StrCat("<", iri, "> does not take ", arguments, arguments == 1 ? " argument" : " arguments"),
      least == most ? absl::StrCat("it takes ", least) : absl::StrCat("it takes ", least, " to ", most)};
}

}  // namespace docent::sparql
