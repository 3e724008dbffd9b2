#include "kb_server/replay/run_tree.h"

#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"

namespace docent::server {

void RunTree::Observe(const Delta& delta) {
  const std::optional<TermId> child_run = dictionary_.FindIri(DocentIri("childRun"));
  const std::optional<TermId> parent_run = dictionary_.FindIri(DocentIri("parentRun"));
  std::vector<std::pair<std::string, std::string>> open;  // child, "RUN/NODE/INVOCATION" or "RUN"
  for (const TermId& predicate : {child_run.value_or(TermId()), parent_run.value_or(TermId())}) {
    if (predicate.IsNone()) continue;
    for (const Quad& quad : delta.added) {
      if (quad.predicate != predicate) continue;
      const auto subject = RunOfIri(dictionary_.Decode(quad.subject).lexical);
      const auto object = RunOfIri(dictionary_.Decode(quad.object).lexical);
      if (!subject || !object) continue;
      if (predicate == child_run)
        open.emplace_back(object->value(), subject->value());
      else
        open.emplace_back(subject->value(), object->value());
    }
  }
  for (bool more = true; more;) {  // a run that is nested in one of the same turn may come before it
    more = false;
    for (const auto& [child, invocation] : open) more = Add(child, invocation) || more;
  }
}

bool RunTree::Add(const std::string& child, std::string_view invocation) {
  if (paths_.contains(child)) return false;
  const std::vector<std::string> parts = absl::StrSplit(std::string(invocation), '/');
  const auto parent = paths_.find(parts[0]);
  if (parent == paths_.end()) return false;
  std::string path = parent->second.empty() ? "" : absl::StrCat(parent->second, "/");
  absl::StrAppend(&path, parts.size() > 1 ? NameOfSegment(parts[1]) : "(undoing)");
  int number = 0;
  if (parts.size() > 2 && absl::SimpleAtoi(parts[2], &number) && number > 0)
    absl::StrAppend(&path, "[", number + 1, "]");
  std::string own = path;
  for (int again = 2; taken_.contains(own); ++again) own = absl::StrCat(path, "#", again);
  taken_.insert(own);
  paths_[child] = std::move(own);
  return true;
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
