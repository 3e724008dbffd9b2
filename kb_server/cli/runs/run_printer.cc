#include "kb_server/cli/runs/run_printer.h"

#include <algorithm>
#include <iostream>

#include "absl/strings/match.h"
#include "absl/strings/str_split.h"
#include "absl/time/time.h"
#include "graph/base/text.h"

namespace docent::server {
namespace {

void PrintLines(const char* title, const std::string& text, const Presenter& presenter) {
  if (text.empty()) return;
  std::cout << "    " << title << "\n";
  for (absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty())) {
    if (!absl::StartsWith(line, "PREFIX")) std::cout << "      " << presenter.Line(FromAbsl(line)) << "\n";
  }
}

void PrintNode(const v1::Node& node, const Presenter& presenter) {
  std::cout << "  " << node.name() << "  " << presenter.State(node.state());
  if (node.since_us() > 0) std::cout << " since " << LocalTime(node.since_us(), "%H:%M:%S");
  if (!node.reason().empty()) std::cout << "  (" << presenter.Line(node.reason()) << ")";
  std::cout << "\n";
  PrintLines("waits for", node.waits_for(), presenter);
  PrintLines("fired because", node.fired_because(), presenter);
  for (const v1::Invocation& invocation : node.invocations()) {
    std::cout << "    " << invocation.operation();
    for (const v1::NamedTerm& value : invocation.values())
      std::cout << "  for " << value.name() << " = " << presenter.Of(value.value());
    std::cout << "  " << presenter.State(invocation.state());
    if (!invocation.robot().empty()) std::cout << "  on " << presenter.Iri(invocation.robot());
    if (!invocation.step().empty()) std::cout << "  step " << invocation.step();
    if (invocation.state() == "running")
      std::cout << "  " << static_cast<int>(invocation.progress() * 100) << " %";
    if (!invocation.reason().empty()) std::cout << "  (" << presenter.Line(invocation.reason()) << ")";
    std::cout << "\n";
    for (const v1::InvocationStep& step : invocation.steps())
      std::cout << "      " << step.step() << "  " << presenter.State(step.state()) << "\n";
    for (const v1::AwaitedRobot& robot : invocation.awaits()) {
      std::cout << "      " << presenter.Iri(robot.robot()) << " is " << presenter.State(robot.state());
      if (!robot.held_by().empty()) std::cout << ", held by " << robot.held_by();
      std::cout << "\n";
    }
  }
}

}  // namespace

std::string LocalTime(int64_t time_us, const char* format) {
  if (time_us == 0) return "";
  return absl::FormatTime(format, absl::FromUnixMicros(time_us), absl::LocalTimeZone());
}

std::string StateOf(const v1::Run& run) {
  if (run.state() != "running") return run.state();
  if (run.paused()) return "paused";
  const bool incident = std::any_of(run.nodes().begin(), run.nodes().end(),
                                    [](const v1::Node& node) { return node.state() == "incident"; });
  return incident ? "incident" : run.state();
}

void PrintRun(const v1::Run& run, const Presenter& presenter) {
  std::cout << run.id() << "  " << presenter.State(StateOf(run)) << "  workflow " << run.workflow()
            << "  started " << LocalTime(run.started_us(), "%H:%M:%S");
  if (run.ended_us() > 0) std::cout << "  ended " << LocalTime(run.ended_us(), "%H:%M:%S");
  if (!run.reason().empty()) std::cout << "  (" << presenter.Line(run.reason()) << ")";
  std::cout << "\n";
  for (const v1::NamedTerm& variable : run.variables()) {
    std::cout << "  $" << variable.name() << " = " << presenter.Of(variable.value()) << "\n";
  }
  for (const v1::NamedTerm& result : run.results())
    std::cout << "  result " << result.name() << " = " << presenter.Of(result.value()) << "\n";
  for (const v1::Node& node : run.nodes()) PrintNode(node, presenter);
  if (run.texts_cut()) std::cerr << "long texts, which end with …, are not shown whole; a query gives them\n";
}

}  // namespace docent::server
