#include "workflow/rsel/instruction_handler.h"

#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "workflow/rsel/type_checks.h"

namespace docent::rsel {

InstructionHandler::InstructionHandler(PlanPtr plan, Arguments values)
    : plan_(std::move(plan)), values_(std::move(values)), steps_(plan_->steps.size()) {}

absl::StatusOr<InstructionHandler> InstructionHandler::Start(PlanPtr plan, const Arguments& arguments) {
  Arguments values;
  for (const std::string& input : plan->inputs) {
    if (auto it = arguments.find(input); it != arguments.end()) values.insert(*it);
  }
  if (absl::Status status = CheckComplete(*plan, plan->input_types, values); !status.ok()) return status;
  return InstructionHandler(std::move(plan), std::move(values));
}

absl::StatusOr<InstructionHandler> InstructionHandler::Restore(PlanPtr plan, Saved saved) {
  if (saved.steps.size() != plan->steps.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat("the state of ", saved.steps.size(), " steps of a plan of ", plan->steps.size()));
  }
  InstructionHandler handler(std::move(plan), std::move(saved.values));
  handler.steps_ = std::move(saved.steps);
  handler.state_ = saved.state;
  handler.reason_ = std::move(saved.reason);
  return handler;
}

bool InstructionHandler::HasMoreAttempts(int step) const {
  return steps_[step - 1].attempt <= plan_->steps[step - 1].retry;
}

std::vector<Instruction> InstructionHandler::TakeReady(
    const std::function<bool(const PlanStep&)>& may_begin) {
  std::vector<Instruction> out;
  Advance();
  for (int step = 1; step <= static_cast<int>(steps_.size()) && !ended(); ++step) {
    StepStatus& status = steps_[step - 1];
    if (status.state != StepState::kReady) continue;
    const PlanStep& plan_step = plan_->steps[step - 1];
    Instruction instruction;
    instruction.step = step;
    instruction.attempt = status.attempt + 1;
    instruction.label = Label(step);
    instruction.operation = plan_step.operation;
    instruction.timeout_ms = plan_step.timeout_ms;
    std::string missing;
    for (const auto& [part, source] : plan_step.inputs) {
      std::optional<Term> value = Value(source);
      if (value) {
        instruction.arguments.emplace_back(part, *std::move(value));
      } else if (missing.empty()) {
        missing =
            absl::StrCat("its part ", part, " takes result ", source.slot, ", which that step did not give");
      }
    }
    if (!missing.empty()) {
      // No attempt can change that. Whether the process goes on is the step's onFailure.
      if (plan_step.on_failure == Invoke::OnFailure::kContinue) {
        EndStep(step, StepState::kFailed);
        std::vector<Instruction> more = TakeReady(may_begin);
        out.insert(out.end(), more.begin(), more.end());
        break;
      }
      Fail(step, missing);
      break;
    }
    if (may_begin && !may_begin(plan_step)) continue;
    status.state = StepState::kRunning;
    status.attempt = instruction.attempt;
    status.reported = false;
    out.push_back(std::move(instruction));
  }
  // Instructions of the same call that come before a failing one were never given.
  if (state_ == State::kFailed) {
    for (const Instruction& instruction : out) steps_[instruction.step - 1].reported = true;
    out.clear();
  }
  return out;
}

bool InstructionHandler::Succeeded(int step, int attempt, const Arguments& results) {
  if (step < 1 || step > static_cast<int>(steps_.size())) return false;
  StepStatus& status = steps_[step - 1];
  if (status.reported || status.attempt != attempt) return false;
  status.reported = true;
  if (status.state != StepState::kRunning) return false;
  for (const auto& [part, value] : results) values_[absl::StrCat(step, ".", part)] = value;
  EndStep(step, StepState::kDone);
  return true;
}

