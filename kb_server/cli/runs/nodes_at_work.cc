#include "kb_server/cli/runs/nodes_at_work.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace docent::server {
namespace {

std::string Names(const v1::Run& run, bool (*counts)(const v1::Node& node)) {
  std::string names;
  for (const v1::Node& node : run.nodes()) {
    if (counts(node)) absl::StrAppend(&names, names.empty() ? "" : ", ", node.name());
  }
  return names;
}

}  // namespace

std::string NodesAtWork(const v1::Run& run) {
  return Names(run, [](const v1::Node& node) { return node.state() == "running"; });
}

std::string KeptValueText(const v1::Run& run, const std::string& variable) {
  const std::string nodes = NodesAtWork(run);
  if (nodes.empty()) return "";
  return absl::StrCat(variable, ": what runs already goes on with the former value (", nodes, ")\n");
}

std::string StillUnderWay(const v1::Run& run) {
  const std::string nodes = Names(run, [](const v1::Node& node) {
    return std::any_of(node.invocations().begin(), node.invocations().end(),
                       [](const v1::Invocation& invocation) { return invocation.state() == "running"; });
  });
  if (nodes.empty()) return "";
  return absl::StrCat(run.id(), " still does ", nodes, " to the end; --cancel-commands ends it\n");
}

}  // namespace docent::server
