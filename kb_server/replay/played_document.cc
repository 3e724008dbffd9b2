#include "kb_server/replay/played_document.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "workflow/cawl/parser.h"
#include "workflow/rsel/parser.h"

namespace docent::server {
namespace {

xml::Text Given(std::string value, const SourceSpan& span) {
  return {std::move(value), span};
}

absl::Status NoSuch(const std::string& what, const std::string& name, const std::vector<std::string>& names) {
  const std::string near = Nearest(name, names);
  return absl::NotFoundError(absl::StrCat(what, " \"", name, "\"",
                                          near.empty() ? absl::StrCat("; it has ", absl::StrJoin(names, ", "))
                                                       : absl::StrCat("; did you mean ", near, "?")));
}

bool IsOfName(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

}  // namespace

absl::StatusOr<cawl::DocumentPtr> ParseWorkflow(const std::string& text, const std::string& name,
                                                const Limits& limits) {
  cawl::ParsedCawl parsed = cawl::ParseCawl(text, name, limits);
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, text);
  return std::move(parsed.document);
}

absl::StatusOr<RunCase> WithServices(RunCase recorded, const std::vector<Document>& services,
                                     const Limits& limits) {
  std::vector<std::string> names;
  for (const Document& document : services) {
    const rsel::ParsedRsel parsed = rsel::ParseRsel(document.text, document.name, limits);
    if (!parsed.ok()) return ToStatus(parsed.diagnostics, document.text);
    names.push_back(parsed.document->name.value);
  }
  const auto is_replaced = [&](const Document& document) {
    if (document.kind != Document::Kind::kRsel || document.action != Document::Action::kPut) return false;
    const rsel::ParsedRsel parsed = rsel::ParseRsel(document.text, document.name, limits);
    return parsed.document != nullptr &&
           std::find(names.begin(), names.end(), parsed.document->name.value) != names.end();
  };
  std::erase_if(recorded.documents, is_replaced);
  for (CaseTurn& turn : recorded.turns) std::erase_if(turn.batch.documents, is_replaced);
  recorded.documents.insert(recorded.documents.end(), services.begin(), services.end());
  return recorded;
}

cawl::DocumentPtr WithoutFiring(const cawl::Document& document) {
  auto played = std::make_shared<cawl::Document>(document);
  if (played->activator) {
    cawl::Condition never;  // an event that nothing tells
    const SourceSpan& span = never.span = played->activator->condition.span;
    cawl::Event event{Given("urn:docent:never", span), span};
    cawl::Case only;
    only.span = span;
    only.events.push_back(std::move(event));
    never.cases.push_back(std::move(only));
    played->activator->condition = std::move(never);
  }
  return played;
}

absl::StatusOr<cawl::DocumentPtr> OnlyNode(const cawl::Document& document, const std::string& flow_name,
                                           const std::string& node_name) {
  auto played = std::make_shared<cawl::Document>(*WithoutFiring(document));
  std::vector<std::string> names;
  for (const cawl::Flow& flow : played->flows) names.push_back(flow.name.value);
  const auto flow = std::find_if(played->flows.begin(), played->flows.end(),
                                 [&](const cawl::Flow& f) { return f.name.value == flow_name; });
  if (flow == played->flows.end())
    return NoSuch(absl::StrCat("workflow ", document.name.value, " has no flow"), flow_name, names);
  names.clear();
  for (const cawl::Node& node : flow->nodes) names.push_back(node.name.value);
  const auto node = std::find_if(flow->nodes.begin(), flow->nodes.end(),
                                 [&](const cawl::Node& n) { return n.name.value == node_name; });
  if (node == flow->nodes.end())
    return NoSuch(absl::StrCat("flow ", flow_name, " has no node"), node_name, names);
  cawl::Node only = *node;
  only.join.reset();
  only.join_text = {};
  only.position = 1;
  const SourceSpan span = only.span;
  flow->links = {};
  for (const auto& [from, to] :
       {std::pair(flow->source.value, node_name), std::pair(node_name, flow->sink.value)}) {
    cawl::Link link;
    link.from = Given(from, span);
    link.to = Given(to, span);
    link.span = span;
    flow->links.push_back(std::move(link));
  }
  flow->nodes = {std::move(only)};
  return cawl::DocumentPtr(std::move(played));
}

absl::StatusOr<std::set<std::string>> OperationsOf(const cawl::Document& document,
                                                   const std::vector<Document>& others,
                                                   const Limits& limits) {
  std::set<std::string> invoked, processes, of_robots;
  const auto add = [&invoked](const cawl::Document& workflow) {
    for (const cawl::Flow& flow : workflow.flows) {
      for (const cawl::Node& node : flow.nodes) {
        for (const cawl::Invoke& invoke : node.invokes) {
          if (!invoke.operation.value.empty() && invoke.capability.value.empty())
            invoked.insert(invoke.operation.value);
        }
      }
    }
  };
  add(document);
  for (const Document& other : others) {
    if (other.kind == Document::Kind::kCawl) {
      const auto workflow = ParseWorkflow(other.text, other.name, limits);
      if (!workflow.ok()) return workflow.status();
      add(**workflow);
    } else if (other.kind == Document::Kind::kRsel) {
      const rsel::ParsedRsel services = rsel::ParseRsel(other.text, other.name, limits);
      if (services.document == nullptr) continue;
      for (const rsel::Process& process : services.document->processes) {
        processes.insert(process.name.value);
        for (const rsel::Invoke& invoke : process.invokes) {
          invoked.insert(invoke.operation.value);
          // its own name: the operation of the robot
          if (invoke.operation.value == process.name.value) of_robots.insert(invoke.operation.value);
        }
      }
    }
  }
  for (const std::string& name : invoked) {
    if (!processes.contains(name)) of_robots.insert(name);
  }
  return of_robots;
}

std::string WithValues(const std::string& ask, const std::map<std::string, Term>& values) {
  std::string out;
  char quote = 0;  // inside a literal
  for (size_t i = 0; i < ask.size(); ++i) {
    const char c = ask[i];
    if (quote != 0) {
      out += c;
      if (c == '\\' && i + 1 < ask.size()) out += ask[++i];
      if (c == quote) quote = 0;
      continue;
    }
    if (c == '"' || c == '\'') quote = c;
    size_t end = i + 1;
    while (end < ask.size() && IsOfName(ask[end])) ++end;
    const auto value = c == '?' || c == '$' ? values.find(ask.substr(i + 1, end - i - 1)) : values.end();
    if (value == values.end() || value->second.IsBlank()) {
      out += c;
      continue;
    }
    out += ToNTriples(value->second);
    i = end - 1;
  }
  return out;
}

}  // namespace docent::server
