#include "workflow/engine/service_workflow.h"

#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"

namespace docent {

cawl::DocumentPtr ServiceWorkflow(const std::string& process) {
  auto document = std::make_shared<cawl::Document>();
  document->name.value = absl::StrCat("service ", process);
  cawl::Flow flow;
  flow.name.value = process;
  flow.source.value = "source";
  flow.sink.value = "sink";
  cawl::Node node;
  node.name.value = process;
  cawl::Invoke invoke;
  invoke.operation.value = process;
  node.invokes.push_back(std::move(invoke));
  flow.nodes.push_back(std::move(node));
  cawl::Link in, out;
  in.from.value = "source";
  in.to.value = process;
  out.from.value = process;
  out.to.value = "sink";
  flow.links.push_back(std::move(in));
  flow.links.push_back(std::move(out));
  document->flows.push_back(std::move(flow));
  return document;
}

std::string ServiceOf(const cawl::Document& document) {
  return document.source.empty() ? document.flows[0].name.value : "";
}

}  // namespace docent
