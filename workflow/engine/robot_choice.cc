// Which robots can serve an invocation now, and what holds them.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/docent_iris.h"
#include "workflow/engine/engine_core.h"

namespace docent::engine {

int Engine::Core::DepthOf(const Run& run) const {
  int depth = 0;
  for (const Run* at = &run; !at->parent.empty(); ++depth) {
    auto it = runs.find(at->parent);
    if (it == runs.end()) break;
    at = &it->second;
  }
  return depth;
}

bool Engine::Core::IsInside(const Run& run, const cawl::Document& document, size_t flow) const {
  const Run* at = &run;
  while (at->document->name.value != document.name.value ||
         at->Flow().name.value != document.flows[flow].name.value) {
    const auto parent = runs.find(at->parent);
    if (at->parent.empty() || parent == runs.end()) return false;
    at = &parent->second;
  }
  return true;
}

RunId Engine::Core::RootOf(const Run& run) const {
  if (!run.root.empty()) return run.root;
  const Run* root = &run;
  while (!root->parent.empty()) {
    auto it = runs.find(root->parent);
    if (it == runs.end()) break;
    root = &it->second;
  }
  return root->id;
}

std::vector<CommandOwner> Engine::Core::OwnersOf(const CommandOwner& owner) const {
  std::vector<CommandOwner> owners = {owner};
  for (auto run = runs.find(owner.run); run != runs.end() && !run->second.parent.empty();
       run = runs.find(run->second.parent)) {
    owners.push_back({run->second.parent, run->second.parent_node, run->second.parent_invocation});
  }
  return owners;
}

void Engine::Core::Hold(const RobotId& robot, const Run& run) {
  ledger.Hold(robot, RootOf(run));
  changed_robots.insert(robot);
  for (RunId id = run.id; !id.empty();) {
    Run* holder = Mutable(id);
    if (holder == nullptr) break;
    holder->robots.insert(robot);
    id = holder->parent;
  }
}

void Engine::Core::Used(const RobotId& robot) {
  const auto [last, is_new] = last_used.try_emplace(robot, input->now_us);
  undo_last_used.try_emplace(robot, is_new ? std::nullopt : std::make_optional(last->second));
  last->second = input->now_us;
  changed_robots.insert(robot);
}

void Engine::Core::LetEnd(const OpenCommand& open, const CommandOwner& owner) {
  if (!open.overdue_until_us) output->cancels.push_back(open.command.id);
  commands.erase(open.command.id.value());
  const Run& run = runs.at(owner.run);
  EndingCommand ending{open.command, open.occupies, RootOf(run), "", OwnersOf(owner), input->now_us};
  ending.invocation = absl::StrCat(run.id.value(), "/", IriSegment(run.Flow().nodes[owner.node].name.value),
                                   "/", owner.invocation);
  changed_robots.insert(open.command.robot);
  ledger.Await(std::move(ending));
}

bool Engine::Core::FreeIfOver(const RobotId& robot) {
  const RunId* holder = ledger.Holder(robot);
  if (holder == nullptr || ledger.Awaits(robot)) return false;
  if (const auto other = held_by_others.find(robot);
      other != held_by_others.end() && other->second == *holder)
    return false;
  const auto run = runs.find(*holder);
  const bool live = run != runs.end() && run->second.state == WorkState::kRunning;
  if (live && run->second.robots.contains(robot))
    return false;  // not if it was let go (RunStepper::LetRobotsGo)
  ledger.Release(robot);
  changed_robots.insert(robot);
  return true;
}

RobotWish Engine::Core::WishOf(const Run& run, const CommandOwner& owner) const {
  const InvocationState& invocation = run.nodes[owner.node].invocations[owner.invocation];
  RobotWish wish;
  wish.operation = run.Flow().nodes[owner.node].invokes[invocation.invoke].operation.value;
  if (invocation.state == WorkState::kRunning) {
    wish.robot = invocation.robot;  // it is pre-empted, and goes on with its own
    return wish;
  }
  for (const TermBinding* binding : {&invocation.inputs, &invocation.binding, &run.variables}) {
    auto robot = binding->find("robot");
    if (robot == binding->end()) continue;
    wish.robot = RobotId(robot->second.lexical);
    break;
  }
  return wish;
}

void Engine::Core::Reblock(const Run& run) {
  std::set<RobotId> robots;
  for (const NodeState& node : run.nodes) robots.insert(node.busy_robots.begin(), node.busy_robots.end());
  waiting.Block(RankOf(run), run.id, robots);
}

const RobotOffer* Engine::Core::OfferOf(const std::string& operation, const RobotId& robot) const {
  const std::vector<RobotOffer>& offers = input->robots->Offers(operation);
  const auto offer =
      std::lower_bound(offers.begin(), offers.end(), robot,
                       [](const RobotOffer& o, const RobotId& wanted) { return o.robot < wanted; });
  return offer == offers.end() || offer->robot != robot ? nullptr : &*offer;
}

const RobotOffer* Engine::Core::OfferFor(const std::string& operation, const RobotId& robot,
                                         const CommandOwner& self, std::string* lacks) const {
  const RobotOffer* first = OfferOf(operation, robot);
  const auto run = runs.find(self.run);
  if (first == nullptr || !CapabilityOf(operation) || run == runs.end()) return first;
  const TermBinding given = GivenTo(run->second.nodes[self.node].invocations[self.invocation]);
  const std::vector<RobotOffer>& offers = input->robots->Offers(operation);
  for (const RobotOffer* offer = first; offer != offers.data() + offers.size() && offer->robot == robot;
       ++offer) {
    if (!offer->inputs) return offer;
    const auto missing =
        std::find_if(offer->inputs->begin(), offer->inputs->end(), [&](const std::string& name) {
          return !given.contains(name) && !run->second.variables.contains(name);
        });
    if (missing == offer->inputs->end()) return offer;
    if (lacks != nullptr)
      *lacks = absl::StrCat(ToDisplay(Term::Iri(robot.value())), " would do ", offer->operation,
                            ", which takes ", *missing, ", and ", *missing, " has no value");
  }
  return nullptr;
}

Occupation Engine::Core::OccupationOf(const rsel::Plan& plan, const RobotId& robot,
                                      const CommandOwner& self) const {
  std::optional<Occupation> all;
  for (const rsel::PlanStep& step : plan.steps) {
    const RobotOffer* offer = OfferFor(step.operation, robot, self);
    const Occupation of_step = offer == nullptr ? Occupation() : offer->occupies;
    all = all ? Both(*all, of_step) : of_step;
  }
  return all.value_or(Occupation());
}

std::string Engine::Core::OutOfService(const RobotOffer& offer) const {
  if (offer.offline) return "is offline";
  if (!offer.out_of_service.empty()) return offer.out_of_service;
  if (!offer.busy || ledger.Awaits(offer.robot)) return "";
  for (const auto& [owner, occupies] : ledger.Tasks(offer.robot)) {
    const auto run = runs.find(owner.run);
    if (run == runs.end()) continue;
    if (!run->second.nodes[owner.node].invocations[owner.invocation].commands.empty()) return "";
  }
  return "is busy with something of its own";
}

std::vector<const RobotOffer*> Engine::Core::OnlineFor(const rsel::Plan& plan,
                                                       const std::optional<Term>& wanted,
                                                       const CommandOwner& self, std::string* why_not) const {
  std::vector<const RobotOffer*> online;  // of the first step
  for (size_t i = 0; i < plan.steps.size(); ++i) {
    const std::string& operation = plan.steps[i].operation;
    const bool by_class = CapabilityOf(operation).has_value();
    std::string lacks;
    const auto serves = [&](const RobotOffer& offer) {
      return !offer.offline && (!by_class || OfferFor(operation, offer.robot, self, &lacks) != nullptr);
    };
    if (i == 0) {
      for (const RobotOffer& offer : input->robots->Offers(operation)) {
        const bool again =
            !online.empty() && online.back()->robot == offer.robot;  // by another operation of the class
        if (!again && (!wanted || wanted->lexical == offer.robot.value()) && serves(offer))
          online.push_back(&offer);
      }
    } else {
      std::erase_if(online, [&](const RobotOffer* robot) {
        const RobotOffer* offer = OfferOf(operation, robot->robot);
        return offer == nullptr || !serves(*offer);
      });
    }
    if (!online.empty()) continue;
    if (!lacks.empty())
      *why_not = lacks;
    else if (wanted)
      *why_not = absl::StrCat(ToDisplay(*wanted), " is offline or does not offer ",
                              by_class ? "an operation of class " : "", operation);
    else if (i == 0)
      *why_not = absl::StrCat("no robot that is online offers ", by_class ? "an operation of class " : "",
                              operation);
    else
      *why_not = absl::StrCat("no single robot that is online offers all of ", plan.process);
    break;
  }
  return online;
}

std::vector<RobotId> Engine::Core::RobotsFor(const rsel::Plan& plan, const std::optional<Term>& wanted,
                                             const RunId& root, const CommandOwner& self,
                                             std::string* why_not) const {
  std::vector<const RobotOffer*> able = OnlineFor(plan, wanted, self, why_not);
  if (able.empty()) return {};
  std::erase_if(able, [&](const RobotOffer* offer) { return !ledger.IsFree(offer->robot, root); });
  if (able.empty()) *why_not = std::string(kAllServeOthers);
  std::erase_if(able, [&](const RobotOffer* offer) {
    const Reservation* reservation = Bars(offer->robot, root);
    if (reservation != nullptr)
      *why_not = absl::StrCat(ToDisplay(Term::Iri(offer->robot.value())), " ", ShowReservation(*reservation));
    return reservation != nullptr;
  });
  std::erase_if(able, [&](const RobotOffer* offer) {
    const std::string why = OutOfService(*offer);
    if (!why.empty()) *why_not = absl::StrCat(ToDisplay(Term::Iri(offer->robot.value())), " ", why);
    return !why.empty();
  });
  std::erase_if(able, [&](const RobotOffer* offer) {
    const bool occupied = ledger.HasWork(offer->robot) &&
                          ledger.Occupied(offer->robot, OccupationOf(plan, offer->robot, self), self);
    if (occupied) *why_not = std::string(kAtAnotherStep);
    return occupied;
  });
  std::vector<RobotId> robots;
  robots.reserve(able.size());
  for (const RobotOffer* offer : able) robots.push_back(offer->robot);
  return robots;
}

}  // namespace docent::engine
