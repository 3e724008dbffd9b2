#include "workflow/engine/state/run_state.h"

namespace docent::engine {

TermBinding GivenTo(const InvocationState& invocation) {
  TermBinding given = invocation.inputs;
  given.insert(invocation.binding.begin(), invocation.binding.end());  // of both, the input stays
  return given;
}

std::string_view ToString(WorkState state) {
  switch (state) {
    case WorkState::kInactive:
      return "inactive";
    case WorkState::kWaiting:
      return "waiting";
    case WorkState::kPending:
      return "pending";
    case WorkState::kRunning:
      return "running";
    case WorkState::kDone:
      return "done";
    case WorkState::kFailed:
      return "failed";
    case WorkState::kSkipped:
      return "skipped";
    case WorkState::kCancelled:
      return "cancelled";
    case WorkState::kIncident:
      return "incident";
  }
  return "";
}

std::string_view ToString(Stopped why) {
  switch (why) {
    case Stopped::kNo:
      return "";
    case Stopped::kByPause:
      return "its run was paused";
    case Stopped::kWithRobot:
      return "its robot was taken out of service";
  }
  return "";
}

}  // namespace docent::engine
