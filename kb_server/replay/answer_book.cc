#include "kb_server/replay/answer_book.h"

#include <algorithm>

#include "absl/strings/numbers.h"

namespace docent::server {
namespace {

// The id of a command is its attempt, "@" and the time at which it was sent.
std::string AttemptOf(const CommandId& id) {
  return id.value().substr(0, id.value().rfind('@'));
}
TimeMicros SentAt(const CommandId& id) {
  TimeMicros time_us = 0;
  const size_t at = id.value().rfind('@');
  return at != std::string::npos && absl::SimpleAtoi(id.value().substr(at + 1), &time_us) ? time_us : 0;
}

}  // namespace

AnswerBook::AnswerBook(const RunCase& recorded) {
  std::set<CommandId> cancelled;
  for (const Decision& decision : recorded.course.decisions) {
    if (decision.kind == Decision::Kind::kCancel) cancelled.insert(decision.command);
  }
  for (const Decision& decision : recorded.course.decisions) {
    if (decision.kind != Decision::Kind::kCommand) continue;
    own_.insert(decision.command);
    commands_[{decision.node, decision.operation}].push_back(
        {&decision, false, cancelled.contains(decision.command)});
  }
  for (const CaseTurn& turn : recorded.turns) {
    for (const CommandReport& report : turn.batch.reports) {
      reports_[report.command].emplace_back(&turn, &report);
      // A report about a command that nobody has sent by then is of none.
      if (!own_.contains(report.command) && SentAt(report.command) <= turn.time_us)
        others_.emplace(AttemptOf(report.command), report.command);
    }
  }
}

bool AnswerBook::Answer(const Decision& command, std::vector<DueReport>* due) {
  const auto known = commands_.find({command.node, command.operation});
  if (known == commands_.end()) return false;
  std::vector<Recorded>& all = known->second;
  const auto find = [&all](auto matches) {
    return std::find_if(all.begin(), all.end(), [&](const Recorded& recorded) {
      return !recorded.used && matches(*recorded.command);
    });
  };
  auto match = find([&](const Decision& recorded) { return recorded.command == command.command; });
  if (match == all.end())
    match = find([&](const Decision& recorded) {
      return recorded.robot == command.robot && recorded.arguments == command.arguments;
    });
  if (match == all.end()) match = find([](const Decision&) { return true; });
  if (match == all.end()) return false;
  match->used = true;
  if (match->cancelled) cancelled_.insert(command.command);
  const Decision& recorded = *match->command;
  if (recorded.turn == command.turn && recorded.time_us == command.time_us) {
    played_.emplace(recorded.command, command.command);
    return true;
  }
  for (const auto& [turn, report] : reports_[recorded.command]) {
    DueReport moved{command.time_us + (turn->time_us - recorded.time_us), *report};
    moved.report.command = command.command;
    due->push_back(std::move(moved));
  }
  return true;
}

void AnswerBook::AnswerOther(const RobotCommand& command, TimeMicros now_us, std::vector<DueReport>* due) {
  const auto known = others_.find(AttemptOf(command.id));
  if (known == others_.end() || reports_.contains(command.id)) return;  // told in the recorded turns
  for (const auto& [turn, report] : reports_[known->second]) {
    DueReport moved{now_us + std::max<TimeMicros>(0, turn->time_us - SentAt(known->second)), *report};
    moved.report.command = command.id;
    due->push_back(std::move(moved));
  }
}

std::optional<CommandReport> AnswerBook::Told(const CommandReport& recorded) const {
  if (!own_.contains(recorded.command)) return recorded;
  const auto played = played_.find(recorded.command);
  if (played == played_.end()) return std::nullopt;
  CommandReport told = recorded;
  told.command = played->second;
  return told;
}

void AnswerBook::Drop(const CommandId& played) {
  std::erase_if(played_, [&played](const auto& entry) { return entry.second == played; });
}

bool AnswerBook::WasCancelled(const CommandId& played) const {
  return cancelled_.contains(played);
}

}  // namespace docent::server
