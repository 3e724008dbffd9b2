#include "kb_server/grpc/run_waits.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "graph/base/cut_text.h"
#include "graph/base/text.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/clock/wait_times.h"
#include "kb_server/grpc/run_reader.h"
#include "kb_server/robots/robot_records.h"
#include "kb_server/robots/service_state.h"

namespace docent::server {
namespace {

// Of runs nested in runs, as many as the engine nests.
constexpr int kDeepest = 64;

std::string Angled(const std::string& iri) {
  return Concat("<", iri, ">");
}

bool IsFinal(const std::string& state) {
  return state == "done" || state == "failed" || state == "cancelled" || state == "skipped";
}

std::string OutermostOf(const GraphReader& graph, std::string run) {
  for (int depth = 0; depth < kDeepest; ++depth) {
    const auto outer = RunOfIri(graph.Object(RunIri(RunId(run)), DocentIri("parentRun")));
    if (!outer) break;
    run = outer->value();
  }
  return run;
}

// The robots of which a node or an invocation needs one, each with the run that holds it.
using NeededRobots = std::vector<std::pair<std::string, std::string>>;

class WaitCollector {
 public:
  WaitCollector(const WaitSources& sources, v1::ExplainRunReply* reply)
      : sources_(sources), graph_(*sources.graph), reply_(*reply) {}

  // `place`: before the names of its nodes; empty for the run that is asked about.
  void Add(const v1::Run& run, const std::string& only, const std::string& place, int depth) {
    if (run.paused() && only.empty()) AddPause(run, place);
    for (const v1::Node& node : run.nodes()) {
      if (!only.empty() && node.name() != only) continue;
      if (node.state() == "waiting") {
        AddWaiting(run, node, place);
      } else if (node.state() == "incident") {
        v1::Wait* wait = New(place, node, "operator");
        wait->set_detail(absl::StrCat("it failed: ", node.reason(),
                                      "; settle it: docent runs retry, skip or fail ", run.id(), " ",
                                      node.name()));
      } else if (node.state() == "running") {
        for (int i = 0; i < node.invocations_size(); ++i) AddInvocation(run, node, i, place, depth);
        if (absl::StartsWith(node.reason(), "what it notifies"))
          New(place, node, "notification")->set_detail(node.reason());
      } else if (node.state() == "inactive" && !only.empty()) {
        AddJoin(run, node, place);
      }
    }
  }

  // All that it waits for. A run that undoes what it did has no node under way, but a run for each step; before the first, what it
  // began ends.
  void AddRun(const v1::Run& run) {
    Add(run, "", "", 0);
    if (reply_.waits_size() > 0 || run.state() != "running") return;
    for (const std::string& nested :
         graph_.Subjects(DocentIri("parentRun"), Term::Iri(RunIri(RunId(run.id()))))) {
      v1::Run inner;
      const auto id = RunOfIri(nested);
      if (!id || !ReadRun(graph_, id->value(), &inner) || inner.state() != "running") continue;
      v1::Wait* wait = reply_.add_waits();
      wait->set_kind("subflow");
      wait->set_detail(absl::StrCat("it undoes what it did: run ", id->value()));
      Add(inner, "", absl::StrCat(id->value(), "/"), 1);
    }
    if (reply_.waits_size() == 0) AddEndings(run, "; what it did is undone when that is known");
  }

  // Of a run that has ended: robots that have not yet confirmed that they stopped.
  void AddRobotsToStop(const v1::Run& run) { AddEndings(run, ", which was asked to stop"); }

  // Of all that waits for robots.
  const std::vector<NeededRobots>& needed() const { return needed_; }

