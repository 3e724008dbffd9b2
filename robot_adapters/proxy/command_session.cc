#include "robot_adapters/proxy/command_session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/cut_text.h"
#include "graph/base/text_limits.h"

namespace docent::proxy {
namespace {

constexpr absl::Duration kCallBeyondDeadline = absl::Minutes(1);
constexpr size_t kShown = 200;  // bytes of a name that an adapter gave

// Codes that gRPC itself gives when a connection fails, or an adapter that is shutting down: nothing is
// known.
bool IsConnectionLoss(grpc::StatusCode code) {
  switch (code) {
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::CANCELLED:
    case grpc::StatusCode::UNKNOWN:
    case grpc::StatusCode::INTERNAL:
    case grpc::StatusCode::DEADLINE_EXCEEDED:
    case grpc::StatusCode::ABORTED:
      return true;
    default:
      return false;
  }
}

}  // namespace

CommandSession::CommandSession(SessionHost* host, const ProxySettings& settings, RobotCommand command,
                               absl::Duration time_left, bool may_have_been_sent)
    : host_(host),
      settings_(settings),
      command_(std::move(command)),
      deadline_(host->SteadyNow() + time_left + absl::FromChrono(settings.grace)),
      expected_incarnation_(command_.expected_incarnation),
      attach_next_(may_have_been_sent),
      begun_(may_have_been_sent),
      pause_(absl::FromChrono(settings.first_retry)) {}

void CommandSession::UseAdapter(const std::string& address, const std::string& incarnation) {
  const bool moved = address != address_;
  address_ = address;
  incarnation_ = incarnation;
  if (!started_) {
    started_ = true;
    AwaitDeadline();
    Try();
  } else if (call_ == nullptr) {
    Try();
  } else if (moved || IsReplaced()) {
    retry_at_once_ = true;
    call_->Cancel();
  }
}

bool CommandSession::IsReplaced() const {
  const std::string& has_it = answers_as_.empty() ? expected_incarnation_ : answers_as_;
  return !incarnation_.empty() && !has_it.empty() && incarnation_ != has_it;
}

void CommandSession::Try() {
  if (done_ || call_ != nullptr) return;
  ++attempt_;
  asks_life_ = false;
  if (MustNotBegin()) {
    if (!begun_) return FinishNotBegun();
    attach_next_ = true;
  }
  if (!begun_ && IsReplaced()) {
    return Finish(CommandReport::Outcome::kNotBegun,
                  absl::StrCat("incarnation ", expected_incarnation_, " of the adapter was replaced by ",
                               incarnation_, " before it was sent"));
  }
  if (address_.empty()) {
    Lost(absl::StrCat("robot ", command_.robot.value(), " has no adapter now"));
    return;
  }
  running_ = taken_ = false;
  answers_as_.clear();
  if (attach_next_) {
    v1::AttachRequest attach;
    attach.set_command_id(command_.id.value());
    Call(std::move(attach));
  } else if (host_->IsConnected(address_)) {
    Invoke();
  } else {
    // What is sent without a connection arrives or not. A question does no harm, and leaves a connection.
    host_->Probe(command_.id, address_, attempt_);
  }
}

void CommandSession::OnProbed(uint64_t attempt, const grpc::Status& status, const std::string& incarnation) {
  if (done_ || attempt != attempt_) return;
  if (asks_life_) return OnTold(status, incarnation);
  if (MustNotBegin()) return Try();
  if (host_->IsConnected(address_)) return Invoke();  // whatever it answered
  Lost(absl::StrCat("adapter at ", address_, " cannot be reached: ", status.error_message()));
}

void CommandSession::Invoke() {
  v1::InvokeRequest invoke = InvokeRequestOf(command_, expected_incarnation_);
  invoke.set_time_left_us(std::max<int64_t>(1, absl::ToInt64Microseconds(TimeLeft())));
  attach_next_ = begun_ = invoked_ = true;  // from here on the adapter may have it
  Call(std::move(invoke));
}

// Beyond the deadline, too: what became of the command is asked until the adapter says it.
void CommandSession::Call(FeedbackCall::Request request) {
  end_was_known_ = end_known_;
  call_ = host_->Call(command_.id, address_, std::move(request),
                      std::max(TimeLeft(), absl::ZeroDuration()) + kCallBeyondDeadline);
  if (asks_to_end_) AskToEnd();
}

absl::Duration CommandSession::TimeLeft() const {
  return deadline_ - absl::FromChrono(settings_.grace) - host_->SteadyNow();
}

// Reports the loss once, then tries again after a pause that grows.
void CommandSession::Lost(const std::string& why) {
  last_error_ = why;
  if (!unreachable_) {
    unreachable_ = true;
    host_->Report(NewReport(CommandReport::Outcome::kUnreachable, why));
  }
  Retry();
}

void CommandSession::Retry() {
  absl::Duration pause = std::exchange(retry_at_once_, false) ? absl::ZeroDuration() : pause_;
  pause_ = std::min(2 * pause_, absl::FromChrono(settings_.last_retry));
  host_->After(pause, command_.id, [this, attempt = attempt_] {
    if (attempt == attempt_) Try();
  });
}

std::string CommandSession::Fault(const v1::Feedback& feedback) const {
  if (!feedback.command_id().empty() && feedback.command_id() != command_.id.value())
    return absl::StrCat("it is about command ", CutText(feedback.command_id(), kShown));
  if (feedback.state() < v1::Feedback::ACCEPTED || feedback.state() > v1::Feedback::CANCELLED)
    return absl::StrCat("its state ", static_cast<int>(feedback.state()), " is not known");
  if (!answers_as_.empty() && !feedback.incarnation().empty() && feedback.incarnation() != answers_as_)
    return absl::StrCat("it is of incarnation ", CutText(feedback.incarnation(), kShown),
                        ", and what came before of ", answers_as_);
  if (feedback.state() == v1::Feedback::ACCEPTED && running_) return "it says ACCEPTED after RUNNING";
  if (feedback.state() == v1::Feedback::RUNNING && !std::isfinite(feedback.progress()))
    return absl::StrCat("its progress is ", feedback.progress(), ", which is not a finite number");
  return "";
}

void CommandSession::Refuse(const std::string& why) {
  host_->Refused(command_, why);
  if (std::exchange(refused_, true)) return;
  host_->Report(NewReport(CommandReport::Outcome::kRefused,
                          absl::StrCat("feedback of the adapter at ", address_, " is refused: ", why)));
}

void CommandSession::OnFeedback(uint64_t call, const v1::Feedback& feedback) {
  if (!IsPresentCall(call)) return;
  if (const std::string fault = Fault(feedback); !fault.empty()) return Refuse(fault);
  // It lay unread while it was cancelled or called back, or its time went by.
  const bool has_begun_late = !call_->is_attach() && !taken_ && asks_to_end_ && !end_known_;
  // An adapter that remembers a command of an earlier incarnation may tell how it ended; one that is given a command that
  // was meant for another incarnation may have done it before.
  if (!call_->is_attach() && !expected_incarnation_.empty() && !feedback.incarnation().empty() &&
      feedback.incarnation() != expected_incarnation_) {
    unknown_because_ = absl::StrCat("the command was meant for incarnation ", expected_incarnation_,
                                    " of the adapter, and ", feedback.incarnation(), " answers");
    host_->Refused(command_, unknown_because_);
    if (!IsFinal(feedback.state()) && !asks_to_end_) AskToEnd();
  }
  answers_as_ = feedback.incarnation();
  running_ = running_ || feedback.state() == v1::Feedback::RUNNING;
  seen_ = taken_ = true;
  unreachable_ = false;
  if (feedback.state() != last_state_ || feedback.progress() != last_told_) {
    pause_ = absl::FromChrono(settings_.first_retry);
  }
  last_state_ = feedback.state();
  last_told_ = feedback.progress();
  if (!feedback.incarnation().empty()) expected_incarnation_ = feedback.incarnation();
  std::string left_out;
  CommandReport report = ReportOf(command_.id, feedback, &left_out);
  if (!left_out.empty()) Refuse(left_out);
  if (IsFinal(feedback.state())) {
    if (!unknown_because_.empty()) return Finish(CommandReport::Outcome::kUnknown, unknown_because_);
    done_ = true;
    host_->Report(std::move(report));
    return;
  }
  if (has_begun_late) AskToEnd();
  if (!accepted_) {
    accepted_ = true;
    CommandReport accepted = NewReport(CommandReport::Outcome::kAccepted, "");
    accepted.incarnation = feedback.incarnation();
    host_->Report(std::move(accepted));
  }
  if (report.outcome != CommandReport::Outcome::kProgress) return;
  const absl::Time now = host_->SteadyNow();
  if (now - last_progress_ < absl::FromChrono(settings_.progress_interval)) return;
  last_progress_ = now;
  host_->Report(std::move(report));
}

void CommandSession::OnCallEnded(uint64_t call, const grpc::Status& status) {
  if (!IsPresentCall(call)) return;
  const bool was_attach = call_->is_attach();
  const grpc::StatusCode code = status.error_code();
  call_.reset();
  if (retry_at_once_) {
    Retry();
  } else if (status.ok()) {  // a stream without a final state: the adapter let go of it
    Lost(absl::StrCat("adapter at ", address_, " ended the feedback of a command that has not ended"));
  } else if (taken_) {  // whatever ends the stream of a command that the adapter has: it may be under way
    Lost(absl::StrCat("adapter at ", address_,
                      " broke off the feedback of a command that has not ended: ", status.error_message()));
  } else if (code == grpc::StatusCode::NOT_FOUND && was_attach) {
    OnNotKnown();
  } else if (code == grpc::StatusCode::FAILED_PRECONDITION) {
    Finish(CommandReport::Outcome::kUnknown, status.error_message());
  } else if (code == grpc::StatusCode::UNIMPLEMENTED && was_attach) {
    Finish(CommandReport::Outcome::kUnknown,
           absl::StrCat("adapter at ", address_, " cannot tell what became of it: it has no Attach"));
  } else if (was_attach || IsConnectionLoss(code)) {
    Lost(absl::StrCat("adapter at ", address_, " cannot be reached: ", status.error_message()));
  } else {
    Finish(CommandReport::Outcome::kFailed, absl::StrCat("adapter at ", address_, " refused ",
                                                         command_.operation, ": ", status.error_message()));
  }
}

bool CommandSession::MustNotBegin() const {
  return cancel_requested_ || recalled_ || asks_to_end_ || TimeLeft() <= absl::ZeroDuration();
}

bool CommandSession::MayBegin() {
  if (end_was_known_ || TimeLeft() <= absl::ZeroDuration()) return false;
  if (!may_begin_until_) may_begin_until_ = host_->SteadyNow() + absl::FromChrono(settings_.may_begin);
  return host_->SteadyNow() < *may_begin_until_;
}

// The adapter that answered an Attach does not know the id. It compares the incarnation that Invoke carries with its own, so that
// a forgetful one cannot do the command a second time. Of what is not invoked again, the adapter is asked which incarnation it is:
// one that may have forgotten the command may have begun it.
void CommandSession::OnNotKnown() {
  const bool must_not = MustNotBegin();
  if (seen_ && must_not) {
    Finish(CommandReport::Outcome::kUnknown,
           absl::StrCat("adapter at ", address_, " does not know the command any more, which it had begun"));
  } else if (expected_incarnation_.empty() && (must_not || !command_.idempotent)) {
    Finish(CommandReport::Outcome::kUnknown,
           absl::StrCat("adapter at ", address_, " does not know the command, and may have forgotten it"));
  } else if (IsReplaced()) {
    Finish(CommandReport::Outcome::kUnknown,
           absl::StrCat("the command was begun by incarnation ", expected_incarnation_,
                        " of the adapter, and incarnation ", incarnation_, " does not know it"));
  } else if (must_not) {
    asks_life_ = true;
    host_->Probe(command_.id, address_, ++attempt_);
  } else {
    attach_next_ = false;
    Try();
  }
}

void CommandSession::OnTold(const grpc::Status& status, const std::string& incarnation) {
  if (!status.ok() && IsConnectionLoss(status.error_code())) {
    Lost(absl::StrCat("adapter at ", address_, " cannot be reached: ", status.error_message()));
  } else if (incarnation == expected_incarnation_) {
    if (!MayBegin()) return FinishNotBegun();
    if (!asks_to_end_) AskToEnd();
    Retry();
  } else {
    Finish(
        CommandReport::Outcome::kUnknown,
        absl::StrCat("the command was meant for incarnation ", expected_incarnation_, " of the adapter, and ",
                     incarnation.empty() ? "what is there now does not say which it is"
                                         : absl::StrCat("incarnation ", incarnation, " does not know it")));
  }
}

void CommandSession::FinishNotBegun() {
  if (!cancel_requested_ && !recalled_) return Finish(CommandReport::Outcome::kFailed, OverdueText());
  Finish(CommandReport::Outcome::kNotBegun,
         absl::StrCat(cancel_requested_ ? "cancelled" : "called back", " before the robot began it"));
}

void CommandSession::Cancel() {
  if (done_ || cancel_requested_) return;
  cancel_requested_ = true;
  begun_ ? AskToEnd() : FinishNotBegun();  // between two calls, too: it is a call of its own
}

void CommandSession::Recall() {
  if (done_ || recalled_) return;
  recalled_ = true;
  if (!begun_) return FinishNotBegun();
  // It may lie unread at the adapter. Whether one that begins now did so before is not known: it ends, and is sent again.
  if (invoked_ && !seen_ && !asks_to_end_) AskToEnd();
}

void CommandSession::AskToEnd() {
  asks_to_end_ = true;
  end_known_ = false;
  cancel_pause_ = absl::FromChrono(settings_.first_retry);
  SendCancel();
}

void CommandSession::SendCancel() {
  if (!done_ && !address_.empty()) host_->SendCancel(command_.id, address_, ++cancel_attempt_);
}

void CommandSession::OnCancelAnswered(uint64_t attempt, bool known) {
  if (done_ || attempt != cancel_attempt_) return;
  end_known_ = known;
  if (known) return;
  host_->After(cancel_pause_, command_.id, [this, attempt] {
    if (attempt == cancel_attempt_) SendCancel();
  });
  cancel_pause_ = std::min(2 * cancel_pause_, absl::FromChrono(settings_.last_retry));
}

// Its clock may stand still, where a simulator tells the time.
void CommandSession::AwaitDeadline() {
  const absl::Duration left = std::max(absl::ZeroDuration(), deadline_ - host_->SteadyNow());
  host_->After(left, command_.id,
               [this] { deadline_ > host_->SteadyNow() ? AwaitDeadline() : OnDeadline(); });
}

// The adapter gives up at the deadline by itself. One that does not is asked to; only what it says last is the end.
void CommandSession::OnDeadline() {
  if (done_) return;
  if (!begun_) return FinishNotBegun();
  AskToEnd();
  host_->Overdue(command_, OverdueText());
}

std::string CommandSession::OverdueText() const {
  return absl::StrCat(address_.empty() ? absl::StrCat("robot ", command_.robot.value(), " has no adapter and")
                                       : absl::StrCat("adapter at ", address_),
                      seen_ ? " did not finish " : " did not take ", command_.operation,
                      " before its deadline",
                      unreachable_ && !address_.empty() ? absl::StrCat("; last: ", last_error_) : "");
}

void CommandSession::Abandon() {
  done_ = true;
  if (call_ != nullptr) call_->Cancel();
}

void CommandSession::Finish(CommandReport::Outcome outcome, std::string message) {
  Abandon();
  host_->Report(NewReport(outcome, std::move(message)));
}

CommandReport CommandSession::NewReport(CommandReport::Outcome outcome, std::string message) const {
  CommandReport report;
  report.command = command_.id;
  report.outcome = outcome;
  report.message = CutText(message, kTextLimits.message_bytes);
  report.incarnation = expected_incarnation_;
  return report;
}

}  // namespace docent::proxy
