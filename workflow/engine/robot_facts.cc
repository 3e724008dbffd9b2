#include "workflow/engine/robot_facts.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "workflow/engine/run_facts.h"

namespace docent::engine {
namespace {

std::string InvocationIri(const CommandOwner& owner, const Run& run) {
  return absl::StrCat(RunIri(run.id), "/", IriSegment(run.Flow().nodes[owner.node].name.value), "/",
                      owner.invocation);
}

}  // namespace

std::vector<Quad> RobotFacts(const RobotId& robot, Engine::Core* core) {
  std::vector<Quad> facts;
  const RunId* holder = core->ledger.Holder(robot);
  const auto used = core->last_used.find(robot);
  const size_t load = core->ledger.Tasks(robot).size() + core->waiting.WaitingFor(robot);
  if (holder == nullptr && used == core->last_used.end() && load == 0) return facts;
  Dictionary& dictionary = core->run_terms.dictionary();
  const TermId subject = dictionary.InternIri(robot.value());
  const auto say = [&](RunTerm predicate, TermId object) {
    facts.push_back(
        {subject, core->run_terms.Of(predicate), object, core->run_terms.Of(RunTerm::kRunsGraph)});
  };
  if (used != core->last_used.end()) say(RunTerm::kLastUsed, dictionary.Intern(DateTimeTerm(used->second)));
  if (load > 0) say(RunTerm::kLoad, dictionary.Intern(Term::Integer(static_cast<int64_t>(load))));
  if (holder == nullptr) {
    std::sort(facts.begin(), facts.end());
    return facts;
  }
  say(RunTerm::kHeldBy, dictionary.InternIri(RunIri(*holder)));
  for (const auto& [owner, occupies] : core->ledger.Tasks(robot)) {
    if (const auto run = core->runs.find(owner.run); run != core->runs.end())
      say(RunTerm::kHeldFor, dictionary.InternIri(InvocationIri(owner, run->second)));
  }
  for (const CommandId& id : core->ledger.EndingOn(robot)) {
    const EndingCommand& ending = core->ledger.ending().at(id);
    say(RunTerm::kHeldFor, dictionary.InternIri(RunIri(RunId(ending.invocation))));
    say(RunTerm::kEndingCommand, dictionary.Intern(Term::Literal(id.value())));
  }
  std::sort(facts.begin(), facts.end());
  facts.erase(std::unique(facts.begin(), facts.end()), facts.end());
  return facts;
}

void TellRobots(Engine::Core* core) {
  static const std::vector<Quad> kNothing;
  core->changed_robots.merge(core->waiting.TakeChanged());
  for (const RobotId& robot : core->changed_robots) {
    const auto told = core->robot_facts.find(robot);
    const FactsPtr before = told == core->robot_facts.end() ? nullptr : told->second;
    auto facts = std::make_shared<const std::vector<Quad>>(RobotFacts(robot, core));
    core->undo_robot_facts.try_emplace(robot, before);
    DiffFacts(before ? *before : kNothing, *facts, &core->output->add, &core->output->remove);
    if (facts->empty())
      core->robot_facts.erase(robot);
    else
      core->robot_facts[robot] = std::move(facts);
  }
  core->changed_robots.clear();
}

// Robots that runs outside of this engine hold.
void Engine::HoldForOthers(std::map<RobotId, RunId> holds) {
  for (const auto& [robot, run] : std::exchange(core_->held_by_others, std::move(holds))) {
    const RunId* holder = core_->ledger.Holder(robot);
    if (holder != nullptr && *holder == run) core_->ledger.Release(robot);
  }
  for (const auto& [robot, run] : core_->held_by_others) core_->ledger.Hold(robot, run);
  core_->services_changed = true;  // what waits for a robot is looked at again
}

}  // namespace docent::engine
