// Sender of notifications: webhooks over HTTP POST, and topics of an MQTT broker. It tries again with a growing pause until it is
// delivered or given up (notify_attempts), and reports what became of it through the door. It keeps nothing: the engine has
// each notification until that report is in the log, so after a restart the writer gives what is left again.
//
// A receiver (host and port, or the broker) has a queue and senders of its own: one that is slow holds up nobody else. One that asks for
// time (Retry-After) is left alone for so long.
//
// Threads: Send from any; a few threads a receiver deliver, and there are no more receivers than the settings name. The
// destructor ends what is under way.
#ifndef DOCENT_KB_SERVER_WORK_NOTIFIER_H_
#define DOCENT_KB_SERVER_WORK_NOTIFIER_H_

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "graph/base/cancellation.h"
#include "graph/base/waiting_limits.h"
#include "graph/base/workflow_limits.h"
#include "graph/store/write_batch.h"
#include "kb_server/door/notification_sink.h"
#include "kb_server/work/remote_access.h"

namespace docent::server {

class Notifier final : public NotificationSink {
 public:
  struct Settings {
    std::vector<std::string> allow;  // webhooks: see RemoteAccess; none: nothing is sent
    std::string mqtt;                // HOST:PORT of the broker; empty: none
    int attempts = kWorkflowLimits.notify_attempts;
    std::chrono::milliseconds timeout{kWorkflowLimits.notify_timeout_ms};
    std::chrono::milliseconds first_pause{kWorkflowLimits.notify_first_pause_ms};
    std::chrono::milliseconds longest_pause{kWorkflowLimits.notify_longest_pause_ms};
    std::chrono::milliseconds longest_retry_after{kWaitingLimits.notify_retry_after_ms};
  };
  // Hands a report to the door; `taken(false)`: it was not taken, and is to come again.
  using Report = std::function<void(WriteBatch batch, std::function<void(bool taken)> done)>;

  Notifier(Settings settings, Report report);
  ~Notifier() override;
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;

  void Send(const Notification& notification) override;

 private:
  using SteadyTime = std::chrono::steady_clock::time_point;
  struct Delivery {
    Notification notification;
    int attempts = 0;                  // so far
    std::optional<CommandReport> end;  // it is over, and the door has not taken the report yet
  };
  using DeliveryPtr = std::shared_ptr<Delivery>;
  // Guarded by mutex_, but for what is const.
  struct Receiver {
    std::multimap<SteadyTime, DeliveryPtr> queue;  // by when it is due
    SteadyTime not_before = SteadyTime::min();     // it asked for time until then
    int senders = 0, idle = 0;                     // threads
    SteadyTime Due() const {
      return queue.empty() ? SteadyTime::max() : std::max(queue.begin()->first, not_before);
    }
  };
  struct Attempt {
    absl::Status status;
    std::optional<absl::Duration> retry_after;
  };

  // The name of the receiver; empty: nothing may be sent there.
  std::string ReceiverOf(const Notification& notification) const;
  void Add(DeliveryPtr delivery, std::chrono::milliseconds pause);
  void Work(Receiver* receiver);
  // The next delivery that is due; null: the notifier ends.
  DeliveryPtr Take(Receiver* receiver);
  // Makes one attempt, or reports.
  void Advance(const DeliveryPtr& delivery, Receiver* receiver);
  Attempt Deliver(const Notification& notification);
  Attempt Post(const Notification& notification);
  void Tell(const DeliveryPtr& delivery);

  const Settings settings_;
  const Report report_;
  const RemoteAccess allowed_;
  Cancellation cancellation_;
  absl::Mutex mutex_;
  bool ends_ ABSL_GUARDED_BY(mutex_) = false;
  std::map<std::string, Receiver> receivers_ ABSL_GUARDED_BY(mutex_);  // by name
  std::vector<std::thread> threads_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_NOTIFIER_H_
