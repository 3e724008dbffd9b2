// Priorities of runs, and pre-emption: a robot between two steps of a run goes to one that is more urgent.
//
// A run tree has the priority of its outermost run. Where a robot becomes free, the run of the highest priority gets it, of
// these the oldest. A run with ext:preempt also takes a robot from a run tree of lower priority, at a step border: when no
// command of that tree to the robot is under way or ending. What the robot did there stays as it is: the invocation keeps
// its steps that are done, waits for the same robot, and goes on with the next step when it has it again.
//
// An invocation is pre-empted while it is running with a robot that its run does not have (Run::robots).
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/rdf/docent_iris.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {
namespace {

// Numbers of runs are below this.
constexpr int kNumberBits = 40;

bool IsPreempted(const Run& run, const InvocationState& invocation) {
  return invocation.state == WorkState::kRunning && invocation.handler &&
         !run.robots.contains(invocation.robot);
}

}  // namespace

void Engine::Core::InheritPriority(Run* run) const {
  const auto root = runs.find(run->root);
  const Run& outermost = root == runs.end() ? *run : root->second;
  const cawl::Urgency urgency = cawl::UrgencyOf(*outermost.document, outermost.Flow());
  run->priority = urgency.priority;
  run->preempts = urgency.preempts;
}

// The smaller, the sooner it gets a robot.
uint64_t Engine::Core::RankOf(const Run& run) const {
  return static_cast<uint64_t>(cawl::kMaxPriority - run.priority) << kNumberBits | run.number;
}

// Whether the robot could serve all of the plan, if it were free.
bool Engine::Core::CouldServe(const rsel::Plan& plan, const RobotId& robot) const {
  return std::all_of(plan.steps.begin(), plan.steps.end(), [&](const rsel::PlanStep& step) {
    const RobotOffer* offer = OfferOf(step.operation, robot);
    return offer != nullptr && OutOfService(*offer).empty();
  });
}

void Engine::Core::Covet(const Run& run, const std::string& operation, const std::optional<Term>& wanted) {
  if (!run.preempts) return;
  const rsel::PlanPtr plan = PlanOf(operation);
  for (const RobotOffer& offer : input->robots->Offers(plan->steps[0].operation)) {
    if (!wanted || wanted->lexical == offer.robot.value()) coveted.insert(offer.robot);
  }
}

void Engine::Core::Preempt(const RobotId& robot) {
  const RunId* holder = ledger.Holder(robot);
  if (waiting.empty() || holder == nullptr || ledger.Awaits(robot) || preempted.contains(robot)) return;
  const auto from = runs.find(*holder);
  if (from == runs.end() || from->second.state != WorkState::kRunning) return;
  for (const auto& [owner, occupies] : ledger.Tasks(robot)) {
    const auto run = runs.find(owner.run);
    if (run == runs.end() || !run->second.nodes[owner.node].invocations[owner.invocation].commands.empty())
      return;
  }
  const auto could = [&](const std::string& operation) { return CouldServe(*PlanOf(operation), robot); };
  const uint64_t end = static_cast<uint64_t>(cawl::kMaxPriority - from->second.priority) << kNumberBits;
  for (auto next = waiting.Next(robot, 0, could, end); next;
       next = waiting.Next(robot, next->first, could, end)) {
    const auto to = runs.find(next->second);
    if (to == runs.end() || !to->second.preempts || Bars(robot, RootOf(to->second)) != nullptr) continue;
    return TakeFrom(from->second.id, robot, to->second);
  }
}

void Engine::Core::TakeFrom(const RunId& root, const RobotId& robot, const Run& by) {
  preempted.insert(robot);
  const std::string why = absl::StrCat("pre-empted: ", ToDisplay(Term::Iri(robot.value())),
                                       " is taken by run ", by.id.value(), ", of priority ", by.priority);
  const std::map<CommandOwner, Occupation> tasks = ledger.Tasks(robot);
  const std::set<RunId> tree = trees.at(root);
  for (const RunId& id : tree) {
    if (Run* run = Mutable(id)) run->robots.erase(robot);
  }
  if (tasks.empty()) Say(root.value(), "running", "running", why);  // between two nodes
  for (const auto& [owner, occupies] : tasks) {
    Run* run = Mutable(owner.run);
    InvocationState& invocation = run->nodes[owner.node].invocations[owner.invocation];
    ledger.End(robot, owner);
    invocation.reason = why;
    invocation.deadline_us = run->Flow().nodes[owner.node].invokes[invocation.invoke].timeout_ms
                                 ? invocation.deadline_us
                                 : std::nullopt;
    Say(absl::StrCat(run->id.value(), "/", IriSegment(run->Flow().nodes[owner.node].name.value), "/",
                     owner.invocation),
        "running", "running", why);
    waiting.Wait(RankOf(*run), owner, WishOf(*run, owner));
  }
  ledger.Release(robot);
  changed_robots.insert(robot);
  released.insert(robot);
}

// False: the robot of the invocation serves a more urgent run. One that is free again is taken back.
bool RunStepper::HasItsRobot(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  if (!IsPreempted(run_, invocation)) return true;
  const CommandOwner self{run_.id, node, index};
  const std::string& operation = flow_.nodes[node].invokes[invocation.invoke].operation.value;
  if (!core_.ledger.IsFree(invocation.robot, core_.RootOf(run_)) ||
      core_.Bars(invocation.robot, core_.RootOf(run_)) != nullptr ||
      core_.ledger.Occupied(invocation.robot, invocation.occupies, self) ||
      !core_.CouldServe(*core_.PlanOf(operation), invocation.robot)) {
    core_.waiting.Wait(core_.RankOf(run_), self, core_.WishOf(run_, self));
    return false;
  }
  core_.waiting.Leave(self);
  core_.Hold(invocation.robot, run_);
  core_.ledger.Begin(invocation.robot, self, invocation.occupies);
  invocation.reason.clear();
  core_.Say(Subject(node, index), "running", "running",
            absl::StrCat("goes on with ", ToDisplay(Term::Iri(invocation.robot.value()))));
  return true;
}

void Engine::Core::RebuildTask(const Run& run, const CommandOwner& owner) {
  const InvocationState& invocation = run.nodes[owner.node].invocations[owner.invocation];
  if (IsPreempted(run, invocation))
    waiting.Wait(RankOf(run), owner, WishOf(run, owner));
  else
    ledger.Begin(invocation.robot, owner, invocation.occupies);
}

}  // namespace docent::engine
