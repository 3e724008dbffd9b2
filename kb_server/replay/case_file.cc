#include "kb_server/replay/case_file.h"

#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/time/time.h"
#include "graph/base/gzip.h"
#include "kb_server/replay/saved_words.h"
#include "nlohmann/json.hpp"

namespace docent::server {
namespace {

using Json = nlohmann::ordered_json;

std::string Show(TimeMicros time_us) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%E*SZ", absl::FromUnixMicros(time_us), absl::UTCTimeZone());
}

std::string Line(const TermQuad& quad) {
  const std::string graph = quad.graph == Term() ? "" : absl::StrCat(" ", ToNTriples(quad.graph));
  return absl::StrCat(ToNTriples(quad.subject), " ", ToNTriples(quad.predicate), " ", ToNTriples(quad.object),
                      graph, " .");
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

Json Of(const CommandReport& report) {
  Json out = {{"command", report.command.value()}, {"outcome", WordOf(report.outcome)}};
  if (!report.message.empty()) out["message"] = report.message;
  if (report.progress != 0) out["progress"] = report.progress;
  if (!report.incarnation.empty()) out["incarnation"] = report.incarnation;
  if (!report.results.empty()) out["results"] = Values(report.results);
  return out;
}

Json Of(const RunRequest& request) {
  Json out = {{"kind", WordOf(request.kind)}};
  const auto put = [&out](const char* name, const std::string& value) {
    if (!value.empty()) out[name] = value;
  };
  put("target", request.target);
  put("node", request.node);
  put("robot", request.robot);
  put("reason", request.reason);
  if (!request.arguments.empty()) out["values"] = Values(request.arguments);
  if (request.cancels_commands) out["cancelsCommands"] = true;
  if (request.compensates) out["compensates"] = true;
  return out;
}

Json Of(const SensorReading& reading) {
  Json out = {{"sensor", reading.sensor}, {"value", ToNTriples(reading.value)}};
  if (reading.time_us != 0) out["time"] = Show(reading.time_us);
  return out;
}

void Add(const WriteBatch& batch, Json* out) {
  Json& turn = *out;
  if (!batch.source.empty()) turn["source"] = batch.source;
  if (batch.mode == WriteBatch::Mode::kLoad) turn["loads"] = true;
  if (batch.lifetime_ms != 0) turn["lifetimeMs"] = batch.lifetime_ms;
  if (batch.clock_tick) turn["tick"] = true;
  for (const QuadOperation& operation : batch.operations)
    turn["facts"].push_back(
        absl::StrCat(operation.kind == QuadOperation::Kind::kAdd ? "+ " : "- ", Line(operation.quad)));
  for (const SensorReading& reading : batch.readings) turn["readings"].push_back(Of(reading));
  for (const Document& document : batch.documents) turn["documents"].push_back(Of(document));
  for (const CommandReport& report : batch.reports) turn["reports"].push_back(Of(report));
  for (const RunRequest& request : batch.run_requests) turn["requests"].push_back(Of(request));
}

Json Of(const CaseTurn& turn) {
  Json out = {{"turn", turn.offset}, {"time", Show(turn.time_us)}};
  Add(turn.batch, &out);
  if (turn.due_us) out["due"] = *turn.due_us;
  if (!turn.asked.empty()) out["asksFor"] = turn.asked;
  if (!turn.asked_no_more.empty()) out["asksNoMore"] = turn.asked_no_more;
  return out;
}

// In lines that version control can show.
Json Packed(const std::string& bytes) {
  constexpr size_t kLine = 120;
  const std::string text = absl::Base64Escape(Gzip(bytes));
  Json lines = Json::array();
  for (size_t at = 0; at < text.size(); at += kLine) lines.push_back(text.substr(at, kLine));
  return lines;
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
  out["document"] = Of(saved.document);
  out["nested"] = Json::object();
  for (const auto& [run, path] : saved.nested) out["nested"][run.value()] = path;
  out["state"] = Packed(saved.state);
  return absl::StrCat(out.dump(1, ' ', false, Json::error_handler_t::replace), "\n");
}

}  // namespace docent::server
