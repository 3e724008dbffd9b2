// Runs one invocation of a robot service: says which operations a robot has to do next, takes their results, and
// ends done or failed. A pure state machine: no time, no input or output, no randomness.
//
// Copyable: a copy goes on independently from the same state. Equal plans, arguments and calls give equal states, so a
// replay of the log comes to the same. Not thread-safe; the writer thread owns it.
//
//   InstructionHandler h = *InstructionHandler::Start(registry.Find("BoothGuide"), {{"user", …}, {"booth", …}});
//   for (const Instruction& i : h.TakeReady()) send(i);
//   … later:  h.Succeeded(step, attempt, results);  for (… : h.TakeReady()) …  until h.state() is final
#ifndef DOCENT_WORKFLOW_RSEL_INSTRUCTION_HANDLER_H_
#define DOCENT_WORKFLOW_RSEL_INSTRUCTION_HANDLER_H_

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/term.h"
#include "workflow/rsel/service_registry.h"

namespace docent::rsel {

using Arguments = std::map<std::string, Term>;  // part name → value

// One operation to be done by the robot now.
struct Instruction {
  int step = 0;       // from 1, in the plan
  int attempt = 0;    // from 1
  std::string label;  // "2/4 moveToBooth": step, number of steps, path
  std::string operation;
  std::vector<std::pair<std::string, Term>> arguments;
  std::optional<int64_t> timeout_ms;  // of this attempt; nullopt: the caller's

  friend bool operator==(const Instruction&, const Instruction&) = default;
};

class InstructionHandler {
 public:
  enum class State { kRunning, kDone, kFailed, kCancelled };
  enum class StepState { kPending, kReady, kRunning, kDone, kFailed, kCancelled };

  // INVALID_ARGUMENT, naming what the service takes: an input part of the plan that `arguments` lacks; more than the plan needs
  // are ignored. Whether the values are of the types of the parts is the caller's to ask (type_checks.h).
  // `plan` must not be null.
  static absl::StatusOr<InstructionHandler> Start(PlanPtr plan, const Arguments& arguments);

  // The instructions that can be given now and were not yet; they count as running from here on.
  // A step whose argument is the missing result of an earlier step fails here. `may_begin` (null: any may) is asked of each
  // in turn; those that may not begin yet stay ready.
  std::vector<Instruction> TakeReady(const std::function<bool(const PlanStep&)>& may_begin = nullptr);
  // Whether the attempt that runs is not the step's last.
  bool HasMoreAttempts(int step) const;

  // What became of an instruction. False, and nothing changed, when that attempt is not running (a late or repeated
  // report). After the end: false, and the instruction is struck off from RunningSteps().
  bool Succeeded(int step, int attempt, const Arguments& results);
  // `may_retry` false: no further attempt even if the step has any left (an unknown outcome of an operation that is
  // not idempotent). When a step fails for good and the process with it, the steps still running count as cancelled:
  // RunningSteps() tells them until they are reported, so that the caller can cancel them.
  bool Failed(int step, int attempt, std::string reason, bool may_retry = true);
  // A step that failed, was cancelled or was not waited for has succeeded all the same. Call it when no further step of the process
  // will begin. The process is done when all its steps are. False for a step that is done already; then nothing changes.
  bool SucceededLate(int step, const Arguments& results);
  // Ends in kCancelled unless it has ended.
  void Cancel(std::string reason);

  // The whole state, to be kept and put back.
  struct StepStatus {
    StepState state = StepState::kPending;
    int attempt = 0;
    bool reported = true;  // no instruction is out
  };
  struct Saved {
    Arguments values;  // slot → value
    std::vector<StepStatus> steps;
    State state = State::kRunning;
    std::string reason;
  };
  Saved Save() const { return {values_, steps_, state_, reason_}; }
  // INVALID_ARGUMENT for a state that is not one of `plan`.
  static absl::StatusOr<InstructionHandler> Restore(PlanPtr plan, Saved saved);

  State state() const { return state_; }
  bool ended() const { return state_ != State::kRunning; }
  // Failed: "2/4 moveToBooth: <reason of the last attempt>". Cancelled: its reason.
  const std::string& reason() const { return reason_; }
  // The values of the process's outputs that there are; of an operation itself, all that it gave. Complete when done.
  Arguments Results() const;

  const Plan& plan() const { return *plan_; }
  const PlanPtr& shared_plan() const { return plan_; }
  StepState step_state(int step) const { return steps_[step - 1].state; }
  int attempt(int step) const { return steps_[step - 1].attempt; }
  // Instructions given and not reported, in step order; also after a failure or Cancel.
  std::vector<std::pair<int, int>> RunningSteps() const;  // step, attempt
  // "2/4 moveToBooth".
  std::string Label(int step) const;

 private:
  InstructionHandler(PlanPtr plan, Arguments values);
  std::optional<Term> Value(const PlanSource& source) const;
  void Advance();
  void EndStep(int step, StepState state);
  void Fail(int step, const std::string& reason);

  PlanPtr plan_;
  Arguments values_;  // slot → value
  std::vector<StepStatus> steps_;
  State state_ = State::kRunning;
  std::string reason_;
};

}  // namespace docent::rsel

#endif  // DOCENT_WORKFLOW_RSEL_INSTRUCTION_HANDLER_H_
