// The matches of a condition that open its node, and the robots that they name.
//
// Where a condition leaves ?robot free, the robots of its matches are the candidates for the node's invocations: of those that
// can serve now, ext:choose or the default order takes one, and its first match opens the node. Of a node with ext:forEach so
// for each value; a value whose robots all serve others is not left out, its invocation waits.
#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {
namespace {

std::string KeyOf(const TermBinding& match, const std::vector<std::string>& names) {
  std::string key;
  for (const std::string& name : names) {
    const auto value = match.find(name);
    absl::StrAppend(&key, value == match.end() ? "UNDEF" : ToNTriples(value->second), " ");
  }
  return key;
}

// Facts of one round with which a condition is compared one by one; more may be about anything.
constexpr size_t kWritesCompared = 64;

// Runs that ask again in one round.
constexpr size_t kAskAtOnce = 64;

}  // namespace

std::string ShowBinding(const TermBinding& binding) {
  return absl::StrJoin(binding, ", ", [](std::string* out, const auto& pair) {
    absl::StrAppend(out, pair.first, " = ", ToDisplay(pair.second));
  });
}

// Those that do not open the node now wait: for a robot that can take them, or until they are gone.
void RunStepper::TakeEvents(ArmedCondition* armed) {
  auto edge = core_.edges.find(armed->handle);
  if (!armed->ask.by_event() || edge == core_.edges.end()) return;
  for (const TermBinding& gone : edge->second->disappeared) armed->waiting_events.erase(gone);
  armed->waiting_events.insert(edge->second->appeared.begin(), edge->second->appeared.end());
  core_.event_waits.SetHolds(armed->handle, !armed->waiting_events.empty());
}

size_t RunStepper::MostSolutions(size_t index) const {
  return flow_.nodes[index].for_each.empty() ? kSolutionLimit : kEachLimit;
}

// The solutions with which a condition can open its node now.
absl::StatusOr<std::vector<TermBinding>> RunStepper::Solutions(size_t index,
                                                               const ArmedCondition& armed) const {
  const size_t most = MostSolutions(index);
  std::vector<TermBinding> all;
  std::vector<TermBinding> fixed;
  if (!armed.ask.by_event()) {
    if (core_.input->conditions->Holds(armed.handle)) fixed.emplace_back();
  } else {
    fixed.assign(armed.waiting_events.begin(), armed.waiting_events.end());
  }
  for (const TermBinding& binding : fixed) {
    auto solutions = core_.input->conditions->Solutions(armed.handle, binding, most);
    if (absl::IsResourceExhausted(solutions.status())) return solutions.status();
    if (solutions.ok()) std::move(solutions->begin(), solutions->end(), std::back_inserter(all));
    if (all.size() >= most) break;
  }
  if (all.size() > most) all.resize(most);
  return all;
}

// Whether something that runs wrote in this round may change the answer, which is that of before.
bool RunStepper::HasToAskAgain(const ArmedCondition& armed) const {
  const std::vector<FactWrite>& writes = core_.output->writes;
  if (writes.empty()) return false;
  const bool may_open =
      armed.ask.by_event() ? !armed.waiting_events.empty() : core_.input->conditions->Holds(armed.handle);
  return may_open && core_.MayHaveChanged(armed.handle);
}

bool Engine::Core::MayHaveChanged(ConditionHandle handle) const {
  const std::vector<FactWrite>& writes = output->writes;
  return writes.size() > kWritesCompared ||
         std::any_of(writes.begin(), writes.end(), [&](const FactWrite& write) {
           return input->conditions->MayChange(handle, write.quad);
         });
}

// In a round to come. A turn in which many ask one after the other goes on in the next one.
void RunStepper::AskAgain() {
  if (core_.turn_round < core_.limits.engine_rounds_per_turn / 4)
    core_.asking.emplace(core_.RankOf(run_), run_.id);
  else
    core_.unfinished.insert(run_.id);
}

void Engine::Core::TouchAsking() {
  const size_t most = turn_round < limits.engine_rounds_per_turn / 4 ? kAskAtOnce : asking.size();
  for (size_t left = most; left > 0 && !asking.empty(); --left) {
    touched.insert(asking.begin()->second);
    asking.erase(asking.begin());
  }
}