bool InstructionHandler::Failed(int step, int attempt, std::string reason, bool may_retry) {
  if (step < 1 || step > static_cast<int>(steps_.size())) return false;
  StepStatus& status = steps_[step - 1];
  if (status.reported || status.attempt != attempt) return false;
  status.reported = true;
  if (status.state != StepState::kRunning) return false;
  const PlanStep& plan_step = plan_->steps[step - 1];
  if (may_retry && status.attempt <= plan_step.retry) {
    status.state = StepState::kReady;
  } else if (plan_step.on_failure == Invoke::OnFailure::kContinue) {
    EndStep(step, StepState::kFailed);
  } else {
    Fail(step, reason);
  }
  return true;
}

bool InstructionHandler::SucceededLate(int step, const Arguments& results) {
  if (step < 1 || step > static_cast<int>(steps_.size())) return false;
  StepStatus& status = steps_[step - 1];
  if (status.state == StepState::kDone) return false;
  status.state = StepState::kDone;
  status.reported = true;
  for (const auto& [part, value] : results) values_[absl::StrCat(step, ".", part)] = value;
  for (size_t i = 0; i < steps_.size(); ++i) {
    const bool left_out =
        steps_[i].state == StepState::kFailed && plan_->steps[i].on_failure == Invoke::OnFailure::kContinue;
    if (steps_[i].state != StepState::kDone && !left_out) return true;
  }
  state_ = State::kDone;
  reason_.clear();
  return true;
}

void InstructionHandler::Cancel(std::string reason) {
  if (ended()) return;
  state_ = State::kCancelled;
  reason_ = std::move(reason);
  for (StepStatus& status : steps_) {
    if (status.state != StepState::kDone && status.state != StepState::kFailed)
      status.state = StepState::kCancelled;
  }
}

Arguments InstructionHandler::Results() const {
  Arguments out;
  if (plan_->document.empty()) {  // an operation itself: all that it gave
    constexpr std::string_view kOfItsStep = "1.";
    for (const auto& [slot, value] : values_) {
      if (slot.starts_with(kOfItsStep)) out.emplace(slot.substr(kOfItsStep.size()), value);
    }
  }
  for (const auto& [part, source] : plan_->outputs) {
    if (std::optional<Term> value = Value(source)) out.emplace(part, *std::move(value));
  }
  return out;
}

std::vector<std::pair<int, int>> InstructionHandler::RunningSteps() const {
  std::vector<std::pair<int, int>> out;
  for (size_t i = 0; i < steps_.size(); ++i) {
    if (!steps_[i].reported) out.emplace_back(static_cast<int>(i) + 1, steps_[i].attempt);
  }
  return out;
}

std::string InstructionHandler::Label(int step) const {
  return absl::StrCat(step, "/", steps_.size(), " ", plan_->steps[step - 1].path);
}

std::optional<Term> InstructionHandler::Value(const PlanSource& source) const {
  if (source.constant) return source.constant;
  auto it = values_.find(source.slot);
  if (it == values_.end()) return std::nullopt;
  return it->second;
}

// Marks as ready what waits for nothing any more.
void InstructionHandler::Advance() {
  if (ended()) return;
  for (size_t i = 0; i < steps_.size(); ++i) {
    if (steps_[i].state != StepState::kPending) continue;
    const std::vector<int>& after = plan_->steps[i].after;
    bool free = std::all_of(after.begin(), after.end(), [this](int before) {
      return steps_[before].state == StepState::kDone || steps_[before].state == StepState::kFailed;
    });
    if (free) steps_[i].state = StepState::kReady;
  }
}

void InstructionHandler::EndStep(int step, StepState state) {
  steps_[step - 1].state = state;
  bool all = std::all_of(steps_.begin(), steps_.end(), [](const StepStatus& s) {
    return s.state == StepState::kDone || s.state == StepState::kFailed;
  });
  if (all) {
    state_ = State::kDone;
  } else {
    Advance();
  }
}

void InstructionHandler::Fail(int step, const std::string& reason) {
  state_ = State::kFailed;
  reason_ = absl::StrCat(Label(step), ": ", reason);
  for (StepStatus& status : steps_) {
    if (status.state != StepState::kDone && status.state != StepState::kFailed)
      status.state = StepState::kCancelled;
  }
  steps_[step - 1].state = StepState::kFailed;
}

}  // namespace docent::rsel
