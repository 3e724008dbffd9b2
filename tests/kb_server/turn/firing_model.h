// What an activator has to do with an event or an occurrence of its time, in the simulation: fire once, if it may.
#ifndef DOCENT_TESTS_KB_SERVER_TURN_FIRING_MODEL_H_
#define DOCENT_TESTS_KB_SERVER_TURN_FIRING_MODEL_H_

#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/store/decisions.h"
#include "gtest/gtest.h"
#include "kb_server/door/workflow_removal.h"
#include "tests/kb_server/turn/random_documents.h"
#include "tests/kb_server/turn/simulated_world.h"

namespace docent::server::test {

class FiringModel {
 public:
  // An activator fires once for each event and each occurrence of its time. Others start runs by themselves when a run ends
  // (ext:mode="queued"), or when an operator lets them again.
  void Check(const WriteBatch& batch, const std::vector<Transition>& transitions,
             const std::map<int, SimulatedActivator>& activators) {
    if (batch.run_requests.empty() && batch.documents.empty()) CheckFirings(batch, transitions, activators);
    Remember(batch);
  }

 private:
  void CheckFirings(const WriteBatch& batch, const std::vector<Transition>& transitions,
                    const std::map<int, SimulatedActivator>& activators) {
    using By = SimulatedActivator::By;
    for (const auto& [number, activator] : activators) {
      const std::string workflow = absl::StrCat("W", number);
      if (activator.by != By::kEvent && activator.by != By::kTime) continue;
      const bool occurs = activator.by == By::kEvent
                              ? TellsEvent(batch, absl::StrCat("ring", number))
                              : TellsInterval(batch, RandomDocuments::Interval(number));
      size_t fired = 0, started = 0;
      for (const Transition& t : transitions) {
        const bool starts = t.from.empty() && t.to == "running" && t.cause.starts_with("activator A") &&
                            t.subject.starts_with(absl::StrCat("F", number, "-"));
        started += starts;
        fired += starts || t.subject == absl::StrCat("activator/", workflow);
      }
      if (!deployed_.contains(workflow) || closed_.contains(workflow)) {
        EXPECT_EQ(started, 0u) << workflow << " may not start runs";
        const bool told = !occurs || !deployed_.contains(workflow) || fired > 0;
        EXPECT_TRUE(told) << "a firing of " << workflow << " is lost without a word";
      } else if (activator.queues) {
        EXPECT_GE(fired, occurs ? 1u : 0u) << workflow;
      } else {
        EXPECT_EQ(fired, occurs ? 1u : 0u) << workflow << " fires once for each occurrence";
      }
    }
  }

  // Which workflows are deployed, and which may not start runs.
  void Remember(const WriteBatch& batch) {
    for (const Document& document : batch.documents) {
      if (document.kind != Document::Kind::kCawl) continue;
      if (document.action == Document::Action::kPut) {
        deployed_.insert(absl::StrCat("W", document.name.substr(1, 1)));
      } else if (document.text == kRemovesStarts) {
        closed_[document.name].insert("disabled");
      } else if (document.text == kRemovesDisablement) {
        Opened(document.name, "disabled");
      } else {
        deployed_.erase(document.name);
        closed_.erase(document.name);
      }
    }
    for (const RunRequest& request : batch.run_requests) {
      // Of one that is not deployed, only its live runs are paused.
      if (request.kind == RunRequest::Kind::kPauseWorkflow && deployed_.contains(request.target))
        closed_[request.target].insert("paused");
      if (request.kind == RunRequest::Kind::kResumeWorkflow) Opened(request.target, "paused");
    }
  }
  void Opened(const std::string& workflow, const std::string& again) {
    const auto closed = closed_.find(workflow);
    if (closed != closed_.end() && closed->second.erase(again) > 0 && closed->second.empty())
      closed_.erase(closed);
  }

  std::set<std::string> deployed_;                       // workflows
  std::map<std::string, std::set<std::string>> closed_;  // those that may not start runs, and why
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_TURN_FIRING_MODEL_H_
