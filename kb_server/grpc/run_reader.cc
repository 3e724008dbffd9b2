#include "kb_server/grpc/run_reader.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/text.h"
#include "graph/base/text_limits.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/wire/text_cut.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/robots/capability_classes.h"
#include "kb_server/robots/robot_records.h"

namespace docent::server {
namespace {

// The robots that could do what a pending invocation waits for. `wanted`: IRI of the only one, or empty. `capability`: the class
// of which it asks for an operation, or empty.
void ReadAwaited(const GraphReader& runs, const std::string& wanted, const std::string& capability,
                 v1::Invocation* out) {
  const GraphReader graph = runs.Everywhere();
  std::vector<std::string> robots;
  if (capability.empty()) {
    robots = graph.Subjects(DocentIri("offers"), Term::Iri(OperationIri(out->operation())));
  } else {
    robots = graph.Subjects(kRdfType, Term::Iri(DocentIri("Robot")));
    std::erase_if(robots, [&](const std::string& robot) { return !IsCapable(graph, robot, capability); });
  }
  for (const std::string& robot : robots) {
    if (!wanted.empty() && robot != wanted) continue;
    v1::AwaitedRobot* awaited = out->add_awaits();
    awaited->set_robot(robot);
    awaited->set_state(std::string(ToString(RobotStateOf(graph, robot))));
    if (const auto run = RunOfIri(runs.Object(robot, DocentIri("heldBy"))))
      awaited->set_held_by(run->value());
  }
}

// Those that have begun, by their numbers.
void ReadSteps(const GraphReader& graph, const std::string& iri, v1::Invocation* out) {
  std::vector<std::pair<int, v1::InvocationStep>> steps;
  for (const auto& [property, state] : {std::pair("stepDone", "done"), std::pair("stepFailed", "failed"),
                                        std::pair("stepRunning", "running")}) {
    for (const Term& label : graph.Objects(iri, DocentIri(property))) {
      int number = 0;
      if (!absl::SimpleAtoi(label.lexical.substr(0, label.lexical.find('/')), &number)) continue;
      steps.emplace_back(number, v1::InvocationStep());
      steps.back().second.set_step(label.lexical);
      steps.back().second.set_state(state);
    }
  }
  std::stable_sort(steps.begin(), steps.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto& [number, step] : steps) *out->add_steps() = std::move(step);
}

void ReadValues(const GraphReader& graph, const std::vector<Term>& variables,
                google::protobuf::RepeatedPtrField<v1::NamedTerm>* out) {
  for (const Term& variable : variables) {
    const std::vector<Term> values = graph.Objects(variable.lexical, DocentIri("variableValue"));
    if (values.empty()) continue;
    const std::string name = graph.Object(variable.lexical, DocentIri("variableName"));
    if (name.starts_with("_")) continue;  // the engine's own: the event that started it
    v1::NamedTerm* named = out->Add();
    named->set_name(name);
    ToProto(values.front(), named->mutable_value());
  }
}

// Whether a robot has yet to say how the invocation's command ended, though that was given up.
bool HasYetToEnd(const GraphReader& graph, const std::string& iri, const v1::Invocation& invocation) {
  if (invocation.robot().empty() || (invocation.state() != "cancelled" && invocation.state() != "failed"))
    return false;
  const std::vector<Term> works_for = graph.Objects(invocation.robot(), DocentIri("heldFor"));
  return std::find(works_for.begin(), works_for.end(), Term::Iri(iri)) != works_for.end();
}

void ReadInvocation(const GraphReader& graph, const std::string& iri, const std::string& wanted,
                    v1::Invocation* out) {
  out->set_operation(graph.Object(iri, DocentIri("operation")));
  out->set_state(graph.Object(iri, DocentIri("invocationState")));
  out->set_robot(graph.Object(iri, DocentIri("robot")));
  out->set_command(graph.Object(iri, DocentIri("command")));
  out->set_step(graph.Object(iri, DocentIri("step")));
  out->set_reason(graph.Object(iri, DocentIri("reason")));
  if (HasYetToEnd(graph, iri, *out)) {
    absl::StrAppend(out->mutable_reason(), out->reason().empty() ? "" : "; ",
                    "asked to stop, and its robot has not yet confirmed it");
  }
  double progress = 0;
  if (absl::SimpleAtod(graph.Object(iri, DocentIri("progress")), &progress)) out->set_progress(progress);
  ReadSteps(graph, iri, out);
  ReadValues(graph, graph.Objects(iri, DocentIri("forValue")), out->mutable_values());
  if (out->state() != "pending") return;
  std::string own = graph.Object(iri, DocentIri("wantedRobot"));
  if (own.empty()) own = wanted;
  for (const v1::NamedTerm& value : out->values()) {
    if (value.name() == "robot") own = value.value().iri();
  }
  ReadAwaited(graph, own, graph.Object(iri, DocentIri("wantedCapability")), out);
}

// 0: it is no number.
int64_t NumberIn(const std::string& text) {
  int64_t number = 0;
  return absl::SimpleAtoi(text, &number) ? number : 0;
}

// "urn:docent:run:ID/NODE/12" → 12.
int64_t NumberAtEnd(const std::string& iri) {
  return NumberIn(iri.substr(iri.rfind('/') + 1));
}

template <typename NumberOf>
std::vector<std::string> Ordered(std::vector<std::string> iris, const NumberOf& number_of) {
  std::vector<std::pair<int64_t, std::string>> numbered;
  for (const std::string& iri : iris) numbered.emplace_back(number_of(iri), iri);
  std::sort(numbered.begin(), numbered.end());
  for (size_t i = 0; i < iris.size(); ++i) iris[i] = std::move(numbered[i].second);
  return iris;
}

void ReadNode(const GraphReader& graph, const std::string& iri, const std::string& wanted, v1::Node* out) {
  out->set_name(graph.Object(iri, DocentIri("nodeName")));
  out->set_state(graph.Object(iri, DocentIri("nodeState")));
  out->set_waits_for(graph.Object(iri, DocentIri("waitsFor")));
  out->set_fired_because(graph.Object(iri, DocentIri("firedBecause")));
  out->set_reason(graph.Object(iri, DocentIri("reason")));
  out->set_since_us(MicrosOfDateTime(graph.Object(iri, DocentIri("since"))));
  for (const std::string& invocation :
       Ordered(graph.Subjects(DocentIri("ofNode"), Term::Iri(iri)), NumberAtEnd)) {
    ReadInvocation(graph, invocation, wanted, out->add_invocations());
  }
}

bool HasIncident(const GraphReader& graph, const std::string& run) {
  const std::vector<std::string> nodes = graph.Subjects(DocentIri("ofRun"), Term::Iri(run));
  return std::any_of(nodes.begin(), nodes.end(), [&graph](const std::string& node) {
    return graph.Object(node, DocentIri("nodeState")) == "incident";
  });
}

// Now, or before it ended.
bool HasTaken(const GraphReader& graph, const std::string& run, const std::string& robot) {
  const auto is_robot = [&robot](const Term& term) { return term.lexical == robot; };
  const std::vector<Term> uses = graph.Objects(run, DocentIri("usesRobot"));
  if (std::any_of(uses.begin(), uses.end(), is_robot)) return true;
  for (const std::string& node : graph.Subjects(DocentIri("ofRun"), Term::Iri(run))) {
    for (const std::string& invocation : graph.Subjects(DocentIri("ofNode"), Term::Iri(node))) {
      if (graph.Object(invocation, DocentIri("robot")) == robot) return true;
    }
  }
  return false;
}

bool IsAskedFor(const GraphReader& graph, const std::string& run, const v1::ListRunsRequest& request) {
  const std::string state = graph.Object(run, DocentIri("runState"));
  if (request.live_only() && state != "running") return false;
  if (!request.workflow().empty() && graph.Object(run, DocentIri("workflow")) != request.workflow())
    return false;
  if (request.state() == "paused") {
    if (state != "running" || graph.Object(run, DocentIri("pausedAt")).empty()) return false;
  } else if (request.state() == "incident") {
    if (state != "running" || !HasIncident(graph, run)) return false;
  } else if (!request.state().empty() && request.state() != state) {
    return false;
  }
  return request.robot().empty() || HasTaken(graph, run, request.robot());
}

}  // namespace

bool ReadRun(const GraphReader& all, const std::string& id, v1::Run* run) {
  const GraphReader graph = all.In(kRunsGraph);
  std::string iri = RunIri(RunId(id));
  std::string state = graph.Object(iri, DocentIri("runState"));
  if (state.empty()) return false;
  run->set_id(id);
  run->set_state(state);
  run->set_workflow(graph.Object(iri, DocentIri("workflow")));
  run->set_flow(graph.Object(iri, DocentIri("flow")));
  run->set_reason(graph.Object(iri, DocentIri("reason")));
  run->set_paused(!graph.Object(iri, DocentIri("pausedAt")).empty());
  run->set_started_us(MicrosOfDateTime(graph.Object(iri, Concat(kProvNs, "startedAtTime"))));
  run->set_ended_us(MicrosOfDateTime(graph.Object(iri, Concat(kProvNs, "endedAtTime"))));
  if (const std::optional<RunId> parent = RunOfIri(graph.Object(iri, DocentIri("parentRun"))))
    run->set_parent(parent->value());
  ReadValues(graph, graph.Objects(iri, DocentIri("hasVariable")), run->mutable_variables());
  ReadValues(graph, graph.Objects(iri, DocentIri("hasResult")), run->mutable_results());
  const auto position = [&graph](const std::string& node) {
    return NumberIn(graph.Object(node, DocentIri("position")));
  };
  for (const std::string& node : Ordered(graph.Subjects(DocentIri("ofRun"), Term::Iri(iri)), position)) {
    ReadNode(graph, node, graph.Object(absl::StrCat(iri, "/$robot"), DocentIri("variableValue")),
             run->add_nodes());
  }
  return true;
}

void FitRun(size_t text_bytes, v1::Run* run) {
  bool cut = CutToFit(run, text_bytes, kTextLimits.listed_bytes);
  while (run->nodes_size() > 0 && run->ByteSizeLong() > kTextLimits.listed_bytes) {
    const int kept = run->nodes_size() / 2;
    run->mutable_nodes()->DeleteSubrange(kept, run->nodes_size() - kept);
    cut = true;
  }
  run->set_texts_cut(cut);
}

absl::Status ReadRuns(const GraphReader& all, const v1::ListRunsRequest& request, v1::ListRunsReply* reply) {
  const GraphReader graph = all.In(kRunsGraph);
  static const std::vector<std::string> kStates = {"running", "paused", "incident",
                                                   "done",    "failed", "cancelled"};
  if (!request.state().empty() &&
      std::find(kStates.begin(), kStates.end(), request.state()) == kStates.end()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "\"", request.state(), "\" is no state of a run; states are ", absl::StrJoin(kStates, ", ")));
  }
  int64_t before = std::numeric_limits<int64_t>::max();
  if (!request.page_token().empty() && !absl::SimpleAtoi(request.page_token(), &before))
    return absl::InvalidArgumentError("page_token is not one that an answer gave");
  std::vector<std::pair<int64_t, std::string>> found;
  for (const std::string& iri : graph.Subjects(kRdfType, Term::Iri(DocentIri("Run")))) {
    const std::optional<RunId> run = RunOfIri(iri);
    if (!run || !IsAskedFor(graph, iri, request)) continue;
    const int64_t number = NumberIn(run->value().substr(run->value().rfind('-') + 1));
    if (number < before) found.emplace_back(number, run->value());
  }
  std::sort(found.rbegin(), found.rend());
  size_t bytes = 0;
  for (const auto& [number, id] : found) {
    v1::Run run;
    const bool full =
        request.page_size() > 0 && static_cast<uint32_t>(reply->runs_size()) == request.page_size();
    if (!full) {
      ReadRun(graph, id, &run);
      FitRun(kTextLimits.listed_text_bytes, &run);
      bytes += run.ByteSizeLong();
    }
    if (full || (reply->runs_size() > 0 && bytes > kTextLimits.listed_bytes)) {
      reply->set_next_page_token(absl::StrCat(before));
      break;
    }
    *reply->add_runs() = std::move(run);
    before = number;
  }
  return absl::OkStatus();
}

uint32_t LiveRunsOf(const GraphReader& all, const std::string& workflow) {
  const GraphReader graph = all.In(kRunsGraph);
  uint32_t live = 0;
  for (const std::string& iri : graph.Subjects(DocentIri("runState"), Term::Literal("running")))
    live += graph.Object(iri, DocentIri("workflow")) == workflow ? 1 : 0;
  return live;
}

}  // namespace docent::server
