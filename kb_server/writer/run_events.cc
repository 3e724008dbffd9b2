#include "kb_server/writer/run_events.h"

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "workflow/engine/state/ports.h"

namespace docent::server {
namespace {

// An event of that turn about "RUN/NODE/…".
RunEvent NewEvent(const log::TurnRecord& record, const std::string& subject) {
  std::vector<std::string> parts = absl::StrSplit(subject, absl::MaxSplits('/', 2));
  RunEvent event;
  event.revision = Revision(record.offset);
  event.time_us = record.time_us;
  event.run = parts[0];
  if (parts.size() > 1) event.node = NameOfSegment(parts[1]);
  if (event.run == engine::kActivatorSubject && parts.size() == 2) {  // node: the workflow
    event.run.clear();
    event.kind = "activator";
    return event;
  }
  event.kind = parts.size() == 1 ? "run" : parts.size() == 2 ? "node" : "invocation";
  return event;
}

}  // namespace

std::vector<RunEvent> EventsOf(const log::TurnRecord& record) {
  std::vector<RunEvent> events;
  // What the turn was told, then what it decided.
  for (const CommandReport& report : record.batch.reports) {
    if (report.outcome == CommandReport::Outcome::kProgress) continue;
    static constexpr const char* kOutcomes[] = {"accepted",    "progress",  "succeeded",
                                                "failed",      "cancelled", "unknown",
                                                "unreachable", "refused",   "not begun"};
    RunEvent& event = events.emplace_back(NewEvent(record, report.command.value()));
    event.kind = "report";
    event.to = kOutcomes[static_cast<int>(report.outcome)];
    event.detail = absl::StrCat(report.command.value(), report.message.empty() ? "" : ": ", report.message);
  }
  for (const Transition& transition : record.transitions) {
    RunEvent& event = events.emplace_back(NewEvent(record, transition.subject));
    event.from = transition.from;
    event.to = transition.to;
    event.detail = transition.cause;
    if (event.kind == "node" && event.node.starts_with('$')) event.kind = "variable";
    if (event.kind == "invocation") event.detail = absl::StrCat(transition.subject, ": ", transition.cause);
  }
  for (const RobotCommand& command : record.commands) {
    RunEvent& event = events.emplace_back(NewEvent(record, command.id.value()));
    event.kind = "command";
    event.to = "sent";
    event.detail = log::ToDisplay(command);
  }
  return events;
}

uint64_t IgnoredFirings(const log::TurnRecord& record) {
  const std::string begin = Concat(engine::kActivatorSubject, "/");
  return static_cast<uint64_t>(
      std::count_if(record.transitions.begin(), record.transitions.end(), [&](const Transition& transition) {
        return transition.subject.starts_with(begin) &&
               (transition.to == "ignored" || transition.to == "failed");
      }));
}

bool TellsProgress(const log::TurnRecord& record) {
  const auto& reports = record.batch.reports;
  return std::any_of(reports.begin(), reports.end(), [](const CommandReport& report) {
    return report.outcome == CommandReport::Outcome::kProgress;
  });
}

}  // namespace docent::server
