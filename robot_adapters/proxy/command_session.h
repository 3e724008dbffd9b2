// One command under way: the state machine of robot_proxies.h for a single id. Lives on the proxies' thread,
// is driven by it, and does at most one call at a time.
#ifndef DOCENT_ROBOT_ADAPTERS_PROXY_COMMAND_SESSION_H_
#define DOCENT_ROBOT_ADAPTERS_PROXY_COMMAND_SESSION_H_

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "absl/time/time.h"
#include "robot_adapters/proxy/command_report.h"
#include "robot_adapters/proxy/feedback_call.h"
#include "robot_adapters/proxy/robot_proxies.h"

namespace docent::proxy {

// What a session needs of the proxies. All on the proxies' thread.
class SessionHost {
 public:
  virtual ~SessionHost() = default;
  virtual void Report(CommandReport report) = 0;
  // Feedback about `command` was refused; the session reports it itself, where it is the first.
  virtual void Refused(const RobotCommand& command, const std::string& why) = 0;
  // Whether there is a connection to the adapter now, over which a call goes out.
  virtual bool IsConnected(const std::string& address) = 0;
  // Asks the adapter what it is, which connects to it; what comes of it comes back through OnProbed with `attempt`.
  virtual void Probe(const CommandId& command, const std::string& address, uint64_t attempt) = 0;
  // The adapter did not end the command in time; its end is waited for.
  virtual void Overdue(const RobotCommand& command, const std::string& why) = 0;
  // Begins a call to the robot's adapter; its feedback and end come back through OnFeedback and OnCallEnded.
  virtual std::shared_ptr<FeedbackCall> Call(const CommandId& command, const std::string& address,
                                             FeedbackCall::Request request, absl::Duration timeout) = 0;
  // Tells the adapter to end the command; its answer comes back through OnCancelAnswered with `attempt`.
  virtual void SendCancel(const CommandId& command, const std::string& address, uint64_t attempt) = 0;
  virtual void After(absl::Duration delay, const CommandId& command, std::function<void()> task) = 0;
  virtual absl::Time SteadyNow() const = 0;
};

class CommandSession {
 public:
  // `time_left` until the command's deadline. `may_have_been_sent`: see RobotProxies::Resume.
  CommandSession(SessionHost* host, const ProxySettings& settings, RobotCommand command,
                 absl::Duration time_left, bool may_have_been_sent);

  // Where the robot's adapter is as of now, and which incarnation serves there; empty: not known. The first call starts the
  // session.
  void UseAdapter(const std::string& address, const std::string& incarnation);
  // See RobotProxies.
  void Cancel();
  void Recall();
  // `known`: the adapter has the command, or does not begin it when it comes.
  void OnCancelAnswered(uint64_t attempt, bool known);
  // `call` is the call's serial.
  void OnFeedback(uint64_t call, const v1::Feedback& feedback);
  void OnCallEnded(uint64_t call, const grpc::Status& status);
  // `incarnation`: that the adapter names, if it answered.
  void OnProbed(uint64_t attempt, const grpc::Status& status, const std::string& incarnation);
  // Lets go of the call without a report.
  void Abandon();

  bool done() const { return done_; }
  const RobotId& robot() const { return command_.robot; }

 private:
  bool IsPresentCall(uint64_t call) const { return !done_ && call_ != nullptr && call_->serial() == call; }
  void Try();
  void Invoke();
  void Call(FeedbackCall::Request request);
  void Retry();
  void AwaitDeadline();
  void OnDeadline();
  absl::Duration TimeLeft() const;
  // Asks the adapter to end the command, and asks again until it says that it has the command.
  void AskToEnd();
  void SendCancel();
  // Whether another incarnation is there than the one that has the command.
  bool IsReplaced() const;
  void Lost(const std::string& why);
  // Why this feedback cannot be about the command; empty: it can.
  std::string Fault(const v1::Feedback& feedback) const;
  // Counted and logged; the first one goes into the run's facts and events.
  void Refuse(const std::string& why);
  // It is cancelled, called back or overdue: it is not invoked any more.
  bool MustNotBegin() const;
  // Whether an adapter that does not know it may have read it, and begin it yet.
  bool MayBegin();
  void OnNotKnown();
  void OnTold(const grpc::Status& status, const std::string& incarnation);
  void FinishNotBegun();
  std::string OverdueText() const;
  void Finish(CommandReport::Outcome outcome, std::string message);
  CommandReport NewReport(CommandReport::Outcome outcome, std::string message) const;

  SessionHost* const host_;
  const ProxySettings settings_;
  const RobotCommand command_;
  const absl::Time deadline_;
  std::string address_;
  std::string incarnation_;  // that has joined at the address
  std::string expected_incarnation_;
  std::shared_ptr<FeedbackCall> call_;  // nullptr: waiting for the next attempt
  bool started_ = false;
  bool done_ = false;
  bool attach_next_;   // the adapter may have the command already
  bool seen_ = false;  // the adapter has told its state
  bool begun_;  // an adapter may have begun it before, and have forgotten; always where attach_next_ is
  bool asks_life_ = false;    // the probe under way is to tell which incarnation does not know the command
  bool accepted_ = false;     // reported
  bool unreachable_ = false;  // reported, and not seen since
  bool refused_ = false;      // reported that feedback was refused
  bool taken_ = false;        // the present call has told its state
  bool running_ = false;      // the present call has said that it runs
  std::string answers_as_;    // the incarnation that the present call names; empty: none yet
  bool cancel_requested_ = false;
  bool recalled_ = false;
  bool invoked_ = false;        // here, not by a process before this one
  bool asks_to_end_ = false;    // a Cancel is sent with each call
  bool end_known_ = false;      // the adapter has heard the newest one
  bool end_was_known_ = false;  // before the present call began
  std::optional<absl::Time> may_begin_until_;
  uint64_t cancel_attempt_ = 0;
  absl::Duration cancel_pause_;
  bool retry_at_once_ = false;  // when the present call has ended
  uint64_t attempt_ = 0;
  absl::Duration pause_;
  absl::Time last_progress_ = absl::InfinitePast();
  v1::Feedback::State last_state_ = v1::Feedback::STATE_UNSPECIFIED;
  double last_told_ = 0;  // progress
  std::string last_error_;
  // Another incarnation than the one that it was meant for has begun it: why its outcome is unknown, whatever it says.
  std::string unknown_because_;
};

}  // namespace docent::proxy

#endif  // DOCENT_ROBOT_ADAPTERS_PROXY_COMMAND_SESSION_H_
