// Why a node did not do in time what it waits for, for people: of a condition, the facts that lack or are in its way, and the
// robots with which it holds; of what the node invokes, what is not done, and the robots that could not begin it.
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/text.h"
#include "workflow/cawl/formula.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {
namespace {

// Of one list, at most: alternatives, parts of one alternative, robots, invocations.
constexpr size_t kShown = 5;

std::string Listed(std::vector<std::string> items, const char* between) {
  const size_t all = items.size();
  if (all > kShown) items.resize(kShown);
  return absl::StrCat(absl::StrJoin(items, between),
                      all > kShown ? absl::StrCat(between, all - kShown, " more") : "");
}

void AddNew(std::string text, std::vector<std::string>* to) {
  if (std::find(to->begin(), to->end(), text) == to->end()) to->push_back(std::move(text));
}

// What keeps one alternative of a condition from being so. Its facts are asked one by one; what is to be absent is in the way where
// it takes away every match of those that are there.
class LackFinder {
 public:
  LackFinder(const cawl::Document& document, const cawl::VariableValues& values, const Limits& limits,
             const FactView& facts)
      : document_(document), values_(values), limits_(limits), facts_(facts) {}

  std::vector<std::string> Of(const cawl::Alternative& alternative) {
    std::vector<std::string> lacks;
    for (const cawl::Event* event : alternative.parts.events)
      AddNew(Concat("it lacks the event ", event->operation.value), &lacks);
    cawl::Conjunction there;
    std::set<std::string> unknown;  // variables of facts that lack
    for (const cawl::Constraint* constraint : alternative.parts.constraints) {
      if (IsThere(*constraint)) {
        there.constraints.push_back(constraint);
        continue;
      }
      AddNew(Concat("it lacks ", Shown(*constraint)), &lacks);
      unknown.merge(OpenVariables(*constraint));
    }
    if (!Holds(there)) {
      if (lacks.empty()) lacks.emplace_back("each of its facts is there, but not together");
      return lacks;
    }
    for (const cawl::Formula& absent : alternative.parts.absent) AddInTheWay(absent, there, unknown, &lacks);
    if (lacks.empty()) {
      lacks.emplace_back(Holds(alternative.parts)
                             ? "each of its facts is there, but not for long enough"
                             : "each of its facts is there, but with each match something is in its way");
    }
    return lacks;
  }

 private:
  using Kind = cawl::Formula::Kind;

  bool Holds(const cawl::Conjunction& parts) const {
    auto ask = cawl::CompileAlternative(document_, {0, nullptr, parts}, values_, limits_);
    if (!ask.ok() || !cawl::ParseAsks(limits_, &*ask).ok()) return false;
    return facts_.Holds(*ask->query).value_or(false);
  }

  bool IsThere(const cawl::Constraint& constraint) {
    const auto [known, is_new] = there_.try_emplace(&constraint, false);
    if (is_new) {
      cawl::Conjunction alone;
      alone.constraints.push_back(&constraint);
      known->second = Holds(alone);
    }
    return known->second;
  }

  // Of an `or`, those of its parts that are in the way. Nothing can be said of what shares a variable with a fact that lacks.
  void AddInTheWay(const cawl::Formula& absent, const cawl::Conjunction& there,
                   const std::set<std::string>& unknown, std::vector<std::string>* lacks) const {
    if (absent.kind == Kind::kOr) {
      for (const cawl::Formula& child : absent.children) AddInTheWay(child, there, unknown, lacks);
      return;
    }
    if (Mentions(absent, unknown)) return;
    cawl::Conjunction without = there;
    without.absent.push_back(absent);
    if (!Holds(without)) AddNew(Concat("in its way is ", Shown(absent)), lacks);
  }

  std::set<std::string> OpenVariables(const cawl::Constraint& constraint) const {
    std::set<std::string> names;
    for (const cawl::Word* word : {&constraint.subject, &constraint.verb, &constraint.object}) {
      const bool open = word->kind == cawl::Word::Kind::kVariable && !values_(word->name);
      if (open || word->kind == cawl::Word::Kind::kFree) names.insert(word->name);
    }
    return names;
  }
  bool Mentions(const cawl::Formula& formula, const std::set<std::string>& names) const {
    if (formula.kind == Kind::kConstraint) {
      const std::set<std::string> own = OpenVariables(*formula.constraint);
      return std::any_of(own.begin(), own.end(), [&](const auto& name) { return names.contains(name); });
    }
    return std::any_of(formula.children.begin(), formula.children.end(),
                       [&](const cawl::Formula& child) { return Mentions(child, names); });
  }

