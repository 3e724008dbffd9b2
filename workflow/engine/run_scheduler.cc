#include "workflow/engine/run_scheduler.h"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "workflow/engine/activator_modes.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/service_workflow.h"

namespace docent::engine {
namespace {

// A run ended: its robots may be free, and its parent goes on.
void Settle(Engine::Core* core, const Run& ended) {
  core->released.insert(ended.robots.begin(), ended.robots.end());
  core->waiting.Block(core->RankOf(ended), ended.id, {});
  ActivatedRunEnded(core, ended.id);
  if (ended.parent.empty()) core->EndReservations(ended.id);
  if (ServiceOf(*ended.document).empty()) core->EndReservationsOf(ended.document->name.value);
  if (ended.parent.empty()) return;
  if (Run* parent = core->Mutable(ended.parent)) {
    RunStepper(core, parent).ChildEnded({ended.parent, ended.parent_node, ended.parent_invocation}, ended);
    core->touched.insert(ended.parent);
  }
}

void TouchTree(Engine::Core* core, const RunId& root) {
  const auto tree = core->trees.find(root);
  if (tree != core->trees.end()) core->touched.insert(tree->second.begin(), tree->second.end());
}

// Robots of which something became free: those that no run holds any more go to `freed`, of the others the holder's own runs
// go on.
void Release(Engine::Core* core, std::map<RobotId, uint64_t>* freed) {
  for (const RobotId& robot : std::exchange(core->released, {})) {
    core->FreeIfOver(robot);
    const RunId* holder = core->ledger.Holder(robot);
    if (holder == nullptr)
      freed->emplace(robot, 0);
    else
      TouchTree(core, *holder);
  }
}

// Offers each robot that was freed to the oldest run that could use it and was not asked yet. `freed`: robot
// → number of the run that was asked last.
void Offer(Engine::Core* core, std::map<RobotId, uint64_t>* freed) {
  for (auto it = freed->begin(); it != freed->end();) {
    const RobotId& robot = it->first;
    auto offers = [core, &robot](const std::string& operation) {
      std::string why_not;
      rsel::PlanPtr plan = core->PlanOf(operation);
      return !core->RobotsFor(*plan, Term::Iri(robot.value()), RunId(), {}, &why_not).empty();
    };
    std::optional<std::pair<uint64_t, RunId>> next;
    if (core->ledger.Holder(robot) == nullptr) next = core->waiting.Next(robot, it->second, offers);
    while (next && core->BarsRun(robot, next->second)) next = core->waiting.Next(robot, next->first, offers);
    if (!next) {
      it = freed->erase(it);
      continue;
    }
    it->second = next->first;
    core->touched.insert(next->second);
    ++it;
  }
}

}  // namespace

void RecallFromOutOfService(Engine::Core* core) {
  std::map<RunId, std::set<RobotId>> recalled;
  for (const auto& [robot, root] : core->ledger.holders()) {
    for (const auto& [owner, occupies] : core->ledger.Tasks(robot)) {
      const auto run = core->runs.find(owner.run);
      if (run == core->runs.end()) continue;
      for (const OpenCommand& open : run->second.nodes[owner.node].invocations[owner.invocation].commands) {
        if (open.recalled != Stopped::kNo || open.IsEnding()) continue;
        const RobotOffer* offer = core->OfferOf(open.command.operation, robot);
        if (offer != nullptr && !offer->out_of_service.empty()) recalled[owner.run].insert(robot);
      }
    }
  }
  for (const auto& [run, robots] : recalled) {
    for (const RobotId& robot : robots)
      RunStepper(core, core->Mutable(run)).RecallCommands(Stopped::kWithRobot, &robot);
  }
}

void ReconsiderWaiting(Engine::Core* core) {
  core->waiting.ForEachWish([core](const RobotWish& wish) {
    std::optional<Term> wanted;
    if (!wish.robot.empty()) wanted = Term::Iri(wish.robot.value());
    std::string why_not;
    const std::vector<RobotId> able =
        core->RobotsFor(*core->PlanOf(wish.operation), wanted, RunId(), {}, &why_not);
    core->released.insert(able.begin(), able.end());
    // Beside the younger ones that are looked at now, lest these take what the oldest wait for.
    for (const CommandOwner& owner : core->waiting.Oldest(wish, able.size())) core->touched.insert(owner.run);
    if (!able.empty()) why_not = std::string(kAllServeOthers);
    std::vector<CommandOwner> oldest = core->waiting.Oldest(wish, 1);
    const Run& first = core->runs.at(oldest[0].run);
    const std::string& reason = first.nodes[oldest[0].node].invocations[oldest[0].invocation].reason;
    // What its own run is the reason of is no news for the others.
    const std::set<std::string_view> own = {kAtAnotherStep, kAttemptNotEnded, kComesLater, kHoldsNot};
    bool news = reason != why_not && !own.contains(reason);
    if (!news) return;
    for (const CommandOwner& owner : core->waiting.Oldest(wish, SIZE_MAX)) core->touched.insert(owner.run);
  });
  // Each of them has a reason of its own.
  for (const CommandOwner& owner : core->waiting.barred()) core->touched.insert(owner.run);
  for (const auto& [robot, root] : core->ledger.holders()) {
    TouchTree(core, root);
    core->coveted.insert(robot);  // a robot may say that it has ended a step after its command has
  }
  for (const RobotId& robot : core->waiting.BlockedRobots()) core->released.insert(robot);
}

void AdvanceAll(Engine::Core* core) {
  std::map<RobotId, uint64_t> freed;
  while (true) {
    // before runs go on: a robot between two steps goes to a more urgent run
    for (const RobotId& robot : std::set<RobotId>(core->released)) core->Preempt(robot);
    for (const RobotId& robot : std::exchange(core->coveted, {})) core->Preempt(robot);
    if (!core->released.empty() && !core->preempted.empty()) {
      Release(core, &freed);
      Offer(core, &freed);  // now, so that the more urgent run is advanced first
    }
    std::map<uint64_t, RunId>
        work;  // the most urgent and oldest run first: no run waits for a robot behind those that came later
    for (const RunId& id : core->touched) {
      if (auto it = core->runs.find(id); it != core->runs.end()) work.emplace(core->RankOf(it->second), id);
    }
    core->touched.clear();
    for (const auto& [number, id] : work) {
      if (Run* run = core->Mutable(id)) RunStepper(core, run).Advance();
    }
    for (const RunId& id : std::exchange(core->ended, {})) Settle(core, core->runs.at(id));
    Release(core, &freed);
    if (core->touched.empty()) Offer(core, &freed);
    if (core->touched.empty() && core->coveted.empty() && core->ended.empty()) return;
  }
}

}  // namespace docent::engine
