#include "kb_server/replay/run_tree.h"

#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/rdf/docent_iris.h"

namespace docent::server {

void RunTree::Observe(const TurnResult& result) {
  for (const engine::NestedRun& nested : result.nested) Add(nested);
}

void RunTree::Add(const engine::NestedRun& nested) {
  const std::vector<std::string> parts = absl::StrSplit(nested.by, '/');
  const auto parent = paths_.find(parts[0]);
  if (parent == paths_.end()) return;
  std::string path = parent->second.empty() ? "" : absl::StrCat(parent->second, "/");
  absl::StrAppend(&path, parts.size() > 1 ? NameOfSegment(parts[1]) : "(undoing)");
  int number = 0;
  if (parts.size() > 2 && absl::SimpleAtoi(parts[2], &number) && number > 0)
    absl::StrAppend(&path, "[", number + 1, "]");
  std::string own = path;
  for (int again = 2; taken_.contains(own); ++again) own = absl::StrCat(path, "#", again);
  taken_.insert(own);
  paths_[nested.run.value()] = std::move(own);
}

std::map<RunId, std::string> RunTree::nested() const {
  std::map<RunId, std::string> nested;
  for (const auto& [run, path] : paths_) {
    if (!path.empty()) nested.emplace(run, path);
  }
  return nested;
}

bool RunTree::IsOwnGraph(std::string_view iri) const {
  const std::optional<RunId> run = RunOfIri(iri);
  return run && Has(*run);
}

std::optional<std::string> RunTree::PathOf(std::string_view subject) const {
  const std::vector<std::string> parts = absl::StrSplit(std::string(subject), '/');
  const auto run = paths_.find(parts[0]);
  if (run == paths_.end()) return std::nullopt;
  if (parts.size() == 1) return run->second;
  const std::string node = NameOfSegment(parts[1]);
  return run->second.empty() ? node : absl::StrCat(run->second, "/", node);
}

std::optional<RunId> RunTree::RunAt(std::string_view path) const {
  for (const auto& [run, of_run] : paths_) {
    if (of_run == path) return RunId(run);
  }
  return std::nullopt;
}

}  // namespace docent::server
