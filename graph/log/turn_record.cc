#include "graph/log/turn_record.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace docent::log {
namespace {

constexpr size_t kDifferencesShown = 5;  // one wrong decision shifts all later ones: the first few are enough

template <typename Entry>
size_t Compare(const char* what, const std::vector<Entry>& recorded, const std::vector<Entry>& derived,
               std::string* text) {
  size_t differences = 0;
  for (size_t i = 0; i < std::max(recorded.size(), derived.size()); ++i) {
    const Entry* left = i < recorded.size() ? &recorded[i] : nullptr;
    const Entry* right = i < derived.size() ? &derived[i] : nullptr;
    if (left != nullptr && right != nullptr && *left == *right) continue;
    if (++differences > kDifferencesShown) continue;
    absl::StrAppend(text, what, " ", i + 1, "\n  recorded: ", left ? ToDisplay(*left) : "none",
                    "\n  derived:  ", right ? ToDisplay(*right) : "none", "\n");
  }
  if (differences > kDifferencesShown) {
    absl::StrAppend(text, "and ", differences - kDifferencesShown, " more ", what, "s\n");
  }
  return differences;
}

}  // namespace

std::optional<std::string> DecisionDifference(const TurnRecord& recorded, const TurnRecord& derived) {
  std::string text;
  const size_t differences = Compare("transition", recorded.transitions, derived.transitions, &text) +
                             Compare("command", recorded.commands, derived.commands, &text);
  if (differences == 0) return std::nullopt;
  return text;
}

std::string ToDisplay(const Transition& transition) {
  return absl::StrCat(transition.subject, " ", transition.from.empty() ? "new" : transition.from, " → ",
                      transition.to,
                      transition.cause.empty() ? "" : absl::StrCat(" (because ", transition.cause, ")"));
}

std::string ToDisplay(const RobotCommand& command) {
  std::string arguments;
  for (const auto& [name, value] : command.arguments) {
    absl::StrAppend(&arguments, arguments.empty() ? "" : ", ", name, "=", ToDisplay(value));
  }
  return absl::StrCat(command.id.value(), " to ", ToDisplay(Term::Iri(command.robot.value())), ": ",
                      command.operation, "(", arguments, "), guard as of ", command.guard_revision.value(),
                      ", deadline ", command.deadline_us, " us, ",
                      command.expected_incarnation.empty()
                          ? "any incarnation"
                          : absl::StrCat("incarnation ", command.expected_incarnation),
                      command.idempotent ? ", idempotent" : "");
}

}  // namespace docent::log