 private:
  // Commands of the run, and of runs that are nested in it, whose end is not known.
  void AddEndings(const v1::Run& run, const char* remark) {
    for (const std::string& robot : graph_.Subjects(kRdfType, Term::Iri(DocentIri("Robot")))) {
      for (const Term& command : graph_.Objects(robot, DocentIri("endingCommand"))) {
        const std::string sender = command.lexical.substr(0, command.lexical.find('/'));
        if (sender != run.id() && !IsNested(command.lexical, run)) continue;
        v1::Wait* wait = reply_.add_waits();
        wait->set_kind("command");
        wait->set_robot(robot);
        wait->set_detail(
            absl::StrCat("the end of command ", command.lexical, " of ", AwayText(robot), remark));
      }
    }
  }

  v1::Wait* New(const std::string& place, const v1::Node& node, const char* kind) {
    v1::Wait* wait = reply_.add_waits();
    wait->set_node(Concat(place, node.name()));
    wait->set_kind(kind);
    return wait;
  }

  void AddPause(const v1::Run& run, const std::string& place) {
    const std::string iri = RunIri(RunId(run.id()));
    const std::string reason = graph_.Object(iri, DocentIri("pauseReason"));
    v1::Wait* wait = reply_.add_waits();
    wait->set_node(place);
    wait->set_kind("resume");
    std::string paused = run.id();
    v1::Run outer = run;
    while (!outer.parent().empty()) {  // the outermost that is paused
      v1::Run next;
      if (!ReadRun(graph_, outer.parent(), &next) || !next.paused()) break;
      outer = std::move(next);
      paused = outer.id();
    }
    wait->set_detail(absl::StrCat("run ", paused, " is paused",
                                  reason.empty() ? "" : absl::StrCat(" (", reason, ")"),
                                  "; docent runs resume ", paused));
  }

  void AddWaiting(const v1::Run& run, const v1::Node& node, const std::string& place) {
    if (node.waits_for().empty()) {
      New(place, node, "resume")->set_detail("it opens when its run is resumed");
      return;
    }
    needed_.emplace_back();
    for (const std::string& ask : AlternativesOf(node.waits_for())) {
      const ConditionAnswer answer = sources_.ask ? sources_.ask(ask) : ConditionAnswer();
      if (!answer.holds) {
        v1::Wait* wait = New(place, node, "fact");
        wait->set_missing(answer.missing);
        AddNextTime(ask, wait,
                    answer.missing.empty()
                        ? Concat("its condition holds: ", OneLine(ask))
                        : Concat("a fact: ", answer.missing, answer.remarks.empty() ? "" : " (",
                                 answer.remarks, answer.remarks.empty() ? "" : ")"));
      } else if (answer.robots.empty() && absl::StrContains(ask, DocentIri("Event"))) {
        AddNextTime(ask, New(place, node, "fact"), "an event that is told from now on");
      } else if (run.paused()) {
        New(place, node, "time")->set_detail("its condition holds, and opens it when its run is resumed");
      } else if (const std::optional<WaitTime> time = TimeOf(run, node, ask)) {
        v1::Wait* wait = New(place, node, "time");
        wait->set_until_us(time->at_us);
        wait->set_detail(time->text);
      } else if (!answer.robots.empty()) {
        for (const std::string& robot : answer.robots)
          AddRobot(place, node, robot, "its condition holds with this robot");
      } else {
        New(place, node, "time")->set_detail(NotYetForLong(ask));
      }
    }
  }

  // With when a time of the condition holds or occurs next, where it does not now.
  void AddNextTime(const std::string& ask, v1::Wait* wait, const std::string& detail) {
    const std::optional<TimeMicros> next = NextTime(graph_, ask, sources_.now_us);
    wait->set_detail(next ? absl::StrCat(detail, "; its time comes at ", DateTimeTerm(*next).lexical)
                          : detail);
    if (next) wait->set_until_us(*next);
  }

  std::optional<WaitTime> TimeOf(const v1::Run& run, const v1::Node& node, const std::string& ask) const {
    const std::string iri = absl::StrCat(RunIri(RunId(run.id())), "/", IriSegment(node.name()));
    return TimeOfNode(graph_, {iri, node.since_us()}, ask, sources_.now_us);
  }

