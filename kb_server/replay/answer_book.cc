#include "kb_server/replay/answer_book.h"

#include <algorithm>

namespace docent::server {

AnswerBook::AnswerBook(const RunCase& recorded) {
  std::map<CommandId, std::vector<std::pair<const CaseTurn*, const CommandReport*>>> reports;
  for (const CaseTurn& turn : recorded.turns) {
    for (const CommandReport& report : turn.reports) reports[report.command].emplace_back(&turn, &report);
  }
  std::set<CommandId> cancelled;
  for (const Decision& decision : recorded.course.decisions) {
    if (decision.kind == Decision::Kind::kCancel) cancelled.insert(decision.command);
  }
  for (const Decision& decision : recorded.course.decisions) {
    if (decision.kind != Decision::Kind::kCommand) continue;
    commands_[{decision.node, decision.operation}].push_back(
        {&decision, reports[decision.command], false, cancelled.contains(decision.command)});
  }
}

bool AnswerBook::Answer(const Decision& command, std::vector<DueReport>* due) {
  const auto known = commands_.find({command.node, command.operation});
  if (known == commands_.end()) return false;
  std::vector<Recorded>& all = known->second;
  auto match = std::find_if(all.begin(), all.end(), [&](const Recorded& recorded) {
    return !recorded.used && recorded.command->robot == command.robot &&
           recorded.command->arguments == command.arguments;
  });
  if (match == all.end())
    match = std::find_if(all.begin(), all.end(), [](const Recorded& recorded) { return !recorded.used; });
  if (match == all.end()) return false;
  match->used = true;
  if (match->cancelled) cancelled_.insert(command.command);
  const bool same_turn = match->command->turn == command.turn && match->command->time_us == command.time_us;
  for (const auto& [turn, recorded] : match->reports) {
    DueReport report{same_turn ? turn->offset : 0,
                     command.time_us + (turn->time_us - match->command->time_us), *recorded};
    report.report.command = command.command;
    due->push_back(std::move(report));
  }
  return true;
}

bool AnswerBook::WasCancelled(const CommandId& played) const {
  return cancelled_.contains(played);
}

}  // namespace docent::server
