#include "robot_adapters/sdk/command_table.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "graph/rdf/docent_iris.h"
#include "graph/wire/term_proto.h"

namespace docent::robot {
namespace {

constexpr size_t kEarlyCancels = 1000;  // that are remembered

v1::Feedback::State StateOf(CommandOutcome outcome) {
  switch (outcome) {
    case CommandOutcome::kSucceeded:
      return v1::Feedback::SUCCEEDED;
    case CommandOutcome::kFailed:
      return v1::Feedback::FAILED;
    case CommandOutcome::kCancelled:
      return v1::Feedback::CANCELLED;
  }
  return v1::Feedback::FAILED;
}

void SetResults(const NamedTerms& results, v1::Feedback* feedback) {
  for (const auto& [name, value] : results) {
    v1::NamedTerm* out = feedback->add_results();
    out->set_name(name);
    ToProto(value, out->mutable_value());
  }
}

absl::Status OutcomeUnknown(const CommandId& command, const std::string& why) {
  return absl::FailedPreconditionError(
      absl::StrCat("the outcome of command ", command.value(), " is not known: ", why));
}

// A robot maker's function may throw; the adapter lives on.
absl::StatusOr<NamedTerms> RunGuarded(const Operation& operation, OperationContext& context) {
  try {
    return operation.run(context);
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("operation ", operation.name, " threw: ", error.what()));
  } catch (...) {
    return absl::InternalError(absl::StrCat("operation ", operation.name, " threw something"));
  }
}

}  // namespace

void RunningCommand::Watch(FeedbackWatcher* watcher) {
  absl::MutexLock lock(&mutex_);
  watchers_.push_back(watcher);
  if (feedback_.state() != v1::Feedback::STATE_UNSPECIFIED) watcher->OnFeedback(feedback_);
}

void RunningCommand::Unwatch(FeedbackWatcher* watcher) {
  absl::MutexLock lock(&mutex_);
  std::erase(watchers_, watcher);
}

void RunningCommand::Publish(const v1::Feedback& feedback) {
  feedback_ = feedback;
  for (FeedbackWatcher* watcher : watchers_) watcher->OnFeedback(feedback_);
}

// What an operation sees of its command; lives on the command's thread.
class CommandRunner final : public OperationContext {
 public:
  CommandRunner(const v1::InvokeRequest& request, const Clock* clock, std::shared_ptr<RunningCommand> command)
      : id_(request.command_id()),
        deadline_us_(request.time_left_us() != 0 ? clock->Now() + request.time_left_us()
                                                 : request.deadline_us()),
        clock_(clock),
        command_(std::move(command)) {
    for (const v1::NamedTerm& argument : request.arguments()) {
      if (auto term = FromProto(argument.value())) arguments_.emplace_back(argument.name(), *std::move(term));
    }
  }

  const CommandId& command() const override { return id_; }
  const NamedTerms& arguments() const override { return arguments_; }
  TimeMicros deadline_us() const override { return deadline_us_; }

  bool StopRequested() override {
    absl::MutexLock lock(&command_->mutex_);
    return MustStop();
  }

  bool SleepFor(std::chrono::microseconds duration) override {
    absl::Duration wait = absl::FromChrono(duration);
    if (deadline_us_ != 0) wait = std::min(wait, absl::Microseconds(deadline_us_ - clock_->Now()));
    absl::MutexLock lock(&command_->mutex_);
    command_->mutex_.AwaitWithTimeout(absl::Condition(this, &CommandRunner::Interrupted), wait);
    return !MustStop();
  }

  void ReportProgress(double fraction, std::string_view message) override {
    absl::MutexLock lock(&command_->mutex_);
    v1::Feedback feedback = command_->feedback_;
    feedback.set_state(v1::Feedback::RUNNING);
    // What is no number tells nothing: the command goes on.
    feedback.set_progress(std::isnan(fraction) ? 0.0 : std::clamp(fraction, 0.0, 1.0));
    feedback.set_message(std::string(message));
    command_->Publish(feedback);
  }

  // How it ended, given what the operation returned.
  CommandOutcome Judge(const absl::StatusOr<NamedTerms>& result, std::string* message) {
    absl::MutexLock lock(&command_->mutex_);
    if (result.ok()) return CommandOutcome::kSucceeded;
    *message = std::string(result.status().message());
    if (command_->cancel_requested_) return CommandOutcome::kCancelled;
    if (command_->shutting_down_) {
      *message = "the robot's adapter was shut down";
    } else if (PastDeadline()) {
      *message = absl::StrCat("gave up at the command's deadline", message->empty() ? "" : ": ", *message);
    }
    return CommandOutcome::kFailed;
  }

