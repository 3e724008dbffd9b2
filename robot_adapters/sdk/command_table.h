// The commands of this adapter: begins each once, runs it on its own thread, and tells everybody who watches.
//
// Thread-safe. `RunningCommand` is shared between its thread, the table and the feedback streams that watch
// it.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_COMMAND_TABLE_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_COMMAND_TABLE_H_

#include <deque>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "docent/v1/robot_adapter.pb.h"
#include "robot_adapters/sdk/command_journal.h"
#include "robot_adapters/sdk/operation.h"

namespace docent::robot {

// Hears the feedback of a command. Called with the command's lock held: must not block nor call back.
class FeedbackWatcher {
 public:
  virtual ~FeedbackWatcher() = default;
  virtual void OnFeedback(const v1::Feedback& feedback) = 0;
};

// A command of this process, running or ended, or one that the journal knows to have ended.
class RunningCommand {
 public:
  explicit RunningCommand(v1::Feedback feedback) : feedback_(std::move(feedback)) {}

  // The watcher hears the present state at once (unless the command is not durable yet), then every change.
  void Watch(FeedbackWatcher* watcher);
  void Unwatch(FeedbackWatcher* watcher);

 private:
  friend class CommandTable;
  friend class CommandRunner;
  void Publish(const v1::Feedback& feedback) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  absl::Mutex mutex_;
  v1::Feedback feedback_
      ABSL_GUARDED_BY(mutex_);  // STATE_UNSPECIFIED: not yet in the journal, nobody may know
  std::vector<FeedbackWatcher*> watchers_ ABSL_GUARDED_BY(mutex_);
  bool cancel_requested_ ABSL_GUARDED_BY(mutex_) = false;
  bool shutting_down_ ABSL_GUARDED_BY(mutex_) = false;
};

class CommandTable {
 public:
  // `journal`, `clock` and `observer` must outlive the table; `observer` (or nullptr) hears the feedback of
  // every command. INVALID_ARGUMENT for two operations of one name.
  static absl::StatusOr<std::unique_ptr<CommandTable>> Create(std::vector<Operation> operations,
                                                              CommandJournal* journal, const Clock* clock,
                                                              size_t running_limit,
                                                              FeedbackWatcher* observer = nullptr);
  // Stops what runs and waits for it.
  ~CommandTable();

  // The command of this id; begun now if it is new. NOT_FOUND: no such operation. INVALID_ARGUMENT: an
  // argument is missing, or the id is empty. FAILED_PRECONDITION: the outcome is unknown, because it was
  // decided for, or begun by, an incarnation that is gone. RESOURCE_EXHAUSTED: too many run.
  absl::StatusOr<std::shared_ptr<RunningCommand>> Begin(const v1::InvokeRequest& request);
  // NOT_FOUND: never begun here. FAILED_PRECONDITION: begun by an incarnation that is gone; the outcome is
  // unknown.
  absl::StatusOr<std::shared_ptr<RunningCommand>> Find(const CommandId& command);
  // One that is not known here does not begin, where it comes later: it is told to be cancelled. Cancelling an ended command does
  // nothing.
  void Cancel(const CommandId& command);
  // Ends what runs, as failed; nothing begins any more.
  void Stop();

  const std::vector<Operation>& operations() const { return operations_; }
  const std::string& incarnation() const { return journal_->incarnation(); }

 private:
  CommandTable(std::vector<Operation> operations, CommandJournal* journal, const Clock* clock,
               size_t running_limit, FeedbackWatcher* observer);
  absl::StatusOr<std::shared_ptr<RunningCommand>> FindLocked(const CommandId& command)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool IsCancelledEarly(const CommandId& command) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::shared_ptr<RunningCommand> CancelledEarly(const CommandId& command) const;
  void Run(const Operation& operation, const v1::InvokeRequest& request,
           std::shared_ptr<RunningCommand> command);
  void Ended(const std::string& command);
  void JoinEnded();

  const std::vector<Operation> operations_;
  CommandJournal* const journal_;
  const Clock* const clock_;
  const size_t running_limit_;
  FeedbackWatcher* const observer_;

  struct Live {
    std::shared_ptr<RunningCommand> command;
    std::thread thread;
  };
  absl::Mutex mutex_;
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  absl::flat_hash_map<std::string, Live> live_ ABSL_GUARDED_BY(mutex_);
  std::vector<std::thread> ended_ ABSL_GUARDED_BY(mutex_);           // threads that only have to be joined
  std::deque<std::string> cancelled_early_ ABSL_GUARDED_BY(mutex_);  // before they came, the newest last
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_COMMAND_TABLE_H_
