#include "kb_server/grpc/replay/replay_proto.h"

#include "graph/wire/term_proto.h"

namespace docent::server {
namespace {

void AddNamed(const std::string& name, const Term& value,
              google::protobuf::RepeatedPtrField<v1::NamedTerm>* to) {
  v1::NamedTerm* named = to->Add();
  named->set_name(name);
  docent::ToProto(value, named->mutable_value());
}

void ToProto(const Decision& decision, v1::ReplayStep* step) {
  step->set_turn(decision.turn);
  step->set_time_us(decision.time_us);
  step->set_cause(decision.cause);
  if (decision.kind == Decision::Kind::kState) return step->set_state(decision.to);
  step->set_operation(decision.operation);
  step->set_robot(decision.robot.value());
  for (const auto& [name, value] : decision.arguments) AddNamed(name, value, step->mutable_arguments());
}

void AddSteps(const std::vector<Decision>& decisions,
              google::protobuf::RepeatedPtrField<v1::ReplayStep>* steps) {
  for (const Decision& decision : decisions) {
    if (decision.kind != Decision::Kind::kCancel) ToProto(decision, steps->Add());
  }
}

}  // namespace

void ToProto(const Replayed& replayed, v1::ReplayReply* reply) {
  const RunCase& recorded = replayed.recorded;
  reply->set_run(recorded.run.value());
  reply->set_workflow(recorded.workflow);
  reply->set_first_turn(recorded.turns.front().offset);
  reply->set_last_turn(recorded.last_turn);
  reply->set_started_us(recorded.turns.front().time_us);
  reply->set_same(IsSame(replayed.nodes));
  reply->set_state(replayed.play.course.state);
  for (const NodeComparison& node : replayed.nodes) {
    v1::ReplayedNode* out = reply->add_nodes();
    out->set_node(node.node);
    out->set_same(node.same());
    out->set_waits_for(node.waits_for);
    out->set_missing(node.missing);
    for (const Difference& difference : node.differences) {
      v1::ReplayDifference* of_node = out->add_differences();
      of_node->set_kind(difference.kind);
      of_node->set_turn(difference.turn);
      of_node->set_recorded(difference.recorded);
      of_node->set_replayed(difference.replayed);
    }
    AddSteps(node.recorded, out->mutable_recorded());
    AddSteps(node.replayed, out->mutable_replayed());
  }
  reply->set_stopped(replayed.play.stopped);
  reply->set_stopped_node(replayed.play.stopped_node);
  reply->set_stopped_turn(replayed.play.stopped_turn);
  for (const std::string& note : replayed.play.notes) reply->add_notes(note);
}

void ToProto(const Trial& trial, const std::string& node, v1::TryNodeReply* reply) {
  reply->set_turn(trial.moment.last_turn);
  std::map<std::string, Term> before(trial.moment.values.begin(), trial.moment.values.end());
  for (const auto& [name, value] : before) AddNamed(name, value, reply->mutable_variables());
  for (const auto& [name, value] : trial.play.course.variables) {
    const auto known = before.find(name);
    if (known == before.end() || known->second != value) AddNamed(name, value, reply->mutable_bindings());
  }
  for (const Decision& decision : trial.play.course.decisions) {
    if (decision.kind == Decision::Kind::kCommand) ToProto(decision, reply->add_commands());
    if (decision.kind != Decision::Kind::kState || decision.node != node) continue;
    reply->set_state(decision.to);
    reply->set_reason(decision.cause);
    if (decision.to == "running") reply->set_opens(true);
  }
  if (reply->opens() && reply->state() == "running") reply->set_pending(trial.play.pending);
  for (const PlayedWait& wait : trial.play.waits) {
    if (wait.node != node) continue;
    reply->set_waits_for(wait.ask);
    reply->set_missing(wait.missing);
  }
}

}  // namespace docent::server
