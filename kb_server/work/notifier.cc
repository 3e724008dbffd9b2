#include "kb_server/work/notifier.h"

#include <pthread.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "kb_server/work/cloud_event.h"
#include "kb_server/work/http_fetch.h"
#include "kb_server/work/mqtt_publish.h"

namespace docent::server {
namespace {

constexpr int kSenders = 4;  // of a receiver
constexpr std::string_view kMqtt = "mqtt:";

// Nothing but another configuration can change it: there is no further attempt.
bool IsFinal(const absl::Status& status) {
  return status.code() == absl::StatusCode::kPermissionDenied ||
         status.code() == absl::StatusCode::kInvalidArgument;
}

}  // namespace

Notifier::Notifier(Settings settings, Report report)
    : settings_(std::move(settings)), report_(std::move(report)), allowed_(settings_.allow, Limits()) {}

Notifier::~Notifier() {
  cancellation_.Cancel();
  std::vector<std::thread> threads;
  {
    absl::MutexLock lock(&mutex_);
    ends_ = true;
    threads.swap(threads_);
  }
  for (std::thread& thread : threads) thread.join();
}

void Notifier::Send(const Notification& notification) {
  auto delivery = std::make_shared<Delivery>();
  delivery->notification = notification;
  Add(std::move(delivery), std::chrono::milliseconds(0));
}

std::string Notifier::ReceiverOf(const Notification& notification) const {
  if (notification.target.starts_with(kMqtt)) return settings_.mqtt.empty() ? "" : std::string(kMqtt);
  const std::optional<HttpUrl> url = ParseHttpUrl(notification.target);
  if (!url || !allowed_.IsAllowed(notification.target)) return "";
  return absl::StrCat(url->host, " ", url->port);
}

void Notifier::Add(DeliveryPtr delivery, std::chrono::milliseconds pause) {
  const std::string name = ReceiverOf(delivery->notification);
  absl::MutexLock lock(&mutex_);
  if (ends_) return;
  Receiver& receiver = receivers_[name];
  receiver.queue.emplace(std::chrono::steady_clock::now() + pause, std::move(delivery));
  // An idle sender may not have taken yet what came before.
  if (receiver.queue.size() <= static_cast<size_t>(receiver.idle) || receiver.senders == kSenders) return;
  ++receiver.senders;
  ++receiver.idle;
  threads_.emplace_back([this, &receiver] {
    pthread_setname_np(pthread_self(), "notifier");
    Work(&receiver);
  });
}

void Notifier::Work(Receiver* receiver) {
  while (const DeliveryPtr next = Take(receiver)) {
    Advance(next, receiver);
    absl::MutexLock lock(&mutex_);
    ++receiver->idle;
  }
}

Notifier::DeliveryPtr Notifier::Take(Receiver* receiver) {
  absl::MutexLock lock(&mutex_);
  while (!ends_) {
    const SteadyTime now = std::chrono::steady_clock::now(), due = receiver->Due();
    if (due <= now) break;
    const auto changed = [this, receiver, due]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
      return ends_ || receiver->Due() != due;
    };
    mutex_.AwaitWithTimeout(absl::Condition(&changed), due == SteadyTime::max()
                                                           ? absl::InfiniteDuration()
                                                           : absl::FromChrono(due - now));
  }
  if (ends_) return nullptr;
  --receiver->idle;
  return receiver->queue.extract(receiver->queue.begin()).mapped();
}

void Notifier::Advance(const DeliveryPtr& delivery, Receiver* receiver) {
  if (delivery->end) return Tell(delivery);
  const Attempt attempt = Deliver(delivery->notification);
  const absl::Status& status = attempt.status;
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
    std::chrono::milliseconds pause =
        settings_.first_pause * (int64_t{1} << std::min(delivery->attempts - 1, 20));
    pause = std::min(pause, settings_.longest_pause);
    if (attempt.retry_after) {
      const auto asked =
          std::min(absl::ToChronoMilliseconds(*attempt.retry_after), settings_.longest_retry_after);
      pause = std::max(pause, asked);
      absl::MutexLock lock(&mutex_);
      receiver->not_before = std::max(receiver->not_before, std::chrono::steady_clock::now() + asked);
    }
    return Add(delivery, pause);
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

Notifier::Attempt Notifier::Deliver(const Notification& notification) {
  if (!notification.target.starts_with(kMqtt)) return Post(notification);
  if (settings_.mqtt.empty())
    return {
        absl::PermissionDeniedError("there is no broker for MQTT; start the server with --mqtt HOST:PORT"),
        {}};
  return {PublishToMqtt(settings_.mqtt, notification.target.substr(kMqtt.size()), ToCloudEvent(notification),
                        settings_.timeout, &cancellation_),
          {}};
}

Notifier::Attempt Notifier::Post(const Notification& notification) {
  if (!allowed_.IsAllowed(notification.target)) {
    return {absl::PermissionDeniedError(
                absl::StrCat("<", notification.target,
                             "> may not be notified; start the server with --notify and this address")),
            {}};
  }
  FetchRequest request;
  request.method = "POST";
  request.url = notification.target;
  request.headers = {{"Content-Type", kCloudEventsJson}};
  request.body = ToCloudEvent(notification);
  request.timeout = settings_.timeout;
  request.reads_body = false;
  const absl::StatusOr<HttpResponse> answer = Fetch(request, &cancellation_);
  if (!answer.ok()) return {answer.status(), {}};
  if (answer->status >= 200 && answer->status < 300) return {absl::OkStatus(), {}};
  const std::string said = absl::StrCat("<", notification.target, "> answered ", answer->status);
  if (answer->status == 410) return {absl::PermissionDeniedError(said), {}};
  return {absl::UnavailableError(said), RetryAfterOf(answer->headers, absl::Now())};
}

}  // namespace docent::server