  // Without the prologue.
  static std::string OneLine(const std::string& ask) {
    std::vector<std::string> lines;
    for (absl::string_view line : absl::StrSplit(ask, '\n')) {
      if (!absl::StartsWith(line, "PREFIX") && !absl::StartsWith(line, "#"))
        lines.emplace_back(absl::StripAsciiWhitespace(line));
    }
    return absl::StrJoin(lines, " ");
  }

  void AddRobot(const std::string& place, const v1::Node& node, const std::string& robot,
                const std::string& why) {
    v1::Wait* wait = New(place, node, "robot");
    wait->set_robot(robot);
    const std::string held_by = HolderOf(robot);
    wait->set_held_by(held_by);
    if (!needed_.empty()) needed_.back().emplace_back(robot, held_by);
    const std::optional<std::string> out = OutOfServiceReason(graph_, robot);
    wait->set_detail(absl::StrCat(
        "robot ", Angled(robot), ", which is ", ToAbsl(ToString(RobotStateOf(graph_, robot))),
        out ? absl::StrCat(", out of service (", *out, ")") : "", held_by.empty() ? "" : ", held by run ",
        held_by, PausedText(held_by), ReservedText(robot, why), why.empty() ? "" : absl::StrCat(": ", why)));
  }

  // "robot <R>", and where it does not do as it is told: that it is offline, since when, and out of service.
  std::string AwayText(const std::string& robot) const {
    std::string text = absl::StrCat("robot ", Angled(robot));
    if (RobotStateOf(graph_, robot) == RobotRecord::State::kOffline) {
      const std::string seen = graph_.Object(robot, DocentIri("lastSeenAt"));
      absl::StrAppend(&text, ", which is offline",
                      seen.empty() ? "" : absl::StrCat(" (last seen ", seen, ")"));
    }
    if (const auto out = OutOfServiceReason(graph_, robot)) {
      absl::StrAppend(&text, ", which is out of service", out->empty() ? "" : absl::StrCat(" (", *out, ")"));
    }
    return text;
  }

  // The outermost run that holds it; empty: none.
  std::string HolderOf(const std::string& robot) const {
    return RunOfIri(graph_.Object(robot, DocentIri("heldBy"))).value_or(RunId()).value();
  }

  // Where the run that holds a robot goes on only when somebody resumes it.
  std::string PausedText(const std::string& run) const {
    const std::string iri = RunIri(RunId(run));
    if (run.empty() || graph_.Object(iri, DocentIri("pausedAt")).empty()) return "";
    const std::string reason = graph_.Object(iri, DocentIri("pauseReason"));
    return absl::StrCat(", which is paused", reason.empty() ? "" : absl::StrCat(" (", reason, ")"),
                        "; docent runs resume ", run);
  }

  // Who the robot is kept for, unless `why` says so.
  std::string ReservedText(const std::string& robot, const std::string& why) const {
    if (absl::StrContains(why, "is reserved")) return "";
    std::string text;
    for (const Term& reservation : graph_.Objects(robot, DocentIri("reservedBy"))) {
      const std::string kept_for = graph_.Object(reservation.lexical, DocentIri("reservedFor"));
      const std::string until = graph_.Object(reservation.lexical, DocentIri("reservedUntil"));
      const auto run = RunOfIri(kept_for);
      const auto workflow = WorkflowOfIri(kept_for);
      absl::StrAppend(&text, ", reserved", run ? absl::StrCat(" for run ", run->value()) : "",
                      workflow ? absl::StrCat(" for workflow ", *workflow) : "",
                      until.empty() ? "" : absl::StrCat(" until ", until), ", with priority ",
                      graph_.Object(reservation.lexical, DocentIri("reservationPriority")));
    }
    return text;
  }

