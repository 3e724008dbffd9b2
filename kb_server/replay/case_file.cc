#include "kb_server/replay/case_file.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/time/time.h"
#include "kb_server/replay/saved_words.h"
#include "nlohmann/json.hpp"
#include "workflow/cawl/parser.h"

namespace docent::server {
namespace {

using Json = nlohmann::ordered_json;

std::string Show(TimeMicros time_us) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%E*SZ", absl::FromUnixMicros(time_us), absl::UTCTimeZone());
}

std::string Line(const TermQuad& quad) {
  return absl::StrCat(ToNTriples(quad.subject), " ", ToNTriples(quad.predicate), " ", ToNTriples(quad.object),
                      " ", ToNTriples(quad.graph), " .");
}

Json Lines(const std::string& text) {
  return std::vector<std::string>(absl::StrSplit(text, '\n'));
}

template <typename Named>
Json Values(const Named& values) {
  Json out = Json::object();
  for (const auto& [name, value] : values) out[name] = ToNTriples(value);
  return out;
}

Json Of(const Document& document) {
  Json out = {{"kind", WordOf(document.kind)}, {"name", document.name}};
  if (document.action == Document::Action::kRemove) out["removed"] = true;
  if (!document.text.empty()) out["text"] = Lines(document.text);
  return out;
}

Json Of(const Holds& holds) {
  Json out = Json::object();
  for (const auto& [robot, run] : holds) out[robot.value()] = run.value();
  return out;
}

Json Of(const CommandReport& report) {
  Json out = {{"command", report.command.value()}, {"outcome", WordOf(report.outcome)}};
  if (!report.message.empty()) out["message"] = report.message;
  if (report.progress != 0) out["progress"] = report.progress;
  if (!report.incarnation.empty()) out["incarnation"] = report.incarnation;
  if (!report.results.empty()) out["results"] = Values(report.results);
  return out;
}

Json Of(const CaseRequest& asked) {
  const RunRequest& request = asked.request;
  Json out = {{"kind", WordOf(request.kind)}};
  const auto put = [&out](const char* name, const std::string& value) {
    if (!value.empty()) out[name] = value;
  };
  put("run", asked.run);
  put("target", request.target);
  put("node", request.node);
  put("robot", request.robot);
  put("reason", request.reason);
  if (!request.arguments.empty()) out["values"] = Values(request.arguments);
  if (request.cancels_commands) out["cancelsCommands"] = true;
  if (request.compensates) out["compensates"] = true;
  return out;
}

Json Of(const CaseTurn& turn) {
  Json out = {{"turn", turn.offset}, {"time", Show(turn.time_us)}};
  for (const auto& [name, kind] :
       {std::pair("remove", QuadOperation::Kind::kRemove), std::pair("add", QuadOperation::Kind::kAdd)}) {
    for (const QuadOperation& operation : turn.changes) {
      if (operation.kind == kind) out[name].push_back(Line(operation.quad));
    }
  }
  for (const Document& document : turn.documents) out["documents"].push_back(Of(document));
  for (const CommandReport& report : turn.reports) out["reports"].push_back(Of(report));
  for (const CaseRequest& request : turn.requests) out["requests"].push_back(Of(request));
  if (turn.held) out["held"] = Of(*turn.held);
  return out;
}

Json Of(const Decision& decision) {
  Json out = {{"turn", decision.turn}, {"time", Show(decision.time_us)}};
  if (!decision.node.empty()) out["node"] = decision.node;
  if (decision.kind == Decision::Kind::kState) {
    out["from"] = decision.from;
    out["to"] = decision.to;
    if (!decision.cause.empty()) out["cause"] = decision.cause;
    return out;
  }
  out[decision.kind == Decision::Kind::kCancel ? "cancels" : "command"] = decision.command.value();
  if (decision.kind == Decision::Kind::kCancel) return out;
  out["operation"] = decision.operation;
  out["robot"] = decision.robot.value();
  out["values"] = Values(decision.arguments);
  return out;
}

}  // namespace

std::string EncodeCase(const RunCase& saved) {
  Json out = {{"format", kCaseFormat}, {"formatVersion", kCaseVersion}};
  out["run"] = {{"id", saved.run.value()},
                {"number", saved.number},
                {"workflow", saved.workflow},
                {"flow", saved.flow},
                {"startedBy", saved.asked ? "request" : "activator"},
                {"values", Values(saved.values)},
                {"lastTurn", saved.last_turn},
                {"ended", saved.ended}};
  Json& course = out["course"];
  course["state"] = saved.course.state;
  if (!saved.course.reason.empty()) course["reason"] = saved.course.reason;
  course["variables"] = Values(saved.course.variables);
  course["results"] = Values(saved.course.results);
  course["decisions"] = Json::array();
  for (const Decision& decision : saved.course.decisions) course["decisions"].push_back(Of(decision));
  out["turns"] = Json::array();
  for (const CaseTurn& turn : saved.turns) out["turns"].push_back(Of(turn));
  out["held"] = Of(saved.held);
  out["document"] = Of(saved.document);
  out["documents"] = Json::array();
  for (const Document& document : saved.documents) out["documents"].push_back(Of(document));
  std::vector<std::string> lines;
  for (const TermQuad& fact : saved.facts) lines.push_back(Line(fact));
  std::sort(lines.begin(), lines.end());
  out["facts"] = std::move(lines);
  return absl::StrCat(out.dump(1, ' ', false, Json::error_handler_t::replace), "\n");
}

RunCase WithoutOtherWorkflows(RunCase recorded) {
  std::set<std::string> needed;
  const auto need = [&needed](const std::string& text) {
    const cawl::ParsedCawl parsed = cawl::ParseCawl(text, "");
    size_t before = needed.size();
    if (parsed.document == nullptr) return false;
    for (const cawl::Flow& flow : parsed.document->flows) {
      for (const cawl::Node& node : flow.nodes) {
        for (const cawl::Invoke& invoke : node.invokes) {
          for (const auto& [workflow, name] : cawl::StartTargets(invoke.subflow.value))
            needed.insert(workflow);
        }
      }
    }
    return needed.size() > before;
  };
  bool more = need(recorded.document.text);
  while (more) {
    more = false;
    for (const Document& document : recorded.documents) {
      if (document.kind == Document::Kind::kCawl && needed.contains(document.name))
        more = need(document.text) || more;
    }
  }
  std::erase_if(recorded.documents, [&needed](const Document& document) {
    return document.kind == Document::Kind::kCawl && !needed.contains(document.name);
  });
  return recorded;
}

}  // namespace docent::server