 private:
  bool Interrupted() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(command_->mutex_) {
    return command_->cancel_requested_ || command_->shutting_down_;
  }
  bool PastDeadline() const { return deadline_us_ != 0 && clock_->Now() >= deadline_us_; }
  bool MustStop() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(command_->mutex_) {
    return Interrupted() || PastDeadline();
  }

  const CommandId id_;
  const TimeMicros deadline_us_;
  const Clock* const clock_;
  const std::shared_ptr<RunningCommand> command_;
  NamedTerms arguments_;
};

CommandTable::CommandTable(std::vector<Operation> operations, CommandJournal* journal, const Clock* clock,
                           size_t running_limit, FeedbackWatcher* observer)
    : operations_(std::move(operations)),
      journal_(journal),
      clock_(clock),
      running_limit_(running_limit),
      observer_(observer) {
  // All that was made before is visible to whoever calls Begin: the thread sanitizer does not see how gRPC starts its threads.
  absl::MutexLock lock(&mutex_);
}

absl::StatusOr<std::unique_ptr<CommandTable>> CommandTable::Create(std::vector<Operation> operations,
                                                                   CommandJournal* journal,
                                                                   const Clock* clock, size_t running_limit,
                                                                   FeedbackWatcher* observer) {
  std::set<std::string> names;
  for (const Operation& operation : operations) {
    if (operation.name.empty() || !operation.run) {
      return absl::InvalidArgumentError(
          absl::StrCat("operation \"", operation.name, "\" lacks a name or function"));
    }
    if (const std::optional<std::string> fault = NameFault(operation.name)) {
      return absl::InvalidArgumentError(
          absl::StrCat("the name of operation \"", operation.name, "\" ", *fault));
    }
    if (!names.insert(operation.name).second) {
      return absl::InvalidArgumentError(
          absl::StrCat("operation \"", operation.name, "\" is registered twice"));
    }
  }
  return std::unique_ptr<CommandTable>(
      new CommandTable(std::move(operations), journal, clock, running_limit, observer));
}

CommandTable::~CommandTable() {
  Stop();
  absl::ReleasableMutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(
      +[](CommandTable* table) { return table->live_.empty(); }, this));
  lock.Release();
  JoinEnded();
}

absl::StatusOr<std::shared_ptr<RunningCommand>> CommandTable::Begin(const v1::InvokeRequest& request) {
  const CommandId id(request.command_id());
  if (id.empty()) return absl::InvalidArgumentError("command_id is empty");
  JoinEnded();
  absl::MutexLock lock(&mutex_);
  auto known = FindLocked(id);
  if (!absl::IsNotFound(known.status())) return known;
  if (IsCancelledEarly(id)) return CancelledEarly(id);

  if (!request.expected_incarnation().empty() && request.expected_incarnation() != incarnation()) {
    return OutcomeUnknown(id, absl::StrCat("it was meant for incarnation ", request.expected_incarnation(),
                                           " of this adapter, which is now ", incarnation()));
  }
  auto operation = std::find_if(operations_.begin(), operations_.end(),
                                [&](const Operation& o) { return o.name == request.operation(); });
  if (operation == operations_.end()) {
    return absl::NotFoundError(absl::StrCat(
        "this robot has no operation \"", request.operation(), "\"; it has ",
        absl::StrJoin(operations_, ", ",
                      [](std::string* out, const Operation& o) { absl::StrAppend(out, o.name); })));
  }
  for (const std::string& input : operation->inputs) {
    bool given =
        std::any_of(request.arguments().begin(), request.arguments().end(), [&](const v1::NamedTerm& a) {
          return a.name() == input && a.value().kind_case() != v1::Term::KIND_NOT_SET;
        });
    if (!given) {
      return absl::InvalidArgumentError(
          absl::StrCat("operation ", operation->name, " needs the argument \"", input, "\""));
    }
  }
  if (stopped_) return absl::UnavailableError("the adapter is shutting down");
  if (live_.size() >= running_limit_) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the robot already runs commands_running = ", running_limit_, " commands"));
  }
  auto command = std::make_shared<RunningCommand>(v1::Feedback());  // Run tells the first
  if (observer_ != nullptr) command->Watch(observer_);
  Live& live = live_[id.value()];
  live.command = command;
  live.thread = std::thread([this, operation, request, command] { Run(*operation, request, command); });
  return command;
}

