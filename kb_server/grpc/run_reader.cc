#include "kb_server/grpc/run_reader.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/robots/robot_records.h"

namespace docent::server {
namespace {

// The robots that could do what a pending invocation waits for. `wanted`: IRI of the only one, or empty.
void ReadAwaited(const GraphReader& graph, const std::string& wanted, v1::Invocation* out) {
  for (const std::string& robot :
       graph.Subjects(DocentIri("offers"), Term::Iri(OperationIri(out->operation())))) {
    if (!wanted.empty() && robot != wanted) continue;
    v1::AwaitedRobot* awaited = out->add_awaits();
    awaited->set_robot(robot);
    awaited->set_state(std::string(ToString(RobotStateOf(graph, robot))));
    if (const auto run = RunOfIri(graph.Object(robot, DocentIri("heldBy"))))
      awaited->set_held_by(run->value());
  }
}

void ReadInvocation(const GraphReader& graph, const std::string& iri, const std::string& wanted,
                    v1::Invocation* out) {
  out->set_operation(graph.Object(iri, DocentIri("operation")));
  out->set_state(graph.Object(iri, DocentIri("invocationState")));
  out->set_robot(graph.Object(iri, DocentIri("robot")));
  out->set_command(graph.Object(iri, DocentIri("command")));
  out->set_step(graph.Object(iri, DocentIri("step")));
  out->set_reason(graph.Object(iri, DocentIri("reason")));
  double progress = 0;
  if (absl::SimpleAtod(graph.Object(iri, DocentIri("progress")), &progress)) out->set_progress(progress);
  if (out->state() == "pending") ReadAwaited(graph, wanted, out);
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

void ReadValues(const GraphReader& graph, const std::vector<Term>& variables,
                google::protobuf::RepeatedPtrField<v1::NamedTerm>* out) {
  for (const Term& variable : variables) {
    const std::vector<Term> values = graph.Objects(variable.lexical, DocentIri("variableValue"));
    if (values.empty()) continue;
    v1::NamedTerm* named = out->Add();
    named->set_name(graph.Object(variable.lexical, DocentIri("variableName")));
    ToProto(values.front(), named->mutable_value());
  }
}

}  // namespace

bool ReadRun(const GraphReader& graph, const std::string& id, v1::Run* run) {
  std::string iri = RunIri(RunId(id));
  std::string state = graph.Object(iri, DocentIri("runState"));
  if (state.empty()) return false;
  run->set_id(id);
  run->set_state(state);
  run->set_workflow(graph.Object(iri, DocentIri("workflow")));
  run->set_flow(graph.Object(iri, DocentIri("flow")));
  run->set_reason(graph.Object(iri, DocentIri("reason")));
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

std::vector<std::string> RunIds(const GraphReader& graph, bool live_only) {
  std::vector<std::pair<std::string, std::string>> by_time;
  for (const std::string& iri : graph.Subjects(kRdfType, Term::Iri(DocentIri("Run")))) {
    const std::optional<RunId> run = RunOfIri(iri);
    if (!run || (live_only && graph.Object(iri, DocentIri("runState")) != "running")) continue;
    by_time.emplace_back(graph.Object(iri, Concat(kProvNs, "startedAtTime")), run->value());
  }
  std::sort(by_time.begin(), by_time.end());
  std::vector<std::string> ids;
  for (auto& [time, id] : by_time) ids.push_back(std::move(id));
  return ids;
}

}  // namespace docent::server