  void AddInvocation(const v1::Run& run, const v1::Node& node, int number, const std::string& place,
                     int depth) {
    const v1::Invocation& invocation = node.invocations(number);
    if (IsFinal(invocation.state())) return;
    const std::string iri = absl::StrCat(RunIri(RunId(run.id())), "/", IriSegment(node.name()), "/", number);
    const std::string child = graph_.Object(iri, DocentIri("childRun"));
    if (const auto nested = RunOfIri(child); nested && invocation.state() == "running") {
      v1::Wait* wait = New(place, node, "subflow");
      wait->set_detail(absl::StrCat("sub-flow ", nested->value()));
      v1::Run inner;
      if (depth < kDeepest && ReadRun(graph_, nested->value(), &inner))
        Add(inner, "", absl::StrCat(inner.id(), "/"), depth + 1);
    } else if (!invocation.command().empty()) {
      v1::Wait* wait = New(place, node, "command");
      wait->set_robot(invocation.robot());
      wait->set_detail(absl::StrCat(
          "command ", invocation.command(), " (", invocation.step(), ") of ", AwayText(invocation.robot()),
          invocation.reason().empty() ? "" : absl::StrCat(": ", invocation.reason())));
    } else if (const std::string from = graph_.Object(iri, DocentIri("notBefore")); !from.empty()) {
      v1::Wait* wait = New(place, node, "time");
      wait->set_until_us(MicrosOfDateTime(from));
      wait->set_detail(absl::StrCat("its next attempt begins at ", from));
    } else if (absl::StrContains(invocation.reason(), "the end of the attempt before it") &&
               AddEnding(run, node, place)) {
      return;
    } else if (run.paused()) {
      New(place, node, "resume")
          ->set_detail(absl::StrCat(invocation.operation(), " goes on when its run is resumed"));
    } else {
      AddPending(run, node, invocation, place);
    }
  }

  // Commands of attempts before, whose end is not known: of the node, or of runs that were nested in it.
  bool AddEnding(const v1::Run& run, const v1::Node& node, const std::string& place) {
    bool any = false;
    for (const std::string& robot : graph_.Subjects(kRdfType, Term::Iri(DocentIri("Robot")))) {
      for (const Term& command : graph_.Objects(robot, DocentIri("endingCommand"))) {
        if (!IsOf(command.lexical, run, node)) continue;
        v1::Wait* wait = New(place, node, "command");
        wait->set_robot(robot);
        wait->set_detail(absl::StrCat("the end of command ", command.lexical, " of ", AwayText(robot)));
        any = true;
      }
    }
    return any;
  }

  bool IsOf(const std::string& command, const v1::Run& run, const v1::Node& node) const {
    return absl::StartsWith(command, absl::StrCat(run.id(), "/", IriSegment(node.name()), "/")) ||
           IsNested(command, run);
  }

  // Whether it is of a run that is nested in this one.
  bool IsNested(const std::string& command, const v1::Run& run) const {
    const std::string asked = RunIri(RunId(run.id()));
    std::string iri = RunIri(RunId(command.substr(0, command.find('/'))));
    for (int depth = 0; depth < kDeepest && !iri.empty(); ++depth) {
      iri = graph_.Object(iri, DocentIri("parentRun"));
      if (iri == asked) return true;
    }
    return false;
  }

  // The node waits for what has to hold while it runs, or for its condition to hold again.
  void AddHold(const v1::Node& node, const std::string& reason, const std::string& place) {
    v1::Wait* wait = New(place, node, "fact");
    const bool asks = sources_.ask && !node.waits_for().empty();
    const ConditionAnswer answer = asks ? sources_.ask(node.waits_for()) : ConditionAnswer();
    if (answer.holds || answer.missing.empty()) return wait->set_detail(reason);
    wait->set_missing(answer.missing);
    wait->set_detail(Concat("a fact: ", answer.missing, " (",
                            answer.remarks.empty() ? "" : answer.remarks + "; ", reason, ")"));
  }

