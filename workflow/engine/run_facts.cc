#include "workflow/engine/run_facts.h"

#include <algorithm>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "kb_server/base/text.h"
#include "kb_server/rdf/vocabulary.h"

namespace docent {
namespace {

Term DateTime(TimeMicros time_us) {
  std::string text =
      absl::FormatTime("%Y-%m-%dT%H:%M:%E3S", absl::FromUnixMicros(time_us), absl::UTCTimeZone());
  // the canonical form has no trailing zeros in the fraction
  while (text.back() == '0' && text.find('.') != std::string::npos) text.pop_back();
  if (text.back() == '.') text.pop_back();
  return Term::Literal(text + "Z", std::string(kXsdDateTime));
}

Term Decimal(double value) {
  std::string text = absl::StrFormat("%.2f", value);
  while (text.back() == '0' && text[text.size() - 2] != '.') text.pop_back();
  return Term::Literal(text, std::string(kXsdDecimal));
}

class Writer {
 public:
  explicit Writer(Dictionary* dictionary)
      : dictionary_(*dictionary), graph_(dictionary_.InternIri(kRunsGraph)) {}

  void About(std::string_view iri) { subject_ = Iri(iri); }
  void Say(std::string_view predicate, TermId object) {
    quads_.push_back({subject_, Iri(predicate), object, graph_});
  }
  void SayDocent(std::string_view local, TermId object) { Say(DocentIri(local), object); }
  void SayDocent(std::string_view local, const Term& object) { SayDocent(local, dictionary_.Intern(object)); }
  void SayText(std::string_view local, std::string_view text) {
    if (!text.empty()) SayDocent(local, Term::Literal(std::string(text)));
  }
  TermId Iri(std::string_view iri) { return dictionary_.InternIri(iri); }
  TermId Time(TimeMicros time_us) {
    if (time_us != time_us_ || time_.IsNone()) {  // most are that of the turn
      time_us_ = time_us;
      time_ = dictionary_.Intern(DateTime(time_us));
    }
    return time_;
  }
  std::vector<Quad> Take() {
    std::sort(quads_.begin(), quads_.end());
    quads_.erase(std::unique(quads_.begin(), quads_.end()), quads_.end());
    return std::move(quads_);
  }

 private:
  Dictionary& dictionary_;
  const TermId graph_;
  TermId subject_;
  TimeMicros time_us_ = 0;
  TermId time_;
  std::vector<Quad> quads_;
};

void WriteInvocation(const InvocationState& invocation, const cawl::Node& node, const std::string& iri,
                     const std::string& node_iri, Writer* out) {
  const cawl::Invoke& invoke = node.invokes[invocation.invoke];
  out->About(iri);
  out->Say(kRdfType, out->Iri(DocentIri("Invocation")));
  out->SayDocent("ofNode", out->Iri(node_iri));
  out->SayText("operation", invoke.operation.value.empty() ? invoke.subflow.value : invoke.operation.value);
  out->SayText("invocationState", ToString(invocation.state));
  if (!invocation.robot.empty()) out->SayDocent("robot", out->Iri(invocation.robot.value()));
  if (!invocation.child.empty()) out->SayDocent("childRun", out->Iri(RunIri(invocation.child)));
  for (const OpenCommand& open : invocation.commands) out->SayText("command", open.command.id.value());
  out->SayText("step", invocation.step);
  if (invocation.state == WorkState::kRunning) out->SayDocent("progress", Decimal(invocation.progress));
  out->SayText("reason", invocation.reason);
}

void WriteNode(const Run& run, size_t index, Writer* out) {
  const NodeState& state = run.nodes[index];
  const cawl::Node& node = run.Flow().nodes[index];
  std::string iri = absl::StrCat(RunIri(run.id), "/", node.name.value);
  out->About(iri);
  out->Say(kRdfType, out->Iri(DocentIri("NodeInstance")));
  out->SayDocent("ofRun", out->Iri(RunIri(run.id)));
  out->SayText("nodeName", node.name.value);
  out->SayText("nodeState", ToString(state.state));
  out->SayText("waitsFor", state.waits_for);
  out->SayText("firedBecause", state.fired_because);
  if (state.fired_us != 0) out->SayDocent("firedAt", out->Time(state.fired_us));
  if (state.since_us != 0) out->SayDocent("since", out->Time(state.since_us));
  out->SayText("reason", state.reason);
  for (size_t i = 0; i < state.invocations.size(); ++i) {
    WriteInvocation(state.invocations[i], node, absl::StrCat(iri, "/", i), iri, out);
  }
}

}  // namespace

std::string_view ToString(WorkState state) {
  switch (state) {
    case WorkState::kInactive:
      return "inactive";
    case WorkState::kWaiting:
      return "waiting";
    case WorkState::kPending:
      return "pending";
    case WorkState::kRunning:
      return "running";
    case WorkState::kDone:
      return "done";
    case WorkState::kFailed:
      return "failed";
    case WorkState::kSkipped:
      return "skipped";
    case WorkState::kCancelled:
      return "cancelled";
  }
  return "";
}

std::string RunIri(const RunId& run) {
  return absl::StrCat("urn:docent:run:", run.value());
}

std::vector<Quad> RunFacts(const Run& run, Dictionary* dictionary) {
  Writer out(dictionary);
  const std::string run_iri = RunIri(run.id);
  out.About(run_iri);
  out.Say(kRdfType, out.Iri(DocentIri("Run")));
  out.SayText("workflow", run.document->name.value);
  out.SayText("flow", run.Flow().name.value);
  out.SayText("runState", ToString(run.state));
  out.SayText("reason", run.reason);
  out.Say(Concat(kProvNs, "startedAtTime"), out.Time(run.started_us));
  if (run.ended_us != 0) out.Say(Concat(kProvNs, "endedAtTime"), out.Time(run.ended_us));
  if (!run.parent.empty()) out.SayDocent("parentRun", out.Iri(RunIri(run.parent)));
  for (const RobotId& robot : run.robots) out.SayDocent("usesRobot", out.Iri(robot.value()));
  for (const auto& [name, value] : run.variables) {
    std::string iri = absl::StrCat(run_iri, "/$", name);
    out.About(run_iri);
    out.SayDocent("hasVariable", out.Iri(iri));
    out.About(iri);
    out.SayText("variableName", name);
    out.SayDocent("variableValue", value);
  }
  for (size_t i = 0; i < run.nodes.size(); ++i) WriteNode(run, i, &out);
  return out.Take();
}

void DiffFacts(const std::vector<Quad>& before, const std::vector<Quad>& after, std::vector<Quad>* add,
               std::vector<Quad>* remove) {
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(*add));
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(*remove));
}

}  // namespace docent
