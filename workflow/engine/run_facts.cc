#include "workflow/engine/run_facts.h"

#include <algorithm>
#include <iterator>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "kb_server/base/text.h"
#include "kb_server/rdf/vocabulary.h"

namespace docent {
namespace {

bool Before(const TermQuad& a, const TermQuad& b) {
  return std::tie(a.subject, a.predicate, a.object) < std::tie(b.subject, b.predicate, b.object);
}

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
  void About(std::string iri) { subject_ = Term::Iri(std::move(iri)); }
  void Say(std::string_view predicate, Term object) {
    quads_.push_back({subject_, Term::Iri(std::string(predicate)), std::move(object), graph_});
  }
  void SayDocent(std::string_view local, Term object) { Say(DocentIri(local), std::move(object)); }
  void SayText(std::string_view local, const std::string& text) {
    if (!text.empty()) SayDocent(local, Term::Literal(text));
  }
  std::vector<TermQuad> Take() {
    std::sort(quads_.begin(), quads_.end(), Before);
    quads_.erase(std::unique(quads_.begin(), quads_.end()), quads_.end());
    return std::move(quads_);
  }

 private:
  Term graph_ = Term::Iri(std::string(kRunsGraph));
  Term subject_;
  std::vector<TermQuad> quads_;
};

void WriteInvocation(const InvocationState& invocation, const cawl::Node& node, const std::string& iri,
                     const std::string& node_iri, Writer* out) {
  const cawl::Invoke& invoke = node.invokes[invocation.invoke];
  out->About(iri);
  out->Say(kRdfType, Term::Iri(DocentIri("Invocation")));
  out->SayDocent("ofNode", Term::Iri(node_iri));
  out->SayText("operation", invoke.operation.value.empty() ? invoke.subflow.value : invoke.operation.value);
  out->SayText("invocationState", std::string(ToString(invocation.state)));
  if (!invocation.robot.empty()) out->SayDocent("robot", Term::Iri(invocation.robot.value()));
  if (!invocation.child.empty()) out->SayDocent("childRun", Term::Iri(RunIri(invocation.child)));
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
  out->Say(kRdfType, Term::Iri(DocentIri("NodeInstance")));
  out->SayDocent("ofRun", Term::Iri(RunIri(run.id)));
  out->SayText("nodeName", node.name.value);
  out->SayText("nodeState", std::string(ToString(state.state)));
  out->SayText("waitsFor", state.waits_for);
  out->SayText("firedBecause", state.fired_because);
  if (state.fired_us != 0) out->SayDocent("firedAt", DateTime(state.fired_us));
  if (state.since_us != 0) out->SayDocent("since", DateTime(state.since_us));
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

std::vector<TermQuad> RunFacts(const Run& run) {
  Writer out;
  out.About(RunIri(run.id));
  out.Say(kRdfType, Term::Iri(DocentIri("Run")));
  out.SayText("workflow", run.document->name.value);
  out.SayText("flow", run.Flow().name.value);
  out.SayText("runState", std::string(ToString(run.state)));
  out.SayText("reason", run.reason);
  out.Say(Concat(kProvNs, "startedAtTime"), DateTime(run.started_us));
  if (run.ended_us != 0) out.Say(Concat(kProvNs, "endedAtTime"), DateTime(run.ended_us));
  if (!run.parent.empty()) out.SayDocent("parentRun", Term::Iri(RunIri(run.parent)));
  for (const RobotId& robot : run.robots) out.SayDocent("usesRobot", Term::Iri(robot.value()));
  for (const auto& [name, value] : run.variables) {
    std::string iri = absl::StrCat(RunIri(run.id), "/$", name);
    out.About(RunIri(run.id));
    out.SayDocent("hasVariable", Term::Iri(iri));
    out.About(iri);
    out.SayText("variableName", name);
    out.SayDocent("variableValue", value);
  }
  for (size_t i = 0; i < run.nodes.size(); ++i) WriteNode(run, i, &out);
  return out.Take();
}

void DiffFacts(const std::vector<TermQuad>& before, const std::vector<TermQuad>& after,
               std::vector<TermQuad>* add, std::vector<TermQuad>* remove) {
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(*add),
                      Before);
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(*remove),
                      Before);
}

}  // namespace docent