  void AddPending(const v1::Run& run, const v1::Node& node, const v1::Invocation& invocation,
                  const std::string& place) {
    const std::string& reason = invocation.reason();
    needed_.emplace_back();
    const auto says = [&reason](std::string_view text) { return absl::StrContains(reason, ToAbsl(text)); };
    if (says("has to hold") || says("ceased to hold")) {
      AddHold(node, reason, place);
    } else if (says("is paused")) {
      New(place, node, "resume")->set_detail(reason);
    } else if (says("comes after the one before it")) {
      New(place, node, "join")->set_detail(absl::StrCat(invocation.operation(), ": ", reason));
    } else if (says("the end of the attempt before it")) {
      New(place, node, "command")->set_detail(reason);
    } else if (!invocation.robot().empty()) {
      AddRobot(place, node, invocation.robot(), reason);
    } else if (invocation.awaits().empty()) {
      New(place, node, "robot")
          ->set_detail(absl::StrCat(
              "a robot that offers ", invocation.operation().starts_with("<") ? "an operation of class " : "",
              invocation.operation(), reason.empty() ? "" : absl::StrCat(": ", reason)));
    } else {
      for (const std::string& robot : InTheWay(run, invocation))
        AddRobot(place, node, robot, IsOfOne(invocation) ? "" : reason);
    }
  }

  // Of the robots that offer what it asks for. Where all that could do it serve other runs, those that this run holds itself, and
  // those that are free, could not.
  std::vector<std::string> InTheWay(const v1::Run& run, const v1::Invocation& invocation) const {
    std::vector<std::string> all, of_others;
    const std::string root = OutermostOf(graph_, run.id());
    for (const v1::AwaitedRobot& robot : invocation.awaits()) {
      all.push_back(robot.robot());
      const std::string holder = HolderOf(robot.robot());
      if (!holder.empty() && holder != root) of_others.push_back(robot.robot());
    }
    const bool serve_others = absl::StrContains(invocation.reason(), "serves another run");
    return serve_others && !of_others.empty() ? of_others : all;
  }

  // Whether the reason is that of one of several robots: what keeps each is told with it.
  static bool IsOfOne(const v1::Invocation& invocation) {
    return invocation.awaits_size() > 1 &&
           std::any_of(invocation.awaits().begin(), invocation.awaits().end(), [&](const auto& robot) {
             return absl::StrContains(invocation.reason(), Angled(robot.robot()));
           });
  }

  void AddJoin(const v1::Run& run, const v1::Node& node, const std::string& place) {
    std::vector<std::string> before;
    const cawl::DocumentPtr document =
        sources_.catalog == nullptr ? nullptr : sources_.catalog->FindWorkflow(run.workflow());
    const cawl::Flow* flow = document == nullptr ? nullptr : document->FindFlow(run.flow());
    for (const v1::Node& other : run.nodes()) {
      const bool leads =
          flow != nullptr && std::any_of(flow->links.begin(), flow->links.end(), [&](const auto& link) {
            return link.from.value == other.name() && link.to.value == node.name();
          });
      if (leads && !IsFinal(other.state())) before.push_back(other.name());
    }
    New(place, node, "join")
        ->set_detail(before.empty() ? "the nodes that lead to it"
                                    : absl::StrCat("the end of ", absl::StrJoin(before, ", ")));
  }