void CommandTable::Run(const Operation& operation, const v1::InvokeRequest& request,
                       std::shared_ptr<RunningCommand> command) {
  const CommandId id(request.command_id());
  v1::Feedback feedback;
  feedback.set_command_id(id.value());
  feedback.set_incarnation(incarnation());
  CommandOutcome outcome = CommandOutcome::kFailed;
  std::string message;
  NamedTerms results;
  if (absl::Status begun = journal_->Begin(id, operation.name); !begun.ok()) {
    message = absl::StrCat("not begun: ", begun.message());
  } else {
    {
      absl::MutexLock lock(&command->mutex_);
      feedback.set_state(v1::Feedback::ACCEPTED);
      command->Publish(feedback);
    }
    CommandRunner runner(request, clock_, command);
    // What was cancelled, or whose time was over, before it began does not begin: it may be one that cannot be stopped.
    absl::StatusOr<NamedTerms> result =
        runner.StopRequested() ? absl::CancelledError("it was not begun") : RunGuarded(operation, runner);
    outcome = runner.Judge(result, &message);
    if (result.ok()) results = *std::move(result);
    if (absl::Status finished = journal_->Finish(id, outcome, message, results); !finished.ok()) {
      absl::StrAppend(&message, message.empty() ? "" : "; ", finished.message());
    }
  }
  feedback.set_state(StateOf(outcome));
  feedback.set_message(message);
  feedback.set_progress(outcome == CommandOutcome::kSucceeded ? 1.0 : 0.0);
  SetResults(results, &feedback);
  {
    absl::MutexLock lock(&command->mutex_);
    command->Publish(feedback);
  }
  Ended(id.value());
}

void CommandTable::Ended(const std::string& command) {
  absl::MutexLock lock(&mutex_);
  auto live = live_.find(command);
  ended_.push_back(std::move(live->second.thread));
  live_.erase(live);
}

void CommandTable::JoinEnded() {
  std::vector<std::thread> ended;
  {
    absl::MutexLock lock(&mutex_);
    ended.swap(ended_);
  }
  for (std::thread& thread : ended) thread.join();
}

absl::StatusOr<std::shared_ptr<RunningCommand>> CommandTable::Find(const CommandId& command) {
  absl::MutexLock lock(&mutex_);
  return FindLocked(command);
}

absl::StatusOr<std::shared_ptr<RunningCommand>> CommandTable::FindLocked(const CommandId& command) {
  if (auto live = live_.find(command.value()); live != live_.end()) return live->second.command;
  std::optional<JournalEntry> entry = journal_->Find(command);
  if (!entry) {
    return absl::NotFoundError(absl::StrCat("command ", command.value(), " was never begun by this adapter"));
  }
  if (entry->state != JournalEntry::State::kFinished) {
    return OutcomeUnknown(command, absl::StrCat("incarnation ", entry->incarnation,
                                                " of this adapter ended before the command did"));
  }
  v1::Feedback feedback;
  feedback.set_command_id(command.value());
  feedback.set_state(StateOf(entry->outcome));
  feedback.set_message(entry->message);
  feedback.set_progress(entry->outcome == CommandOutcome::kSucceeded ? 1.0 : 0.0);
  feedback.set_incarnation(incarnation());
  SetResults(entry->results, &feedback);
  return std::make_shared<RunningCommand>(std::move(feedback));
}

bool CommandTable::IsCancelledEarly(const CommandId& command) const {
  return std::find(cancelled_early_.begin(), cancelled_early_.end(), command.value()) !=
         cancelled_early_.end();
}

std::shared_ptr<RunningCommand> CommandTable::CancelledEarly(const CommandId& command) const {
  v1::Feedback feedback;
  feedback.set_command_id(command.value());
  feedback.set_state(v1::Feedback::CANCELLED);
  feedback.set_message("cancelled before it came");
  feedback.set_incarnation(incarnation());
  return std::make_shared<RunningCommand>(std::move(feedback));
}

void CommandTable::Cancel(const CommandId& command) {
  absl::MutexLock lock(&mutex_);
  if (auto live = live_.find(command.value()); live != live_.end()) {
    absl::MutexLock command_lock(&live->second.command->mutex_);
    live->second.command->cancel_requested_ = true;
    return;
  }
  if (journal_->Find(command) || IsCancelledEarly(command)) return;
  cancelled_early_.push_back(command.value());
  if (cancelled_early_.size() > kEarlyCancels) cancelled_early_.pop_front();
}

void CommandTable::Stop() {
  absl::MutexLock lock(&mutex_);
  stopped_ = true;
  for (auto& [id, live] : live_) {
    absl::MutexLock command_lock(&live.command->mutex_);
    live.command->shutting_down_ = true;
  }
}

}  // namespace docent::robot
