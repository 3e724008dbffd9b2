#include "kb_server/cli/runs/replay_printer.h"

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "graph/base/text.h"
#include "kb_server/cli/runs/run_printer.h"

namespace docent::server {
namespace {

std::string NameOf(const v1::ReplayedNode& node) {
  return node.node().empty() ? "the run" : node.node();
}

std::string Call(const v1::ReplayStep& command, const Presenter& presenter) {
  std::vector<std::string> arguments;
  for (const v1::NamedTerm& argument : command.arguments())
    arguments.push_back(absl::StrCat(argument.name(), "=", presenter.Of(argument.value())));
  return absl::StrCat(command.operation(), "(", absl::StrJoin(arguments, ", "), ") to ",
                      presenter.Iri(command.robot()));
}

// "opened in turn 12, sent moveToUser(…) to expo:R01, done in turn 15"
std::string StatesOf(const google::protobuf::RepeatedPtrField<v1::ReplayStep>& steps,
                     const Presenter& presenter) {
  std::vector<std::string> parts;
  for (const v1::ReplayStep& step : steps) {
    if (!step.operation().empty())
      parts.push_back(absl::StrCat("sent ", Call(step, presenter)));
    else if (step.state() == "running")
      parts.push_back(absl::StrCat("opened in turn ", step.turn()));
    else if (step.state() != "waiting" && step.state() != "inactive")
      parts.push_back(absl::StrCat(step.state(), " in turn ", step.turn()));
  }
  // A node of a sub-flow stands for all runs of it that the same node started.
  std::vector<std::pair<std::string, int>> counted;
  for (std::string& part : parts) {
    const auto same = std::find_if(counted.begin(), counted.end(),
                                   [&part](const auto& other) { return other.first == part; });
    if (same == counted.end())
      counted.emplace_back(std::move(part), 1);
    else
      ++same->second;
  }
  return absl::StrJoin(counted, ", ", [](std::string* out, const auto& part) {
    absl::StrAppend(out, part.first);
    if (part.second > 1) absl::StrAppend(out, " (", part.second, " times)");
  });
}

void PrintAsk(const std::string& indent, const std::string& ask, const std::string& missing,
              const Presenter& presenter) {
  if (ask.empty()) return;
  std::cout << indent << "waits for\n";
  for (absl::string_view line : absl::StrSplit(ask, '\n', absl::SkipEmpty())) {
    if (!absl::StartsWith(line, "PREFIX"))
      std::cout << indent << "  " << presenter.Line(FromAbsl(line)) << "\n";
  }
  if (!missing.empty()) std::cout << indent << "lacks " << presenter.Line(missing) << "\n";
}

void PrintNode(const v1::ReplayedNode& node, const Presenter& presenter, const std::string& indent) {
  std::cout << indent << NameOf(node) << "\n";
  for (const v1::ReplayDifference& difference : node.differences()) {
    std::cout << indent << "  turn " << difference.turn() << ", " << difference.kind() << "\n";
    std::cout << indent << "    recorded: "
              << (difference.recorded().empty() ? "nothing" : presenter.Line(difference.recorded())) << "\n";
    std::cout << indent << "    replayed: " << presenter.Line(difference.replayed()) << "\n";
  }
  PrintAsk(indent + "  ", node.waits_for(), node.missing(), presenter);
}

}  // namespace

void PrintDifferences(const v1::ReplayReply& reply, const Presenter& presenter, const char* indent) {
  for (const v1::ReplayedNode& node : reply.nodes()) {
    if (!node.same()) PrintNode(node, presenter, indent);
  }
  if (!reply.stopped().empty()) {
    std::cout << indent << "the replay ended in turn " << reply.stopped_turn();
    if (!reply.stopped_node().empty()) std::cout << " at " << reply.stopped_node();
    std::cout << ": " << presenter.Line(reply.stopped()) << "\n";
  }
  for (const std::string& note : reply.notes())
    std::cout << indent << "note: " << presenter.Line(note) << "\n";
}

void PrintReplay(const v1::ReplayReply& reply, const Presenter& presenter) {
  std::cout << reply.run() << " of " << reply.workflow() << ", turns " << reply.first_turn() << " to "
            << reply.last_turn() << ", " << LocalTime(reply.started_us(), "%Y-%m-%d %H:%M:%S") << ": "
            << (reply.same() ? "the same" : "differs") << "\n";
  if (!reply.same()) {
    std::cout << "first difference: " << NameOf(reply.nodes(0)) << ", in turn "
              << reply.nodes(0).differences(0).turn() << "\n\n";
    PrintDifferences(reply, presenter, "");
    std::cout << "\n";
  }
  for (const v1::ReplayedNode& node : reply.nodes()) {
    if (node.same())
      std::cout << NameOf(node) << "  the same: " << StatesOf(node.replayed(), presenter) << "\n";
  }
  if (!reply.same()) return;
  for (const std::string& note : reply.notes()) std::cout << "note: " << presenter.Line(note) << "\n";
}

void PrintTrial(const v1::TryNodeRequest& request, const v1::TryNodeReply& reply,
                const Presenter& presenter) {
  std::cout << request.run() << "/" << request.node() << " on the facts of turn " << reply.turn() << ": "
            << (reply.opens() ? "opens" : "does not open") << "\n";
  for (const v1::NamedTerm& variable : reply.variables())
    std::cout << "  $" << variable.name() << " = " << presenter.Of(variable.value()) << "\n";
  for (const v1::NamedTerm& binding : reply.bindings())
    std::cout << "  ?" << binding.name() << " = " << presenter.Of(binding.value())
              << "  (of the condition)\n";
  for (const v1::ReplayStep& command : reply.commands())
    std::cout << "  would send " << Call(command, presenter) << "\n";
  if (!reply.pending().empty())
    std::cout << "  sends nothing yet: " << presenter.Line(reply.pending()) << "\n";
  if (reply.state() == "failed") std::cout << "  fails: " << presenter.Line(reply.reason()) << "\n";
  PrintAsk("  ", reply.waits_for(), reply.missing(), presenter);
}

}  // namespace docent::server
