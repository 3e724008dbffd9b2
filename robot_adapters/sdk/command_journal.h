// The adapter's memory of commands, on disk: which were begun and how they ended. Because a command is
// recorded (and synchronised to the disk) before its operation begins, no restart can make the adapter do one
// twice.
//
// A text file, one event a line, fields separated by tabs (\t, \n, \r and \ in a field are written \t \n \r
// \\):
//   started   TIME  INCARNATION
//   begun     TIME  INCARNATION  COMMAND  OPERATION
//   finished  TIME  INCARNATION  COMMAND  succeeded|failed|cancelled  MESSAGE  { NAME KIND LEXICAL DATATYPE
//   LANGUAGE } lost      TIME  INCARNATION  COMMAND      begun by an earlier incarnation that ended before it
//   was finished
// TIME is UTC in microseconds since 1970. A last line without its end is what a crash left of a write; it is
// cut off.
//
// Thread-safe.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_COMMAND_JOURNAL_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_COMMAND_JOURNAL_H_

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "robot_adapters/sdk/operation.h"

namespace docent::robot {

enum class CommandOutcome { kSucceeded, kFailed, kCancelled };

// What is remembered of one command.
struct JournalEntry {
  enum class State { kBegun, kFinished, kLost };
  State state = State::kBegun;
  std::string incarnation;  // that began it
  std::string operation;
  CommandOutcome outcome = CommandOutcome::kFailed;  // kFinished only, as are the rest
  std::string message;
  NamedTerms results;
};

class CommandJournal {
 public:
  // Finished and lost commands beyond this number are forgotten, oldest first.
  static constexpr size_t kCommandsRemembered = 100000;

  // Opens or creates the journal and begins a new incarnation: commands that earlier ones left unfinished
  // become lost. An empty path keeps the journal in memory only. `clock` must outlive it. DATA_LOSS names
  // file and line where a line is not understood; other errors are the system's.
  static absl::StatusOr<std::unique_ptr<CommandJournal>> Open(
      const std::string& path, const Clock* clock, size_t commands_remembered = kCommandsRemembered);
  ~CommandJournal();
  CommandJournal(const CommandJournal&) = delete;
  CommandJournal& operator=(const CommandJournal&) = delete;

  // "N-RANDOM": N counts the incarnations of a durable journal, so that people can tell which came first.
  const std::string& incarnation() const { return incarnation_; }

  std::optional<JournalEntry> Find(const CommandId& command) const;

  // Durable when they return OK; on an error nothing counts as recorded. `Begin` of a known command is
  // ALREADY_EXISTS; `Finish` of one that is not begun, FAILED_PRECONDITION.
  absl::Status Begin(const CommandId& command, const std::string& operation);
  absl::Status Finish(const CommandId& command, CommandOutcome outcome, const std::string& message,
                      const NamedTerms& results);

 private:
  CommandJournal(const Clock* clock, size_t commands_remembered);
  absl::Status Load(const std::string& path);
  absl::Status Apply(const std::vector<std::string>& fields);
  absl::Status Rewrite(const std::string& path);
  absl::Status Append(const std::vector<std::string>& fields) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Retire(const std::string& command) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const Clock* const clock_;
  const size_t commands_remembered_;
  std::string incarnation_;
  int incarnations_ = 0;
  mutable absl::Mutex mutex_;
  int file_ ABSL_GUARDED_BY(mutex_) = -1;  // -1: in memory only
  absl::flat_hash_map<std::string, JournalEntry> entries_ ABSL_GUARDED_BY(mutex_);
  std::deque<std::string> order_ ABSL_GUARDED_BY(mutex_);    // of beginning
  std::deque<std::string> retired_ ABSL_GUARDED_BY(mutex_);  // finished or lost, oldest first
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_COMMAND_JOURNAL_H_
