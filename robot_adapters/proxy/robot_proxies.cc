#include "robot_adapters/proxy/robot_proxies.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "graph/base/steady_clock.h"
#include "robot_adapters/proxy/adapter_channels.h"
#include "robot_adapters/proxy/command_session.h"
#include "robot_adapters/proxy/event_loop.h"
#include "spdlog/spdlog.h"

namespace docent::proxy {
namespace {

constexpr std::chrono::milliseconds kCancelTimeout{2000};
constexpr std::chrono::milliseconds kProbeTimeout{2000};

// How fast the feedback of one call is read: some messages at once, and then so many in a second. Loop thread only.
class Pace {
 public:
  // The pause after a message that is done with at `now`.
  absl::Duration After(absl::Time now) {
    due_ = std::max(due_, now - kAtOnce * kEach) + kEach;
    return std::max(due_ - now, absl::ZeroDuration());
  }
  bool told = false;  // that its feedback is refused

 private:
  static constexpr int kAtOnce = 50;
  static constexpr absl::Duration kEach = absl::Milliseconds(10);
  absl::Time due_ = absl::InfinitePast();
};

}  // namespace

class RobotProxies::Impl final : public SessionHost {
 public:
  Impl(std::function<void(WriteBatch)> report, const ProxySettings& settings, const Clock* clock)
      : report_(std::move(report)), settings_(settings), clock_(clock != nullptr ? clock : &steady_clock_) {}

  ~Impl() override {
    loop_.Post([this] {
      closing_ = true;
      for (auto& [id, entry] : sessions_) entry.session->Abandon();
      sessions_.clear();
    });
    // gRPC still calls back for calls that were cancelled, and each callback posts to the loop.
    absl::MutexLock lock(&calls_mutex_);
    auto closed = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(calls_mutex_) { return closed_ && calls_ == 0; };
    loop_.Post([this] {
      absl::MutexLock lock(&calls_mutex_);
      closed_ = true;
    });
    calls_mutex_.Await(absl::Condition(&closed));
  }

  void SetAdapter(const RobotId& robot, const std::string& address, const std::string& incarnation) {
    loop_.Post([this, robot, address, incarnation] {
      adapters_[robot.value()] = {address, incarnation};
      for (auto& [id, entry] : sessions_) {
        if (entry.session->robot() == robot) entry.session->UseAdapter(address, incarnation);
      }
      for (auto next = sessions_.begin(); next != sessions_.end();) ForgetIfDone(next++);
    });
  }

  void NeverSend(const RobotCommand& command) {
    loop_.Post([this, command] {
      if (sessions_.contains(command.id)) return;
      CommandReport report;
      report.command = command.id;
      report.outcome = CommandReport::Outcome::kNotBegun;
      report.message = "cancelled before it was sent";
      Report(std::move(report));
    });
  }

  void Begin(const RobotCommand& command, bool may_have_been_sent, CommandWish wish) {
    // The time left counts from here, not from when the loop gets to it.
    const absl::Duration left = command.deadline_us != 0
                                    ? absl::Microseconds(command.deadline_us - clock_->Now())
                                    : absl::FromChrono(settings_.default_deadline);
    ++queued_;
    loop_.Post([this, command, left, may_have_been_sent, wish] {
      Open(command, left, may_have_been_sent);
      Wish(command.id, wish);  // before an adapter can answer: what is not to begin does not
      --queued_;
    });
  }

  void Change(const CommandId& command, CommandWish wish) {
    loop_.Post([this, command, wish] { Wish(command, wish); });
  }

  // SessionHost
  void Report(CommandReport report) override {
    WriteBatch batch;
    batch.reports.push_back(std::move(report));
    report_(std::move(batch));
  }

  void Refused(const RobotCommand& command, const std::string& why) override {
    ++refused_;
    const auto found = sessions_.find(command.id);
    if (found != sessions_.end() && ++found->second.refused > 1) return;  // the first says what is wrong
    spdlog::warn("{}: feedback about command {} is refused: {}", command.robot.value(), command.id.value(),
                 why);
  }

