#include "robot_adapters/sdk/activity.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "robot_adapters/sdk/decimal.h"

namespace docent::robot {

Activity::Activity(std::string robot, FactSender* facts) : robot_(std::move(robot)), facts_(facts) {
  facts_->Set(robot_, DocentIri("status"), Term::Iri(DocentIri("Standby")));
}

void Activity::OnFeedback(const v1::Feedback& feedback) {
  absl::MutexLock lock(&mutex_);
  const std::string& command = feedback.command_id();
  auto running = std::find(running_.begin(), running_.end(), command);
  switch (feedback.state()) {
    case v1::Feedback::ACCEPTED:
    case v1::Feedback::RUNNING:
      if (running == running_.end()) running_.push_back(command);
      break;
    default:
      if (running != running_.end()) running_.erase(running);
  }
  if (running_.empty()) {
    facts_->Set(robot_, DocentIri("status"), Term::Iri(DocentIri("Standby")));
    facts_->Clear(robot_, DocentIri("currentCommand"));
    facts_->Clear(robot_, DocentIri("progress"));
    return;
  }
  facts_->Set(robot_, DocentIri("status"), Term::Iri(DocentIri("Busy")));
  facts_->Set(robot_, DocentIri("currentCommand"), Term::Literal(running_.back()));
  // In hundredths: a command changes the graph at most a hundred times with it.
  if (command == running_.back()) facts_->Set(robot_, DocentIri("progress"), Decimal(feedback.progress(), 2));
}

}  // namespace docent::robot