  std::string Shown(const cawl::Formula& formula) const {
    switch (formula.kind) {
      case Kind::kConstraint:
        return Shown(*formula.constraint);
      case Kind::kEvent:
        return Concat("the event ", formula.event->operation.value);
      case Kind::kNot:
        return Concat("not ", Shown(formula.children.at(0)));
      case Kind::kAnd:
      case Kind::kOr:
        break;
    }
    return absl::StrCat("(",
                        absl::StrJoin(formula.children, formula.kind == Kind::kAnd ? " and " : " or ",
                                      [this](std::string* out, const cawl::Formula& child) {
                                        absl::StrAppend(out, Shown(child));
                                      }),
                        ")");
  }

  // As it is written, with values of variables; a time, which is not written as a constraint, as the clock tells it.
  std::string Shown(const cawl::Constraint& constraint) const {
    std::vector<std::string> words;
    for (const cawl::Word* word : {&constraint.subject, &constraint.verb, &constraint.object})
      words.push_back(Shown(*word));
    return absl::StrJoin(words, " ");
  }
  std::string Shown(const cawl::Word& word) const {
    const bool variable =
        word.kind == cawl::Word::Kind::kVariable && word.comparison == cawl::Word::Comparison::kNone;
    if (const auto now = variable ? values_(word.name) : std::nullopt) return ToDisplay(*now);
    return word.text.empty() && word.kind == cawl::Word::Kind::kTerm ? ToDisplay(word.term) : word.text.value;
  }

  const cawl::Document& document_;
  const cawl::VariableValues& values_;
  const Limits& limits_;
  const FactView& facts_;
  std::map<const cawl::Constraint*, bool> there_;
};

// "<urn:r1> is held by run Hold-3, is out of service: smoke"
std::string Kept(const RobotId& robot, const std::vector<std::string>& why) {
  return absl::StrCat(ToDisplay(Term::Iri(robot.value())), " ", absl::StrJoin(why, ", "));
}

}  // namespace

std::vector<std::string> Engine::Core::WhatKeeps(const RobotId& robot, const RunId& root) const {
  std::vector<std::string> why;
  if (const RunId* holder = ledger.Holder(robot); holder != nullptr && *holder != root)
    why.push_back(absl::StrCat("is held by run ", holder->value()));
  if (const Reservation* reservation = Bars(robot, root)) why.push_back(ShowReservation(*reservation));
  return why;
}

std::vector<std::string> Engine::Core::WhatKeeps(const RobotId& robot, const rsel::Plan& plan) const {
  std::vector<std::string> why;
  for (const rsel::PlanStep& step : plan.steps) {
    const RobotOffer* offer = OfferOf(step.operation, robot);
    if (offer == nullptr) {
      why.push_back(absl::StrCat("does not offer ", step.operation));
    } else if (std::string out = OutOfService(*offer); why.empty() && !out.empty()) {
      why.push_back(std::move(out));
    }
  }
  return why;
}

// `held`: of each of its ASKs, whether it holds; their alternatives are left out.
std::string RunStepper::Lacks(size_t index, const std::vector<bool>& held) const {
  if (core_.input->facts == nullptr) return "";
  const cawl::VariableValues values = [this](const std::string& name) { return Value(name, nullptr); };
  LackFinder finder(*run_.document, values, core_.limits, *core_.input->facts);
  std::vector<std::string> all;
  size_t more = 0;
  for (const cawl::Alternative& alternative : cawl::AlternativesOf(*flow_.nodes[index].condition)) {
    if (alternative.ask < held.size() && held[alternative.ask]) continue;
    if (all.size() == kShown)
      ++more;
    else
      AddNew(Listed(finder.Of(alternative), ", "), &all);
  }
  if (more > 0) all.push_back(absl::StrCat("one of ", more, " more alternatives"));
  return absl::StrJoin(all, "; or ");
}

std::string RunStepper::NotOpened(size_t index) const {
  const NodeState& node = run_.nodes[index];
  const std::string within = TimeText(flow_.nodes[index].condition->timeout_ms.value_or(0));
  const bool by_robots = !node.busy_robots.empty() || !node.wanted_robot.empty();
  std::vector<bool> held;
  for (const ArmedCondition& armed : node.armed) {
    const auto solutions = by_robots ? Solutions(index, armed) : std::vector<TermBinding>();
    held.push_back(solutions.ok() && !solutions->empty());
  }
  const std::string lacks = Lacks(index, held);
  if (node.busy_robots.empty() && std::count(held.begin(), held.end(), true) > 0) {
    return absl::StrCat("its condition holds, but within ", within, " it did not with ",
                        ToDisplay(Term::Iri(node.wanted_robot.value())), ", which was chosen for it");
  }
  if (node.busy_robots.empty()) {
    return absl::StrCat("its condition did not hold within ", within, lacks.empty() ? "" : ": ", lacks);
  }
  std::vector<rsel::PlanPtr> plans;
  for (const cawl::Invoke& invoke : flow_.nodes[index].invokes) {
    if (!invoke.operation.value.empty()) plans.push_back(core_.PlanOf(invoke.operation.value));
  }
  std::vector<std::string> kept;
  for (const RobotId& robot : node.busy_robots) {
    std::vector<std::string> why = core_.WhatKeeps(robot, core_.RootOf(run_));
    for (const rsel::PlanPtr& plan : plans) {
      for (std::string& of_plan : core_.WhatKeeps(robot, *plan)) AddNew(std::move(of_plan), &why);
    }
    kept.push_back(Kept(robot, why));
  }
  return absl::StrCat("its condition holds, but no robot with which it does became free within ", within,
                      ": ", Listed(std::move(kept), "; "), lacks.empty() ? "" : "; or ", lacks);
}