  void Overdue(const RobotCommand& command, const std::string& why) override {
    spdlog::warn("{}: command {}: {}; waiting for its end", command.robot.value(), command.id.value(), why);
  }

  uint64_t refused() const { return refused_; }
  size_t open() const { return queued_ + open_; }

  bool IsConnected(const std::string& address) override { return channels_.IsConnected(address); }

  void Probe(const CommandId& command, const std::string& address, uint64_t attempt) override {
    struct DescribeCall {
      std::shared_ptr<v1::RobotAdapter::Stub> stub;
      grpc::ClientContext context;
      v1::DescribeRequest request;
      v1::RobotDescription reply;
    };
    auto* call = new DescribeCall;  // owned by the task that its end posts; see DoneCallback
    call->stub = channels_.StubFor(address);
    call->context.set_deadline(std::chrono::system_clock::now() + kProbeTimeout);
    AddCalls(1);
    call->stub->async()->Describe(
        &call->context, &call->request, &call->reply,
        [this, call, command, attempt](const grpc::Status& status) {
          loop_.Post([this, ended = std::shared_ptr<DescribeCall>(call), command, attempt, status] {
            With(command, [&](CommandSession& session) {
              session.OnProbed(attempt, status, ended->reply.incarnation());
            });
            AddCalls(-1);
          });
        });
  }

  std::shared_ptr<FeedbackCall> Call(const CommandId& command, const std::string& address,
                                     FeedbackCall::Request request, absl::Duration timeout) override {
    AddCalls(1);
    const uint64_t serial = ++serials_;
    return FeedbackCall::Start(
        serial, channels_.StubFor(address), std::move(request),
        std::chrono::system_clock::now() +
            absl::ToChronoMicroseconds(std::max(timeout, absl::ZeroDuration())),
        [this, command, serial, pace = std::make_shared<Pace>()](v1::Feedback feedback, FeedbackCall* call) {
          loop_.Post([this, command, serial, pace, call, feedback = std::move(feedback)] {
            if (!With(command, [&](CommandSession& session) { session.OnFeedback(serial, feedback); })) {
              ++refused_;
              if (!std::exchange(pace->told, true))
                spdlog::warn("feedback about command {} is refused: the command has ended", command.value());
            }
            const absl::Duration pause = pace->After(absl::Now());
            if (pause == absl::ZeroDuration() || closing_) return call->Next();
            loop_.PostAfter(pause, [call] { call->Next(); });
          });
        },
        [this, command, serial](const grpc::Status& status, std::shared_ptr<FeedbackCall> ended) {
          loop_.Post([this, command, serial, status, ended = std::move(ended)] {
            With(command, [&](CommandSession& session) { session.OnCallEnded(serial, status); });
            AddCalls(-1);
          });
        });
  }

  void SendCancel(const CommandId& command, const std::string& address, uint64_t attempt) override {
    struct CancelCall {
      std::shared_ptr<v1::RobotAdapter::Stub> stub;
      grpc::ClientContext context;
      v1::CancelRequest request;
      v1::CancelReply reply;
    };
    auto* call = new CancelCall;  // owned by the task that its end posts; see DoneCallback
    call->stub = channels_.StubFor(address);
    call->context.set_deadline(std::chrono::system_clock::now() + kCancelTimeout);
    call->request.set_command_id(command.value());
    AddCalls(1);
    call->stub->async()->Cancel(
        &call->context, &call->request, &call->reply,
        [this, call, command, attempt](const grpc::Status& status) {
          loop_.Post([this, ended = std::shared_ptr<CancelCall>(call), command, attempt,
                      known = status.ok() && call->reply.known()] {
            With(command, [&](CommandSession& session) { session.OnCancelAnswered(attempt, known); });
            AddCalls(-1);
          });
        });
  }

  void After(absl::Duration delay, const CommandId& command, std::function<void()> task) override {
    sessions_.at(command).timers.push_back(loop_.PostAfter(
        delay, [this, command, task = std::move(task)] { With(command, [&](CommandSession&) { task(); }); }));
  }

