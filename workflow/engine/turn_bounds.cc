#include "workflow/engine/turn_bounds.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/run_limits.h"
#include "graph/base/workflow_limits.h"

namespace docent::engine {

void TurnBounds::Clear() {
  *this = TurnBounds();
}

bool TurnBounds::spent() const {
  return work_ >= kRunLimits.node_changes_per_turn;
}

std::string TurnBounds::WhyNotFire(const std::string& workflow, int rounds) const {
  if (runs_ >= kRunLimits.runs_started_per_turn) {
    return absl::StrCat("activators have started ", runs_,
                        " runs in this turn; the limit runs_started_per_turn is ",
                        kRunLimits.runs_started_per_turn);
  }
  if (firings_ >= kWorkflowLimits.firings_per_turn) {
    return absl::StrCat("activators have fired ", firings_,
                        " times in this turn; the limit firings_per_turn is ",
                        kWorkflowLimits.firings_per_turn);
  }
  const auto known = activated_.find(workflow);
  if (known == activated_.end() || known->second.last == round_) return "";
  // Late in a turn one more start is enough to react to what others did.
  const bool late = round_ > rounds / 2;
  if (known->second.rounds < kRunLimits.activation_rounds_per_turn && !late) return "";
  return absl::StrCat(
      "it has started runs in ", known->second.rounds,
      " rounds of this turn, so its own runs, or rules that read them, start it again; the limits are "
      "activation_rounds_per_turn = ",
      kRunLimits.activation_rounds_per_turn, " and half of engine_rounds_per_turn = ", rounds);
}

void TurnBounds::Started(const std::string& workflow) {
  ++runs_;
  Activated& activated = activated_[workflow];
  if (activated.last == round_) return;
  activated.last = round_;
  ++activated.rounds;
}

void TurnBounds::NotStarted(const std::string& workflow, const std::string& match, const std::string& why,
                            bool of_turn) {
  const auto [missed, is_first] = missed_.try_emplace(workflow, Missed{match, why, 0, of_turn});
  if (is_first) return;
  ++missed->second.more;
  missed->second.of_turn |= of_turn;
}

std::map<std::string, TurnBounds::Missed> TurnBounds::TakeMissed() {
  if (missed_.empty()) return {};
  return std::exchange(missed_, {});
}

}  // namespace docent::engine