// Each robot that offers the first operation of what waits for one, with what keeps it; empty: none offers it.
std::string RunStepper::RobotsKept(size_t node, size_t index) const {
  const InvocationState& invocation = run_.nodes[node].invocations[index];
  const std::string& operation = flow_.nodes[node].invokes[invocation.invoke].operation.value;
  const rsel::PlanPtr plan = core_.PlanOf(operation);
  const TermBinding given = GivenTo(invocation);
  const std::optional<Term> wanted = Value("robot", &given);
  const CommandOwner self{run_.id, node, index};
  std::vector<std::string> kept;
  std::set<RobotId> seen;
  for (const RobotOffer& offer : core_.input->robots->Offers(plan->steps[0].operation)) {
    const RobotId& robot = offer.robot;
    if ((wanted && wanted->lexical != robot.value()) || !seen.insert(robot).second) continue;
    std::vector<std::string> why = core_.WhatKeeps(robot, core_.RootOf(run_));
    for (std::string& of_plan : core_.WhatKeeps(robot, *plan)) AddNew(std::move(of_plan), &why);
    if (invocation.failed_on.contains(robot)) why.emplace_back("failed in an attempt before");
    std::string lacks;
    if (CapabilityOf(operation) && core_.OfferFor(operation, robot, self, &lacks) == nullptr &&
        !lacks.empty()) {
      kept.push_back(std::move(lacks));
      continue;
    }
    if (why.empty() && core_.ledger.Occupied(robot, core_.OccupationOf(*plan, robot, self), self))
      why.emplace_back("is at another step of this run, or ends one");
    if (!why.empty()) kept.push_back(Kept(robot, why));
  }
  return Listed(std::move(kept), "; ");
}

// `within`: " within 3 s", where that is not said before.
std::string RunStepper::NotDone(size_t node, size_t index, const std::string& within) const {
  const InvocationState& invocation = run_.nodes[node].invocations[index];
  const cawl::Invoke& invoke = flow_.nodes[node].invokes[invocation.invoke];
  const std::string because = invocation.reason.empty() ? "" : absl::StrCat("; ", invocation.reason);
  if (invocation.state == WorkState::kPending && !invocation.queued)
    return absl::StrCat("it did not begin", within, because);
  if (invocation.state == WorkState::kPending) {
    const std::string kept = RobotsKept(node, index);
    return absl::StrCat("no robot became free for it", within,
                        kept.empty() ? because : absl::StrCat(": ", kept));
  }
  if (!invocation.child.empty())
    return absl::StrCat("subflow ", invocation.child.value(), " was not done", within, because);
  if (!invocation.step.empty()) return absl::StrCat(invocation.step, because);
  return absl::StrCat(invoke.operation.value, " was not done", within, because);
}

std::string RunStepper::NotDone(size_t index) const {
  const NodeState& node = run_.nodes[index];
  std::vector<std::string> all;
  size_t more = 0;
  for (size_t i = 0; i < node.invocations.size(); ++i) {
    const InvocationState& invocation = node.invocations[i];
    if (IsFinal(invocation.state)) continue;
    if (all.size() == kShown) {
      ++more;
      continue;
    }
    const cawl::Invoke& invoke = flow_.nodes[index].invokes[invocation.invoke];
    std::string text = invoke.operation.value.empty() ? invoke.subflow.value : invoke.operation.value;
    if (!invocation.binding.empty()) absl::StrAppend(&text, " (", ShowBinding(invocation.binding), ")");
    if (!invocation.robot.empty() && invocation.state == WorkState::kRunning)
      absl::StrAppend(&text, " on ", ToDisplay(Term::Iri(invocation.robot.value())));
    absl::StrAppend(&text, ": ", NotDone(index, i, ""));
    if (!invocation.failure.empty())
      absl::StrAppend(&text, "; the attempt before failed: ", invocation.failure);
    all.push_back(std::move(text));
  }
  if (all.empty() && !node.reason.empty()) all.push_back(node.reason);
  return absl::StrCat("it was not done within ", TimeText(flow_.nodes[index].timeout_ms.value_or(0)),
                      all.empty() ? "" : ": ", absl::StrJoin(all, "; "),
                      more == 0 ? "" : absl::StrCat("; ", more, " more invocations"));
}

}  // namespace docent::engine
