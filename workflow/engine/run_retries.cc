// How a further attempt begins: after ext:retry-delay, and with ext:retry-other-robot elsewhere.
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {
namespace {

// As the longest duration that a document may write.
constexpr double kLongestDelayMs = 720.0 * 3600 * 1000;

}  // namespace

// `retries`: how many further attempts came before `next`, which follows `before`.
void RunStepper::DelayAttempt(const cawl::RetryPolicy& policy, int retries, const InvocationState& before,
                              InvocationState* next) const {
  if (policy.delay_ms) {
    const double delay_ms = static_cast<double>(*policy.delay_ms) * std::pow(policy.backoff, retries);
    next->not_before_us =
        core_.input->now_us + static_cast<int64_t>(std::min(delay_ms, kLongestDelayMs) * 1000);
  }
  if (!policy.other_robot) return;
  next->failed_on = before.failed_on;
  if (!before.robot.empty()) next->failed_on.insert(before.robot);
}

// Whether the delay of its next attempt is not over.
bool RunStepper::IsTooEarly(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  if (!invocation.not_before_us) return false;
  if (*invocation.not_before_us > core_.input->now_us) {
    invocation.reason = std::string(kRetryLater);
    invocation.deadline_us.reset();
    return true;
  }
  invocation.not_before_us.reset();
  return false;
}

// The robots on which it has failed, unless no other that is online offers what it needs.
void RunStepper::LeaveOutFailed(size_t node, size_t index, const rsel::Plan& plan,
                                std::vector<RobotId>* robots, std::string* why_not) const {
  const std::set<RobotId>& failed = run_.nodes[node].invocations[index].failed_on;
  if (failed.empty()) return;
  const auto offers_all = [&](const RobotOffer& offer) {
    return !offer.offline && !failed.contains(offer.robot) &&
           std::all_of(plan.steps.begin(), plan.steps.end(), [&](const rsel::PlanStep& step) {
             return core_.OfferOf(step.operation, offer.robot) != nullptr;
           });
  };
  const std::vector<RobotOffer>& offers = core_.input->robots->Offers(plan.steps[0].operation);
  if (std::none_of(offers.begin(), offers.end(), offers_all)) return;
  std::erase_if(*robots, [&failed](const RobotId& robot) { return failed.contains(robot); });
  if (robots->empty() && why_not->empty())
    *why_not = "it waits for another robot than that on which it failed";
}

}  // namespace docent::engine