// Whether the robot can serve the node now. A node without operations needs a robot that no other run has.
RunStepper::Fitness RunStepper::FitnessOf(size_t index, const RobotId& robot, const RunId& root) const {
  if (!core_.ledger.IsFree(robot, root)) return Fitness::kServesOthers;
  for (const cawl::Invoke& invoke : flow_.nodes[index].invokes) {
    if (invoke.operation.value.empty()) continue;
    const rsel::PlanPtr plan = core_.PlanOf(invoke.operation.value);
    for (const rsel::PlanStep& step : plan->steps) {
      const RobotOffer* offer = core_.OfferOf(step.operation, robot);
      if (offer == nullptr || offer->offline) return Fitness::kOffersNot;
      if (&step == &plan->steps[0] && !core_.OutOfService(*offer).empty()) return Fitness::kServesOthers;
    }
    if (core_.Bars(robot, root) != nullptr) return Fitness::kServesOthers;
  }
  return Fitness::kFree;
}

// Of robots that can serve, the one that the document or the default query prefers. `given`: values beside those of the run.
// The goal is the first of `inputs` that is a resource.
RobotId RunStepper::BestOf(const std::string& choose, const std::vector<std::string>& inputs,
                           const TermBinding& given, std::vector<RobotId> able) const {
  if (able.size() < 2 || core_.input->ranking == nullptr) return able.front();
  TermBinding values;
  if (!choose.empty()) {  // the names of the default query are its own
    values = run_.variables;
    for (const auto& [name, value] : given) values.insert_or_assign(name, value);
  }
  for (const std::string& name : inputs) {
    const std::optional<Term> value = Value(name, &given);
    if (value && value->IsIri() && values.emplace("goal", *value).second) break;
  }
  // Without a goal, one that has no place: an open ?goal would be every thing that has one.
  if (choose.empty()) values.emplace("goal", Term::Iri(std::string(kRdfType)));
  return core_.input->ranking->Best(choose, able, values);
}

// Of candidates of a node that is to open, by its first invoke that says how to choose, or the first one.
RobotId RunStepper::BestFor(size_t index, const TermBinding& given, std::vector<RobotId> able) const {
  const std::vector<cawl::Invoke>& invokes = flow_.nodes[index].invokes;
  if (invokes.empty() || able.size() < 2) return able.front();
  std::sort(able.begin(), able.end());
  auto invoke = std::find_if(invokes.begin(), invokes.end(),
                             [](const cawl::Invoke& each) { return !each.choose.empty(); });
  if (invoke == invokes.end()) {
    invoke = std::find_if(invokes.begin(), invokes.end(),
                          [](const cawl::Invoke& each) { return !each.operation.value.empty(); });
  }
  if (invoke == invokes.end()) return BestOf("", {}, given, std::move(able));
  std::vector<std::string> inputs = core_.PlanOf(invoke->operation.value)->inputs;
  if (inputs.empty()) {
    const RobotOffer* offer = core_.OfferOf(invoke->operation.value, able.front());
    inputs = offer != nullptr && offer->inputs ? *offer->inputs : PartsWithValue(index, given);
  }
  return BestOf(invoke->choose, inputs, given, std::move(able));
}

// One of matches that all have the same value of forEach. `taken`: robots that other values have.
RunStepper::Choice RunStepper::ChooseMatch(size_t index, const std::vector<TermBinding>& matches,
                                           const std::set<RobotId>& taken) const {
  const RunId root = core_.RootOf(run_);
  std::map<Fitness, std::vector<RobotId>> candidates;
  std::map<RobotId, const TermBinding*> firsts;
  for (const TermBinding& match : matches) {
    const auto value = match.find("robot");
    if (value == match.end()) return {Fitness::kFree, match};
    const RobotId robot(value->second.lexical);
    if (firsts.emplace(robot, &match).second) candidates[FitnessOf(index, robot, root)].push_back(robot);
  }
  auto& [fitness, able] = *candidates.begin();
  const bool spread =
      !flow_.nodes[index].sequential &&
      !std::all_of(able.begin(), able.end(), [&](auto& robot) { return taken.contains(robot); });
  if (spread) std::erase_if(able, [&](const RobotId& robot) { return taken.contains(robot); });
  TermBinding given = *firsts.at(able.front());  // what the matches have in common
  for (const RobotId& robot : able) {
    std::erase_if(given, [&](const auto& value) {
      const auto other = firsts.at(robot)->find(value.first);
      return other == firsts.at(robot)->end() || other->second != value.second;
    });
  }
  return {fitness, *firsts.at(BestFor(index, given, able))};
}

