// Upkeep of SqliteLog's files: trimming, and checkpoints of the write-ahead log into the
// database.
#include <pthread.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "graph/log/sqlite_log.h"

namespace docent::log {

absl::Status SqliteLog::Trim(uint64_t before) {
  if (before == 0) return absl::OkStatus();
  if (absl::Status there = CheckPlace(); !there.ok()) return there;
  {
    absl::MutexLock lock(&snapshot_mutex_);
    const absl::StatusOr<std::vector<uint64_t>> offsets = snapshots_.Offsets();
    if (!offsets.ok()) return offsets.status();
    if (offsets->empty() || offsets->back() < before - 1) {
      return absl::FailedPreconditionError(absl::StrCat("cannot drop the log records before ", before,
                                                        ": there is no snapshot at or after offset ",
                                                        before - 1));
    }
  }
  while (true) {
    const HeadRow head = CurrentHead();
    const uint64_t last = std::min(before - 1, head.base_offset + options_.trim_step);
    if (last <= head.base_offset) return absl::OkStatus();
    absl::StatusOr<Verified> dropped;
    {
      absl::MutexLock lock(&read_mutex_);
      dropped = At(last, head);
    }
    if (!dropped.ok()) return dropped.status();
    const absl::Status status = TrimStep(*dropped);
    if (!status.ok()) return status;
  }
}

absl::Status SqliteLog::TrimStep(const Verified& last_dropped) {
  absl::MutexLock lock(&append_mutex_);
  const HeadRow old_head = CurrentHead();
  if (last_dropped.offset <= old_head.base_offset) return absl::OkStatus();  // another thread was faster
  HeadRow new_head = old_head;
  new_head.base_offset = last_dropped.offset;
  new_head.base_hash = last_dropped.hash;
  absl::Status status = begin_.Run("cannot trim the log");
  if (!status.ok()) return status;
  status = delete_before_.Bind(1, last_dropped.offset).Run("cannot trim the log");
  if (status.ok()) status = StoreHead(old_head, new_head);
  status = Finish(std::move(status));
  if (status.ok()) Publish(new_head);
  return status;
}

absl::StatusOr<uint64_t> SqliteLog::Bytes() {
  absl::MutexLock lock(&read_mutex_);
  uint64_t numbers[3];
  const char* const questions[] = {"PRAGMA page_count", "PRAGMA freelist_count", "PRAGMA page_size"};
  for (int i = 0; i < 3; ++i) {
    absl::StatusOr<Statement> statement = Statement::Prepare(reader_.get(), questions[i]);
    if (!statement.ok()) return statement.status();
    const absl::StatusOr<bool> row = statement->Step("cannot read the log's size");
    if (!row.ok()) return row.status();
    numbers[i] = *row ? statement->Integer(0) : 0;
  }
  return (numbers[0] - std::min(numbers[0], numbers[1])) * numbers[2];
}

absl::Status SqliteLog::Probe() {
  if (absl::Status there = CheckPlace(); !there.ok()) return there;
  absl::MutexLock lock(&append_mutex_);
  const HeadRow head = CurrentHead();
  absl::Status status = begin_.Run("cannot append to the log");
  if (!status.ok()) return status;
  return Finish(StoreHead(head, head));
}

std::optional<uint64_t> SqliteLog::FreeBytes() {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder_.path(), error);
  if (error) return std::nullopt;
  return space.available;
}

void SqliteLog::StartCheckpoints() {
  {
    absl::MutexLock lock(&head_mutex_);
    next_checkpoint_pages_ = options_.checkpoint_pages;
    next_restart_pages_ = options_.restart_pages;
  }
  {
    absl::MutexLock lock(&append_mutex_);
    // Called after each commit with the length of the write-ahead log.
    sqlite3_wal_hook(
        writer_.get(),
        [](void* self, sqlite3*, const char*, int pages) {
          auto* log = static_cast<SqliteLog*>(self);
          absl::MutexLock lock(&log->head_mutex_);
          const bool restarted = pages < log->wal_pages_;
          if (restarted) {
            log->next_checkpoint_pages_ = log->options_.checkpoint_pages;
            log->next_restart_pages_ = log->options_.restart_pages;
          }
          log->wal_pages_ = pages;
          return SQLITE_OK;
        },
        this);
  }
  checkpoint_thread_ = std::thread([this] { CheckpointLoop(); });
}

void SqliteLog::StopCheckpoints() {
  {
    absl::MutexLock lock(&head_mutex_);
    stopping_ = true;
  }
  if (checkpoint_thread_.joinable()) checkpoint_thread_.join();
}

void SqliteLog::WaitForCheckpoint() {
  const auto near = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS {
    return stopping_ || wal_pages_ < next_checkpoint_pages_ + 3 * options_.restart_pages;
  };
  absl::MutexLock lock(&head_mutex_);
  // The timeout is for a disk on which the checkpoint hangs: appends then go on slowly, as long as the disk
  // takes them.
  head_mutex_.AwaitWithTimeout(absl::Condition(&near), absl::Seconds(1));
}

LogUpkeep SqliteLog::Upkeep() {
  std::error_code absent;
  const uint64_t bytes = std::filesystem::file_size(absl::StrCat(folder_.File(kFileName), "-wal"), absent);
  absl::MutexLock lock(&head_mutex_);
  return {absent ? 0 : bytes, checkpoint_failures_};
}

void SqliteLog::CarryOver() {
  const int code =
      sqlite3_wal_checkpoint_v2(checkpointer_.get(), nullptr, SQLITE_CHECKPOINT_PASSIVE, nullptr, nullptr);
  // A checkpoint by another connection is as good.
  const int kind = code & 0xff;
  if (kind == SQLITE_OK || kind == SQLITE_BUSY || kind == SQLITE_LOCKED) return;
  absl::MutexLock lock(&head_mutex_);
  ++checkpoint_failures_;
}

void SqliteLog::CheckpointLoop() {
  pthread_setname_np(pthread_self(), "checkpoints");
  const auto due = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS {
    return stopping_ || wal_pages_ >= next_checkpoint_pages_;
  };
  while (true) {
    {
      absl::MutexLock lock(&head_mutex_);
      head_mutex_.Await(absl::Condition(&due));
      if (stopping_) return;
    }
    // Runs beside the appends. Only a fully checkpointed write-ahead log restarts from the beginning instead
    // of growing, so continuous appends wait for that when the log is long. After an error (a full disk) the
    // records stay where they are, as durable as before.
    CarryOver();
    // The append under way counts its pages first. The next checkpoint then begins while some pages are not
    // checkpointed, and no append restarts the write-ahead log at that moment: SQLite before 3.51.3 may lose
    // records then (https://www.sqlite.org/wal.html#walresetbug).
    absl::MutexLock append_lock(&append_mutex_);
    {
      absl::MutexLock lock(&head_mutex_);
      next_checkpoint_pages_ = wal_pages_ + options_.checkpoint_pages;
      if (wal_pages_ < next_restart_pages_) continue;
    }
    CarryOver();
    absl::MutexLock lock(&head_mutex_);
    next_checkpoint_pages_ = wal_pages_ + options_.checkpoint_pages;
    next_restart_pages_ = wal_pages_ + options_.restart_pages;  // incomplete if another process reads
  }
}

}  // namespace docent::log
