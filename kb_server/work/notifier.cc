#include "kb_server/work/notifier.h"

#include <pthread.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "kb_server/work/cloud_event.h"
#include "kb_server/work/http_fetch.h"
#include "kb_server/work/mqtt_publish.h"

namespace docent::server {
namespace {

constexpr int kSenders = 4;  // so that one slow receiver does not hold up the others
constexpr std::string_view kMqtt = "mqtt:";

// Nothing but another configuration can change it: there is no further attempt.
bool IsFinal(const absl::Status& status) {
  return status.code() == absl::StatusCode::kPermissionDenied ||
         status.code() == absl::StatusCode::kInvalidArgument;
}

}  // namespace

Notifier::Notifier(Settings settings, Report report)
    : settings_(std::move(settings)), report_(std::move(report)), allowed_(settings_.allow, Limits()) {
  for (int i = 0; i < kSenders; ++i) {
    threads_.emplace_back([this] {
      pthread_setname_np(pthread_self(), "notifier");
      Work();
    });
  }
}

Notifier::~Notifier() {
  cancellation_.Cancel();
  {
    absl::MutexLock lock(&mutex_);
    ends_ = true;
  }
  for (std::thread& thread : threads_) thread.join();
}

void Notifier::Send(const Notification& notification) {
  auto delivery = std::make_shared<Delivery>();
  delivery->notification = notification;
  Add(std::move(delivery), std::chrono::milliseconds(0));
}

void Notifier::Add(DeliveryPtr delivery, std::chrono::milliseconds pause) {
  absl::MutexLock lock(&mutex_);
  if (ends_) return;
  queue_.emplace(std::chrono::steady_clock::now() + pause, std::move(delivery));
}

void Notifier::Work() {
  while (true) {
    DeliveryPtr next;
    {
      absl::MutexLock lock(&mutex_);
      while (!ends_ && (queue_.empty() || queue_.begin()->first > std::chrono::steady_clock::now())) {
        const SteadyTime due = queue_.empty() ? SteadyTime::max() : queue_.begin()->first;
        const auto comes_before = [this, due]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
          return ends_ || (!queue_.empty() && queue_.begin()->first < due);
        };
        mutex_.AwaitWithTimeout(absl::Condition(&comes_before),
                                queue_.empty() ? absl::InfiniteDuration()
                                               : absl::FromChrono(due - std::chrono::steady_clock::now()));
      }
      if (ends_) return;
      next = std::move(queue_.begin()->second);
      queue_.erase(queue_.begin());
    }
    Advance(next);
  }
}

void Notifier::Advance(const DeliveryPtr& delivery) {
  if (delivery->end) return Tell(delivery);
  const absl::Status status = Deliver(delivery->notification);
  if (absl::IsCancelled(status)) return;  // the server ends
  ++delivery->attempts;
  CommandReport report;
  report.command = delivery->notification.id;
  if (status.ok()) {
    report.outcome = CommandReport::Outcome::kSucceeded;
  } else if (IsFinal(status) || delivery->attempts >= settings_.attempts) {
    report.outcome = CommandReport::Outcome::kFailed;
    report.message = std::string(status.message());
    if (!IsFinal(status))
      absl::StrAppend(&report.message, "; given up after ", delivery->attempts,
                      " attempts (the limit notify_attempts is ", settings_.attempts, ")");
  } else {
    const auto pause = settings_.first_pause * (int64_t{1} << std::min(delivery->attempts - 1, 20));
    return Add(delivery, std::min<std::chrono::milliseconds>(pause, settings_.longest_pause));
  }
  delivery->end = std::move(report);
  Tell(delivery);
}

void Notifier::Tell(const DeliveryPtr& delivery) {
  WriteBatch batch;
  batch.reports.push_back(*delivery->end);
  report_(std::move(batch), [this, delivery](bool taken) {
    if (!taken) Add(delivery, settings_.first_pause);
  });
}

absl::Status Notifier::Deliver(const Notification& notification) {
  if (!notification.target.starts_with(kMqtt)) return Post(notification);
  if (settings_.mqtt.empty())
    return absl::PermissionDeniedError("there is no broker for MQTT; start the server with --mqtt HOST:PORT");
  return PublishToMqtt(settings_.mqtt, notification.target.substr(kMqtt.size()), ToCloudEvent(notification),
                       settings_.timeout, &cancellation_);
}

absl::Status Notifier::Post(const Notification& notification) {
  if (!allowed_.IsAllowed(notification.target)) {
    return absl::PermissionDeniedError(absl::StrCat(
        "<", notification.target, "> may not be notified; start the server with --notify and this address"));
  }
  FetchRequest request;
  request.method = "POST";
  request.url = notification.target;
  request.headers = {{"Content-Type", kCloudEventsJson}};
  request.body = ToCloudEvent(notification);
  request.timeout = settings_.timeout;
  request.reads_body = false;
  const absl::StatusOr<HttpResponse> answer = Fetch(request, &cancellation_);
  if (!answer.ok()) return answer.status();
  if (answer->status >= 200 && answer->status < 300) return absl::OkStatus();
  const std::string said = absl::StrCat("<", notification.target, "> answered ", answer->status);
  return answer->status == 410 ? absl::PermissionDeniedError(said) : absl::UnavailableError(said);
}

}  // namespace docent::server