  absl::Time SteadyNow() const override { return absl::FromUnixMicros(clock_->Now()); }

 private:
  void Open(const RobotCommand& command, absl::Duration left, bool may_have_been_sent) {
    if (closing_ || sessions_.contains(command.id)) return;
    sessions_[command.id].session =
        std::make_unique<CommandSession>(this, settings_, command, left, may_have_been_sent);
    open_ = sessions_.size();
    const Adapter& adapter = adapters_[command.robot.value()];
    With(command.id,
         [&](CommandSession& session) { session.UseAdapter(adapter.address, adapter.incarnation); });
  }

  void Wish(const CommandId& command, CommandWish wish) {
    if (wish == CommandWish::kNotBegin)
      With(command, [](CommandSession& session) { session.Recall(); });
    else if (wish == CommandWish::kEnd)
      With(command, [](CommandSession& session) { session.Cancel(); });
  }

  struct Entry {
    std::unique_ptr<CommandSession> session;
    std::vector<EventLoop::Timer> timers;  // of the session
    uint64_t refused = 0;                  // feedback
  };
  using Sessions = std::map<CommandId, Entry>;

  // False: the command has ended.
  bool With(const CommandId& command, const std::function<void(CommandSession&)>& act) {
    auto found = sessions_.find(command);
    if (found == sessions_.end()) return false;
    act(*found->second.session);
    ForgetIfDone(found);
    return true;
  }

  void ForgetIfDone(Sessions::iterator place) {
    if (!place->second.session->done()) return;
    for (const EventLoop::Timer& timer : place->second.timers) loop_.Cancel(timer);
    if (place->second.refused > 1) {
      spdlog::warn("feedback about command {} was refused {} times", place->first.value(),
                   place->second.refused);
    }
    sessions_.erase(place);
    open_ = sessions_.size();
  }

  void AddCalls(int n) {
    absl::MutexLock lock(&calls_mutex_);
    calls_ += n;
  }

  const std::function<void(WriteBatch)> report_;
  const ProxySettings settings_;
  const SteadyClock steady_clock_;
  const Clock* const clock_;

  std::atomic<uint64_t> refused_ = 0;          // feedback
  std::atomic<size_t> queued_ = 0, open_ = 0;  // commands: for the loop, and in sessions_

  // of the loop's thread
  AdapterChannels channels_;
  struct Adapter {
    std::string address, incarnation;
  };
  std::map<std::string, Adapter> adapters_;  // by robot
  Sessions sessions_;
  uint64_t serials_ = 0;  // of calls
  bool closing_ = false;

  absl::Mutex calls_mutex_;
  int calls_ ABSL_GUARDED_BY(calls_mutex_) = 0;  // that gRPC has not let go of
  bool closed_ ABSL_GUARDED_BY(calls_mutex_) = false;
  EventLoop loop_;  // last: its thread ends before what it uses
};

RobotProxies::RobotProxies(std::function<void(WriteBatch)> report, const ProxySettings& settings,
                           const Clock* clock)
    : impl_(std::make_unique<Impl>(std::move(report), settings, clock)) {}
RobotProxies::~RobotProxies() = default;

void RobotProxies::SetAdapter(const RobotId& robot, const std::string& address,
                              const std::string& incarnation) {
  impl_->SetAdapter(robot, address, incarnation);
}
void RobotProxies::NeverSend(const RobotCommand& command) {
  impl_->NeverSend(command);
}
void RobotProxies::Send(const RobotCommand& command) {
  impl_->Begin(command, false, CommandWish::kDone);
}
void RobotProxies::Resume(const RobotCommand& command, CommandWish wish) {
  impl_->Begin(command, true, wish);
}
void RobotProxies::Cancel(const CommandId& command) {
  impl_->Change(command, CommandWish::kEnd);
}
void RobotProxies::Recall(const CommandId& command) {
  impl_->Change(command, CommandWish::kNotBegin);
}
uint64_t RobotProxies::refused_feedback() const {
  return impl_->refused();
}
size_t RobotProxies::open() const {
  return impl_->open();
}

}  // namespace docent::proxy
