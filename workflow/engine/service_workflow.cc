#include "workflow/engine/service_workflow.h"

#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"

namespace docent::engine {

cawl::DocumentPtr ServiceWorkflow(const std::string& process) {
  auto document = std::make_shared<cawl::Document>();
  document->name.value = absl::StrCat("service ", process);
  cawl::Flow flow;
  flow.name.value = process;
  // No process has the name of its own source or sink.
  flow.source.value = absl::StrCat(process, " begins");
  flow.sink.value = absl::StrCat(process, " ends");
  cawl::Node node;
  node.name.value = process;
  node.position = 1;
  cawl::Invoke invoke;
  invoke.operation.value = process;
  node.invokes.push_back(std::move(invoke));
  flow.nodes.push_back(std::move(node));
  cawl::Link in, out;
  in.from.value = flow.source.value;
  in.to.value = process;
  out.from.value = process;
  out.to.value = flow.sink.value;
  flow.links.push_back(std::move(in));
  flow.links.push_back(std::move(out));
  document->flows.push_back(std::move(flow));
  return document;
}

std::string ServiceOf(const cawl::Document& document) {
  return document.source.empty() ? document.flows[0].name.value : "";
}

}  // namespace docent::engine
