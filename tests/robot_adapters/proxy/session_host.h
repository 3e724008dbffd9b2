// A host of one command session with a clock of its own. Calls are begun at an address where nobody is: what an adapter would
// say is said by the test.
#ifndef DOCENT_TESTS_ROBOT_ADAPTERS_PROXY_SESSION_HOST_H_
#define DOCENT_TESTS_ROBOT_ADAPTERS_PROXY_SESSION_HOST_H_

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "robot_adapters/proxy/command_session.h"

namespace docent::proxy {

class FakeHost : public SessionHost {
 public:
  struct MadeCall {
    std::string address;
    FeedbackCall::Request request;
    absl::Duration timeout;
    bool is_attach() const { return std::holds_alternative<v1::AttachRequest>(request); }
    const v1::InvokeRequest& invoke() const { return std::get<v1::InvokeRequest>(request); }
  };
  struct Timer {
    absl::Time due;
    std::function<void()> task;
  };

  ~FakeHost() override {
    for (const auto& call : started_) call->Cancel();
    absl::MutexLock lock(&mutex_);
    auto all = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return ended_.size() == started_.size(); };
    mutex_.Await(absl::Condition(&all));
  }

  void Report(CommandReport report) override { reports.push_back(std::move(report)); }
  void Refused(const RobotCommand&, const std::string& why) override { refused.push_back(why); }
  bool IsConnected(const std::string&) override { return connected; }
  void Probe(const CommandId&, const std::string& address, uint64_t attempt) override {
    probes.emplace_back(address, attempt);
  }
  void Overdue(const RobotCommand&, const std::string& why) override { overdue.push_back(why); }
  std::shared_ptr<FeedbackCall> Call(const CommandId&, const std::string& address,
                                     FeedbackCall::Request request, absl::Duration timeout) override {
    calls.push_back({address, request, timeout});
    started_.push_back(FeedbackCall::Start(
        calls.size(),
        v1::RobotAdapter::NewStub(grpc::CreateChannel("127.0.0.1:1", grpc::InsecureChannelCredentials())),
        std::move(request), std::chrono::system_clock::now() + std::chrono::minutes(5),
        [](const v1::Feedback&, FeedbackCall* call) { call->Next(); },
        [this](const grpc::Status&, std::shared_ptr<FeedbackCall> ended) {
          absl::MutexLock lock(&mutex_);
          ended_.push_back(std::move(ended));
        }));
    return started_.back();
  }
  void SendCancel(const CommandId&, const std::string& address, uint64_t attempt) override {
    cancels.push_back(address);
    cancel_attempt = attempt;
  }
  void After(absl::Duration delay, const CommandId&, std::function<void()> task) override {
    delays.push_back(delay);
    timers_.push_back({now + delay, std::move(task)});
  }
  absl::Time SteadyNow() const override { return now; }

  // Time goes on, and what is due is done in its order.
  void Go(absl::Duration by) {
    const absl::Time end = now + by;
    while (true) {
      auto next = std::min_element(timers_.begin(), timers_.end(),
                                   [](const Timer& a, const Timer& b) { return a.due < b.due; });
      if (next == timers_.end() || next->due > end) break;
      now = std::max(now, next->due);
      const std::function<void()> task = std::move(next->task);
      timers_.erase(next);
      task();
    }
    now = end;
  }
  std::vector<CommandReport::Outcome> Outcomes() const {
    std::vector<CommandReport::Outcome> outcomes;
    for (const CommandReport& report : reports) outcomes.push_back(report.outcome);
    return outcomes;
  }

  absl::Time now = absl::UnixEpoch();
  bool connected = true;
  std::vector<CommandReport> reports;
  std::vector<std::string> refused, overdue, cancels;
  uint64_t cancel_attempt = 0;  // of the newest cancel
  std::vector<std::pair<std::string, uint64_t>> probes;
  std::vector<MadeCall> calls;  // the serial of the first is 1
  std::vector<absl::Duration> delays;

 private:
  std::vector<Timer> timers_;
  std::vector<std::shared_ptr<FeedbackCall>> started_;
  absl::Mutex mutex_;
  std::vector<std::shared_ptr<FeedbackCall>> ended_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent::proxy

#endif  // DOCENT_TESTS_ROBOT_ADAPTERS_PROXY_SESSION_HOST_H_