// The matches that open the node: one for each value of ext:forEach, or one. Without any that can: none, and robots
// that serve others are added to `busy`.
std::vector<TermBinding> RunStepper::ChooseMatches(size_t index, const ArmedCondition& armed,
                                                   std::vector<TermBinding> solutions,
                                                   std::set<RobotId>* busy) const {
  const std::vector<std::string>& for_each = flow_.nodes[index].for_each;
  const std::vector<std::string>& names = for_each.empty() ? armed.ask.event_variables : for_each;
  const RobotId& wanted = run_.nodes[index].wanted_robot;
  std::vector<std::vector<TermBinding>> groups;
  std::map<std::string, size_t> places;
  for (TermBinding& solution : solutions) {
    const auto robot = solution.find("robot");
    if (robot != solution.end() && !wanted.empty() && robot->second.lexical != wanted.value()) continue;
    const auto [place, is_new] = places.emplace(KeyOf(solution, names), groups.size());
    if (is_new) groups.emplace_back();
    groups[place->second].push_back(std::move(solution));
  }
  const bool each_robot = std::count(for_each.begin(), for_each.end(), "robot") > 0;
  std::set<RobotId> taken;
  std::map<Fitness, std::vector<TermBinding>> chosen;
  std::vector<TermBinding> all;
  for (const std::vector<TermBinding>& group : groups) {
    Choice choice = ChooseMatch(index, group, taken);
    if (for_each.empty() && choice.fitness == Fitness::kFree) return {std::move(choice.match)};
    if (const auto robot = choice.match.find("robot"); robot != choice.match.end())
      taken.insert(RobotId(robot->second.lexical));
    chosen[choice.fitness].push_back(choice.match);
    all.push_back(std::move(choice.match));
  }
  if (all.empty() || each_robot || (chosen.contains(Fitness::kFree) && !for_each.empty())) return all;
  if (!chosen.contains(Fitness::kServesOthers)) {
    if (for_each.empty()) all.resize(1);  // it waits for a robot that comes back
    return all;
  }
  const RunId root = core_.RootOf(run_);
  for (const std::vector<TermBinding>& group : groups) {
    for (const TermBinding& match : group) {
      const auto robot = match.find("robot");
      if (robot == match.end()) continue;
      RobotId id(robot->second.lexical);
      if (FitnessOf(index, id, root) == Fitness::kServesOthers) busy->insert(std::move(id));
    }
  }
  return {};
}

// Robots of solutions that cannot be used, because they serve other runs or take no commands, are added to `busy`.
bool RunStepper::TryOpenWith(size_t index, const ArmedCondition& armed, std::set<RobotId>* busy) {
  absl::StatusOr<std::vector<TermBinding>> solutions = Solutions(index, armed);
  if (!solutions.ok()) {
    GiveUp(index, solutions.status());
    return true;
  }
  if (solutions->size() == kEachLimit) {
    GiveUp(index, TooManyBindings());
    return true;
  }
  const std::vector<TermBinding> chosen = ChooseMatches(index, armed, *std::move(solutions), busy);
  if (chosen.empty()) return false;
  std::string evidence = core_.input->conditions->Evidence(armed.handle, chosen.front());
  std::string cause = absl::StrCat("condition ", armed.ask.name, " holds");
  if (!chosen.front().empty()) absl::StrAppend(&cause, " with ", ShowBinding(chosen.front()));
  Open(index, chosen, std::move(evidence), cause, &armed);
  return true;
}

}  // namespace docent::engine