  const WaitSources& sources_;
  const GraphReader& graph_;
  v1::ExplainRunReply& reply_;
  std::vector<NeededRobots> needed_;
};

// A robot that a run waits for, and the run that holds it.
struct Need {
  std::string run, robot, holder;
};

// Runs that are looked at to find a circle.
constexpr size_t kRunsOfACircle = 16;

// What the run waits for that only robots of one other run could do.
std::vector<Need> NeedsOf(const std::string& run, const std::vector<NeededRobots>& needed) {
  std::vector<Need> needs;
  for (const NeededRobots& robots : needed) {
    if (robots.empty()) continue;
    const auto& [first, holder] = robots.front();
    const bool of_one = std::all_of(robots.begin(), robots.end(),
                                    [&](const auto& other) { return other.second == robots.front().second; });
    if (of_one && !holder.empty() && holder != run) needs.push_back({run, first, holder});
  }
  return needs;
}

// From a need of `way` back to its first run; false: there is no circle. `seen`: runs that were looked at.
bool FindCircle(const WaitSources& sources, std::vector<Need>* way, std::set<std::string>* seen) {
  const std::string holder = way->back().holder;
  if (holder == way->front().run) return true;
  v1::Run run;
  if (seen->size() >= kRunsOfACircle || !seen->insert(holder).second ||
      !ReadRun(*sources.graph, holder, &run) || run.state() != "running")
    return false;
  v1::ExplainRunReply waits;
  WaitCollector collector(sources, &waits);
  collector.AddRun(run);
  for (Need& need : NeedsOf(holder, collector.needed())) {
    way->push_back(std::move(need));
    if (FindCircle(sources, way, seen)) return true;
    way->pop_back();
  }
  return false;
}

// Runs that wait for each other over the robots that they hold: that does not end by itself.
void AddCircle(const WaitSources& sources, const std::string& run, const std::vector<NeededRobots>& needed,
               v1::ExplainRunReply* reply) {
  for (Need& need : NeedsOf(OutermostOf(*sources.graph, run), needed)) {
    std::vector<Need> way = {std::move(need)};
    std::set<std::string> seen;
    if (!FindCircle(sources, &way, &seen)) continue;
    v1::Wait* wait = reply->add_waits();
    wait->set_kind("operator");
    wait->set_detail(absl::StrCat("runs wait for each other: ",
                                  absl::StrJoin(way, "; ",
                                                [](std::string* out, const Need& each) {
                                                  absl::StrAppend(out, each.run, " waits for robot ",
                                                                  Angled(each.robot), ", which ", each.holder,
                                                                  " holds");
                                                }),
                                  "; cancel one of them (docent runs cancel)"));
    return;
  }
}

}  // namespace

void AddWaits(const WaitSources& sources, const v1::Run& run, const std::string& node,
              v1::ExplainRunReply* reply) {
  WaitCollector collector(sources, reply);
  if (run.state() != "running") return collector.AddRobotsToStop(run);
  if (!node.empty()) return collector.Add(run, node, "", 0);
  collector.AddRun(run);
  AddCircle(sources, run.id(), collector.needed(), reply);
}

std::string TextOf(const v1::Run& run, const v1::ExplainRunReply& reply) {
  if (run.state() != "running") {
    std::string text =
        absl::StrCat("Run ", run.id(), " is ", run.state(),
                     run.reason().empty() ? "" : absl::StrCat(": ", OneLine(run.reason())), ".\n");
    if (run.state() == "done")
      absl::StrAppend(&text, "Its sink was reached, and no node was waiting or running.\n");
    for (const v1::Node& node : run.nodes()) {
      if (node.state() == "failed" || node.state() == "cancelled")
        absl::StrAppend(&text, "  ", node.name(), " ", node.state(), ": ", OneLine(node.reason()), "\n");
    }
    for (const v1::Wait& wait : reply.waits())
      absl::StrAppend(&text, "  not yet confirmed: ", OneLine(wait.detail()), "\n");
    return text;
  }
  std::string text = absl::StrCat("Run ", run.id(), reply.waits().empty() ? " goes on.\n" : " waits for:\n");
  for (const v1::Wait& wait : reply.waits()) {
    absl::StrAppend(&text, "  ", wait.node().empty() ? run.id() : wait.node(), ": ", OneLine(wait.detail()),
                    "\n");
  }
  return text;
}

}  // namespace docent::server
