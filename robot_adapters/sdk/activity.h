// The robot's activity as facts: docent:status, docent:currentCommand, docent:progress. Thread-safe.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_ACTIVITY_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_ACTIVITY_H_

#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "robot_adapters/sdk/command_table.h"
#include "robot_adapters/sdk/fact_sender.h"

namespace docent::robot {

// Hears the feedback of every command of the adapter.
class Activity final : public FeedbackWatcher {
 public:
  // `facts` must outlive it. Tells docent:Standby at once.
  Activity(std::string robot, FactSender* facts);

  void OnFeedback(const v1::Feedback& feedback) override;

 private:
  const std::string robot_;
  FactSender* const facts_;
  absl::Mutex mutex_;
  std::vector<std::string> running_ ABSL_GUARDED_BY(mutex_);  // command ids; the newest last
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_ACTIVITY_H_
