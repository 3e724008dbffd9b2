// Notifications of a node of a run (ext:notify): the engine decides them and keeps them until it is told what became of them.
#include "workflow/engine/run_notifications.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "graph/base/overload.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/docent_iris.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {

// The text itself, or the value of the variable that it names.
absl::StatusOr<std::string> RunStepper::TextOf(const cawl::Text& text, const TermBinding* binding) const {
  if (!text.value.starts_with("$")) return text.value;
  const std::string name = text.value.substr(1);
  const std::optional<Term> value = Value(name, binding);
  if (!value) return absl::FailedPreconditionError(absl::StrCat("variable $", name, " has no value"));
  return value->IsBlank() ? absl::StrCat("_:", value->lexical) : value->lexical;
}

// One for each binding of forEach, all of them or none.
absl::Status RunStepper::Notify(size_t index, const cawl::Action& action) {
  NodeState& node = run_.nodes[index];
  const auto refused = [](const absl::Status& why) {
    return WithMessage(why, absl::StrCat("it cannot notify: ", why.message()));
  };
  std::vector<Notification> all;
  const auto bindings = BindingsOf(index);
  if (!bindings.ok()) return bindings.status();
  for (const TermBinding& binding : *bindings) {
    Notification one;
    // With the time, as commands: a server whose older backup was put back counts its runs anew. A node that opens again in the
    // same turn notifies again.
    for (int again = 1; one.id.empty() || core_.outbox.contains(one.id); ++again)
      one.id = CommandId(absl::StrCat(Subject(index), "/", node.iteration, "/notify.",
                                      &action - flow_.nodes[index].actions.data() + 1, ".", all.size(),
                                      again > 1 ? absl::StrCat(".", again) : "", "@", core_.input->now_us));
    absl::StatusOr<std::string> target = TextOf(action.target, &binding);
    if (!target.ok()) return refused(target.status());
    absl::StatusOr<std::string> subject = TextOf(action.event_subject, &binding);
    if (!subject.ok()) return refused(subject.status());
    one.target = *std::move(target);
    one.subject = *std::move(subject);
    one.source = RunIri(run_.id);
    one.type = action.event_type.empty() ? cawl::kDefaultEventType : action.event_type.value;
    one.time_us = core_.input->now_us;
    for (const cawl::Text& name : action.data) one.data.emplace_back(name.value, Value(name.value, &binding));
    all.push_back(std::move(one));
  }
  if (core_.outbox.size() + all.size() > kWorkflowLimits.notifications_open) {
    return refused(absl::ResourceExhaustedError(
        absl::StrCat("more than ", kWorkflowLimits.notifications_open,
                     " notifications would wait to be delivered; the limit is notifications_open")));
  }
  for (Notification& one : all) {
    core_.Say(Subject(index), "running", "running", absl::StrCat("notifies ", one.target));
    NoteTold(index, action);
    core_.undo_outbox.try_emplace(one.id, std::nullopt);
    core_.outbox[one.id] = {one, run_.id, index};
    if (action.waits) node.actions.awaited.insert(one.id);
    core_.output->notifications.push_back(std::move(one));
  }
  if (action.waits && !all.empty())
    node.reason = absl::StrCat("what it notifies is not delivered yet: ", action.target.value);
  return absl::OkStatus();
}

void RunStepper::Delivered(size_t index, const CommandReport& report) {
  NodeState& node = run_.nodes[index];
  if (!GoesOn() || node.state != WorkState::kRunning || node.actions.awaited.erase(report.command) == 0)
    return;
  if (report.outcome != CommandReport::Outcome::kSucceeded)
    return NodeImpossible(
        index, absl::UnavailableError(absl::StrCat("its notification was not delivered: ", report.message)));
  if (node.actions.awaited.empty()) node.reason.clear();
}

// A notification was delivered, or given up.
void TakeDelivery(Engine::Core* core, const CommandReport& report) {
  const auto open = core->outbox.find(report.command);
  const OpenNotification of = open->second;
  core->undo_outbox.try_emplace(report.command, of);
  core->outbox.erase(open);
  const bool delivered = report.outcome == CommandReport::Outcome::kSucceeded;
  const std::string& id = report.command.value();
  core->Say(id.substr(0, id.find('/', id.find('/') + 1)), "notifying", delivered ? "notified" : "failed",
            absl::StrCat(of.notification.target, report.message.empty() ? "" : ": ", report.message));
  if (Run* run = core->Mutable(of.run)) {
    RunStepper(core, run).Delivered(of.node, report);
    core->touched.insert(of.run);
  }
}

std::vector<Notification> Engine::OpenNotifications() const {
  std::vector<Notification> open;
  for (const auto& [id, one] : core_->outbox) open.push_back(one.notification);
  return open;
}

}  // namespace docent::engine
