// Reservations: robots that are kept for a run, for the runs of a workflow, or for none. They are facts of the graph (docent:reservedBy), told by
// operators and by runs (ext:reserve), with a lifetime where they end by time.
//
// Of two reservations of a robot, the one of the higher priority counts before the other, of these the older one. A run takes
// a robot that is reserved for others only if its own priority is higher, or if its own reservation counts before theirs; what it
// holds already it keeps.
//
// That runs do not wait for each other in a circle over reservations: each run tree has one at a time, made in one turn for all
// its robots, so that they stand in one order for all robots, and the first of them waits for no other. A run that holds a
// robot of a reservation is not barred by it: the one for which the robots are kept waits for its end anyway.
#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/base/overload.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/service_workflow.h"

namespace docent::engine {
namespace {

constexpr std::string_view kIsReserved = "is reserved";

bool IsOf(const TermQuad& quad, const Term& reservation) {
  return quad.subject == reservation || quad.object == reservation;
}

}  // namespace

const Reservation* Engine::Core::Bars(const RobotId& robot, const RunId& root) const {
  const std::vector<Reservation>& all = input->robots->ReservationsOf(robot);
  if (all.empty()) return nullptr;
  const auto run = runs.find(root);
  if (run == runs.end()) return nullptr;  // asked of no run in particular
  const std::string run_iri = RunIri(root), workflow_iri = WorkflowIri(run->second.document->name.value);
  const auto holds_some = [&](const Reservation& reservation) {
    return std::any_of(reservation.robots.begin(), reservation.robots.end(), [&](const RobotId& reserved) {
      const RunId* holder = ledger.Holder(reserved);
      return holder != nullptr && *holder == root;
    });
  };
  for (const Reservation& reservation : all) {
    if (reservation.kept_for == run_iri || reservation.kept_for == workflow_iri) return nullptr;
    if (reservation.priority >= run->second.priority && !holds_some(reservation)) return &reservation;
  }
  return nullptr;
}

bool Engine::Core::BarsRun(const RobotId& robot, const RunId& run) const {
  const auto live = runs.find(run);
  return live != runs.end() && Bars(robot, RootOf(live->second)) != nullptr;
}

void Engine::Core::NoteBarred(const CommandOwner& owner, const std::string& reason) {
  if (absl::StrContains(reason, ToAbsl(kIsReserved))) waiting.Bar(owner);
}

std::string Engine::Core::ShowReservation(const Reservation& reservation) {
  std::string text(kIsReserved);
  if (const auto run = RunOfIri(reservation.kept_for))
    absl::StrAppend(&text, " for run ", run->value());
  else if (const auto workflow = WorkflowOfIri(reservation.kept_for))
    absl::StrAppend(&text, " for workflow ", *workflow);
  if (reservation.until_us != 0)
    absl::StrAppend(&text, " until ", DateTimeTerm(reservation.until_us).lexical);
  absl::StrAppend(&text, ", with priority ", reservation.priority);
  return reservation.reason.empty() ? text : absl::StrCat(text, " (", reservation.reason, ")");
}

std::vector<TermQuad> Engine::Core::ReservationFacts(const std::string& reservation,
                                                     const RunId& root) const {
  std::vector<TermQuad> facts;
  const Term iri = Term::Iri(reservation);
  FactPattern about, kept;
  about.subject = kept.object = iri;
  kept.predicate = Term::Iri(DocentIri("reservedBy"));
  for (const FactPattern& pattern : {about, kept}) {
    const auto found = input->facts->Match(pattern, kWorkflowLimits.facts_written_per_turn);
    if (found.ok()) facts.insert(facts.end(), found->told.begin(), found->told.end());
  }
  const auto tree = trees.find(root);
  if (tree == trees.end()) return facts;
  for (const RunId& run : tree->second) {
    const auto of_run = written.find(run);
    if (of_run == written.end()) continue;
    for (const size_t at : of_run->second) {
      const FactWrite& write = output->writes[at];
      if (!IsOf(write.quad, iri)) continue;
      std::erase(facts, write.quad);
      if (write.tells) facts.push_back(write.quad);
    }
  }
  return facts;
}

void Engine::Core::EndReservations(const RunId& root) {
  EndReservationsFor(RunIri(root), root);
}

void Engine::Core::EndReservationsOf(const std::string& workflow) {
  if (deployments.contains(workflow)) return;
  const bool has_runs = std::any_of(runs.begin(), runs.end(), [&](const auto& each) {
    const Run& run = each.second;
    return run.state == WorkState::kRunning && run.document->name.value == workflow &&
           ServiceOf(*run.document).empty();
  });
  if (!has_runs) EndReservationsFor(WorkflowIri(workflow), RunId());
}

void Engine::Core::EndReservationsFor(const std::string& kept_for, const RunId& root) {
  if (input->facts == nullptr) return;
  FactPattern wanted;
  wanted.predicate = Term::Iri(DocentIri("reservedFor"));
  wanted.object = Term::Iri(kept_for);
  const auto found = input->facts->Match(wanted, kWorkflowLimits.facts_written_per_turn);
  if (!found.ok()) return;
  std::set<std::string> reservations;
  for (const TermQuad& quad : found->told) reservations.insert(quad.subject.lexical);
  for (const std::string& reservation : reservations) {
    for (TermQuad& fact : ReservationFacts(reservation, root))
      output->writes.push_back({false, std::move(fact), 0});
  }
}

absl::Status RunStepper::Reserve(size_t index, const cawl::Action& action) {
  if (core_.input->facts == nullptr) return absl::FailedPreconditionError("there is no graph");
  std::set<Term> robots;
  const auto bindings = BindingsOf(index);
  if (!bindings.ok()) return bindings.status();
  for (const TermBinding& binding : *bindings) {
    for (const cawl::Constraint& fact : action.facts) {
      absl::StatusOr<Term> robot = ValueOf(fact.subject, &binding);
      if (!robot.ok())
        return WithMessage(robot.status(), absl::StrCat("it cannot reserve: ", robot.status().message()));
      const FactPattern is_robot{*robot, Term::Iri(std::string(kRdfType)), Term::Iri(DocentIri("Robot")), ""};
      const auto told = core_.input->facts->Match(is_robot, kWorkflowLimits.facts_written_per_turn);
      if (!robot->IsIri() || !told.ok() || (told->told.empty() && !told->inferred))
        return absl::FailedPreconditionError(
            absl::StrCat("it cannot reserve ", ToDisplay(*robot), ": it is no robot"));
      robots.insert(*std::move(robot));
    }
  }
  if (robots.size() > kWorkflowLimits.reserved_robots) {
    return absl::ResourceExhaustedError(absl::StrCat("it would reserve ", robots.size(),
                                                     " robots; the limit reserved_robots is ",
                                                     kWorkflowLimits.reserved_robots));
  }
  const RunId root = core_.RootOf(run_);
  const Term iri = Term::Iri(ReservationIri(root.value())), graph = Term::Iri(RunIri(run_.id));
  const std::vector<TermQuad> before = core_.ReservationFacts(iri.lexical, root);
  std::vector<TermQuad> facts;
  const auto say = [&](Term subject, const std::string& predicate, Term object) {
    facts.push_back({std::move(subject), Term::Iri(predicate), std::move(object), graph});
  };
  say(iri, std::string(kRdfType), Term::Iri(DocentIri("Reservation")));
  say(iri, DocentIri("reservedFor"), Term::Iri(RunIri(root)));
  say(iri, DocentIri("reservationPriority"), Term::Integer(action.priority.value_or(run_.priority)));
  say(iri, DocentIri("reservedAt"), DateTimeTerm(core_.input->now_us));
  if (action.lifetime_ms)
    say(iri, DocentIri("reservedUntil"), DateTimeTerm(core_.input->now_us + *action.lifetime_ms * 1000));
  std::string names;
  for (const Term& robot : robots) {
    say(robot, DocentIri("reservedBy"), iri);
    absl::StrAppend(&names, names.empty() ? "" : ", ", ToDisplay(robot));
  }
  if (absl::Status may = MayWrite(before.size() + facts.size()); !may.ok()) return may;
  for (const TermQuad& fact : before) {
    if (std::find(facts.begin(), facts.end(), fact) == facts.end()) Write(false, fact, &action);
  }
  for (TermQuad& fact : facts) Write(true, std::move(fact), &action, Subject(index));
  core_.Say(Subject(index), "running", "running", absl::StrCat("reserved ", names));
  return absl::OkStatus();
}

// Robots that the run holds, and no step of it works with: other runs get them, once their commands have ended.
absl::Status RunStepper::GiveBack(size_t index, const cawl::Action& action) {
  const RunId root = core_.RootOf(run_);
  std::set<Term> robots;
  const auto bindings = BindingsOf(index);
  if (!bindings.ok()) return bindings.status();
  for (const TermBinding& binding : *bindings) {
    for (const cawl::Constraint& fact : action.facts) {
      absl::StatusOr<Term> robot = ValueOf(fact.subject, &binding);
      if (!robot.ok())
        return WithMessage(robot.status(), absl::StrCat("it cannot release: ", robot.status().message()));
      robots.insert(*std::move(robot));
    }
  }
  for (const Term& term : robots) {
    const RobotId robot(term.lexical);
    const RunId* holder = core_.ledger.Holder(robot);
    std::string said = absl::StrCat("gave back ", ToDisplay(term));
    if (holder == nullptr || *holder != root) {
      said = absl::StrCat(ToDisplay(term), " is not held by this run");
    } else if (!core_.ledger.Tasks(robot).empty()) {
      said = absl::StrCat(ToDisplay(term), " is not given back: another step of the run works with it");
    } else {
      const std::set<RunId> tree = core_.trees.at(root);
      for (const RunId& id : tree) {
        if (Run* run = core_.Mutable(id)) run->robots.erase(robot);
      }
      core_.released.insert(robot);
      core_.changed_robots.insert(robot);
    }
    core_.Say(Subject(index), "running", "running", std::move(said));
  }
  return absl::OkStatus();
}

absl::Status RunStepper::ReleaseReservation(size_t index, const cawl::Action& action) {
  if (!action.facts.empty()) return GiveBack(index, action);
  if (core_.input->facts == nullptr) return absl::FailedPreconditionError("there is no graph");
  const RunId root = core_.RootOf(run_);
  std::vector<TermQuad> facts = core_.ReservationFacts(ReservationIri(root.value()), root);
  if (absl::Status may = MayWrite(facts.size()); !may.ok()) return may;
  core_.Say(Subject(index), "running", "running",
            facts.empty() ? "there is no reservation to release" : "released its reservation");
  for (TermQuad& fact : facts) Write(false, std::move(fact), &action);
  return absl::OkStatus();
}

}  // namespace docent::engine
