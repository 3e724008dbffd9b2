#include "kb_server/grpc/replay/replay_proto.h"

#include <cmath>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "graph/wire/term_proto.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {
namespace {

constexpr double kAnHour = 3600, kADay = static_cast<double>(kLongestSimulation) / 1e6;

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
    if (wait.node == node) AddAlternative(wait, reply->mutable_waits_for(), reply->mutable_missing());
  }
}

void ToProto(const Simulation& simulation, v1::SimulateReply* reply) {
  const Play& play = simulation.play;
  const TimeMicros begin_us = simulation.world.turns.front().time_us;
  const auto after = [begin_us](TimeMicros time_us) { return static_cast<double>(time_us - begin_us) / 1e6; };
  reply->set_turn(simulation.world.last_turn);
  reply->set_started_us(begin_us);
  reply->set_state(play.course.state);
  reply->set_reason(play.course.reason);
  for (const Decision& decision : play.course.decisions) {
    if (decision.kind == Decision::Kind::kCancel) continue;
    v1::SimulatedStep* step = reply->add_steps();
    step->set_node(decision.node);
    step->set_after_s(after(decision.time_us));
    ToProto(decision, step->mutable_step());
    reply->set_ended_s(step->after_s());
  }
  for (const SimulatedPose& pose : play.poses) {
    v1::SimulatedPose* out = reply->add_poses();
    out->set_robot(pose.robot.value());
    out->set_after_s(after(pose.time_us));
    out->set_x(pose.x_m);
    out->set_y(pose.y_m);
  }
  for (const PlayedWait& wait : play.waits) {
    v1::SimulatedWait* out = reply->add_waits();
    out->set_node(wait.node);
    out->set_waits_for(wait.ask);
    out->set_missing(wait.missing);
  }
  reply->set_pending(play.pending);
  reply->set_stopped(play.stopped);
  for (const std::string& note : play.notes) reply->add_notes(note);
  for (const auto& [name, value] : play.course.variables) AddNamed(name, value, reply->mutable_variables());
}

absl::StatusOr<SimulationRequest> FromProto(const v1::SimulateRequest& request, const Limits& limits) {
  SimulationRequest out;
  out.text = request.cawl();
  out.name = request.name();
  out.flow = request.flow();
  auto arguments = FromProto(request.arguments(), "arguments", limits);
  if (!arguments.ok()) return arguments.status();
  out.arguments = *std::move(arguments);
  if (request.turn() != 0) out.turn = request.turn();
  const double seconds = request.seconds() == 0 ? kAnHour : request.seconds();
  if (!(seconds > 0 && seconds <= kADay)) {
    return absl::InvalidArgumentError(
        absl::StrCat("seconds: ", request.seconds(), " is not above 0 and at most ", kADay, " (a day)"));
  }
  out.lasting_us = std::llround(seconds * 1e6);
  for (int i = 0; i < request.told_size(); ++i) {
    const v1::SimulatedTelling& given = request.told(i);
    const std::string place = absl::StrCat("told[", i, "]");
    if (!(given.after_s() >= 0 && given.after_s() <= kADay)) {
      return absl::InvalidArgumentError(
          absl::StrCat(place, ".after_s: ", given.after_s(), " is not from 0 to ", kADay, " (a day)"));
    }
    SimulatedTelling telling;
    telling.after_us = std::llround(given.after_s() * 1e6);
    for (const auto& [quads, kind, what] :
         {std::tuple(&given.remove(), QuadOperation::Kind::kRemove, "remove"),
          std::tuple(&given.add(), QuadOperation::Kind::kAdd, "add")}) {
      for (int q = 0; q < quads->size(); ++q) {
        auto quad = FromProto(quads->Get(q), absl::StrCat(place, ".", what, "[", q, "]"), limits);
        if (!quad.ok()) return quad.status();
        telling.changes.push_back({kind, *std::move(quad)});
      }
    }
    out.told.push_back(std::move(telling));
  }
  return out;
}

}  // namespace docent::server
