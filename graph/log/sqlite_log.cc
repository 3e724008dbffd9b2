#include "graph/log/sqlite_log.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "graph/log/log_end.h"

namespace docent::log {
namespace {

absl::Status Damaged(uint64_t offset, const char* how) {
  return absl::DataLossError(absl::StrCat("the log is damaged at offset ", offset, ": ", how,
                                          "; restore a backup of the data folder"));
}

}  // namespace

SqliteLog::SqliteLog(DataFolder folder, const SqliteLogOptions& options)
    : options_(options), folder_(std::move(folder)), snapshots_(folder_.path(), options.snapshots_kept) {}

absl::StatusOr<std::unique_ptr<SqliteLog>> SqliteLog::Open(const std::string& folder,
                                                           const SqliteLogOptions& options) {
  if (absl::Status status = FindLog(folder); absl::IsDataLoss(status)) return status;
  absl::StatusOr<DataFolder> locked = DataFolder::Open(folder);
  if (!locked.ok()) return locked.status();
  std::unique_ptr<SqliteLog> log(new SqliteLog(*std::move(locked), options));
  absl::Status status = log->Prepare();
  if (status.ok()) status = log->CheckEnd();
  if (status.ok()) status = log->folder_.OpenMark();
  if (!status.ok()) return status;
  for (const char* end : {"", "-wal", "-shm"}) log->folder_.Watch(absl::StrCat(kFileName, end));
  log->StartCheckpoints();
  return log;
}

SqliteLog::~SqliteLog() {
  StopCheckpoints();
  folder_.SyncHeadMark();
}

absl::Status SqliteLog::Prepare() {
  const std::string path = folder_.File(kFileName);
  absl::MutexLock append_lock(&append_mutex_);
  absl::MutexLock read_lock(&read_mutex_);
  for (DatabaseHandle* connection : {&writer_, &reader_, &checkpointer_}) {
    absl::StatusOr<DatabaseHandle> opened = OpenConnection(path);
    if (!opened.ok()) return opened.status();
    *connection = *std::move(opened);
    if (connection != &writer_) continue;
    const absl::Status status = PrepareSchema(writer_.get(), path);
    if (!status.ok()) return status;
  }
  struct Wanted {
    Statement* statement;
    sqlite3* db;
    const char* sql;
  };
  const Wanted all[] = {
      {&begin_, writer_.get(), "BEGIN IMMEDIATE"},
      {&commit_, writer_.get(), "COMMIT"},
      {&insert_, writer_.get(),
       "INSERT INTO ctxlog(seq, epoch, crc, prev_hash, data) VALUES(?1, ?2, ?3, ?4, ?5)"},
      // The database itself refuses a stale epoch or head: no row matches then.
      {&store_head_, writer_.get(),
       "UPDATE head SET seq=?1, epoch=?2, hash=?3, base_seq=?4, base_hash=?5, crc=?6 WHERE seq=?7 AND "
       "epoch=?8"},
      {&delete_before_, writer_.get(), "DELETE FROM ctxlog WHERE seq <= ?1"},
      {&select_, reader_.get(),
       "SELECT seq, epoch, crc, prev_hash, data FROM ctxlog WHERE seq >= ?1 ORDER BY seq LIMIT ?2"},
  };
  for (const Wanted& wanted : all) {
    absl::StatusOr<Statement> statement = Statement::Prepare(wanted.db, wanted.sql);
    if (!statement.ok()) return statement.status();
    *wanted.statement = *std::move(statement);
  }
  return absl::OkStatus();
}

// The head row and the last record must agree with each other, and with the mark and snapshots beside the
// log.
absl::Status SqliteLog::CheckEnd() {
  absl::MutexLock lock(&read_mutex_);
  const absl::StatusOr<HeadRow> head = ReadHead(reader_.get());
  if (!head.ok()) return head.status();
  if (head->offset < head->base_offset) return absl::DataLossError("the log's head row is damaged");
  if (absl::Status status = CheckReach(folder_.path(), head->offset); !status.ok()) return status;
  if (head->offset > head->base_offset) {
    const absl::StatusOr<Verified> last = At(head->offset, *head);
    if (!last.ok()) return last.status();
    if (last->hash != head->hash)
      return Damaged(head->offset, "the last record is not the one that the head names");
  } else if (head->hash != head->base_hash) {
    return absl::DataLossError("the log's head row is damaged");
  }
  select_.Bind(1, head->offset + 1).Bind(2, uint64_t{1});
  const absl::StatusOr<bool> beyond = select_.Step("cannot read the log");
  select_.Reset();
  if (!beyond.ok()) return beyond.status();
  if (*beyond) return Damaged(head->offset + 1, "a record after the head");
  Publish(*head);
  return absl::OkStatus();
}

absl::StatusOr<AppendResult> SqliteLog::Append(absl::Span<const std::string> records, uint64_t epoch,
                                               uint64_t expected_head) {
  WaitForCheckpoint();
  absl::MutexLock lock(&append_mutex_);
  const HeadRow old_head = CurrentHead();
  AppendResult result;
  result.head = {old_head.offset, old_head.epoch};
  if (epoch < old_head.epoch) {
    result.outcome = AppendResult::Outcome::kFenced;
    return result;
  }
  if (expected_head != old_head.offset) {
    result.outcome = AppendResult::Outcome::kConflict;
    return result;
  }
  if (records.empty() && epoch == old_head.epoch) return result;
  if (absl::Status there = CheckPlace(); !there.ok()) return there;

  HeadRow new_head = old_head;
  new_head.epoch = epoch;
  absl::Status status = begin_.Run("cannot append to the log");
  if (!status.ok()) return status;
  status = Insert(records, &new_head);
  if (status.ok()) status = StoreHead(old_head, new_head);
  status = Finish(std::move(status));
  if (!status.ok()) return status;

  folder_.SetHeadMark(new_head.offset);
  Publish(new_head);
  if (absl::Status there = CheckPlace(); !there.ok()) return there;
  result.head = {new_head.offset, new_head.epoch};
  return result;
}

absl::Status SqliteLog::Insert(absl::Span<const std::string> records, HeadRow* head) {
  for (const std::string& data : records) {
    const ChainHash previous = head->hash;
    ++head->offset;
    head->hash = RecordHash(head->offset, head->epoch, previous, data);
    const absl::Status status = insert_.Bind(1, head->offset)
                                    .Bind(2, head->epoch)
                                    .Bind(3, uint64_t{RecordCrc(head->offset, head->epoch, previous, data)})
                                    .Bind(4, AsBytes(previous))
                                    .Bind(5, data)
                                    .Run("cannot append to the log");
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status SqliteLog::StoreHead(const HeadRow& old_head, const HeadRow& new_head) {
  const absl::Status status = store_head_.Bind(1, new_head.offset)
                                  .Bind(2, new_head.epoch)
                                  .Bind(3, AsBytes(new_head.hash))
                                  .Bind(4, new_head.base_offset)
                                  .Bind(5, AsBytes(new_head.base_hash))
                                  .Bind(6, uint64_t{new_head.Crc()})
                                  .Bind(7, old_head.offset)
                                  .Bind(8, old_head.epoch)
                                  .Run("cannot append to the log");
  if (!status.ok()) return status;
  if (sqlite3_changes(writer_.get()) != 1)
    return absl::DataLossError("the log's head row was changed by another hand");
  return absl::OkStatus();
}

absl::Status SqliteLog::Finish(absl::Status status) {
  if (status.ok()) status = commit_.Run("cannot append to the log");
  // Some errors roll back by themselves, others leave the transaction open.
  if (!status.ok() && sqlite3_get_autocommit(writer_.get()) == 0) {
    Execute(writer_.get(), "ROLLBACK", "cannot roll back").IgnoreError();
  }
  return status;
}

void SqliteLog::Publish(const HeadRow& head) {
  absl::MutexLock lock(&head_mutex_);
  head_ = head;
}

HeadRow SqliteLog::CurrentHead() {
  absl::MutexLock lock(&head_mutex_);
  return head_;
}

absl::StatusOr<LogEntry> SqliteLog::TakeRow(Statement& row, Verified* previous) {
  const uint64_t offset = previous->offset + 1;
  if (!row.IsInteger(0) || row.Integer(0) != offset) return Damaged(offset, "the record is missing");
  if (!row.IsInteger(1) || !row.IsInteger(2) || !row.IsBytes(3) || !row.IsBytes(4)) {
    return Damaged(offset, "a column is of the wrong type");
  }
  LogEntry entry;
  entry.offset = offset;
  entry.epoch = row.Integer(1);
  if (row.Bytes(3) != AsBytes(previous->hash))
    return Damaged(offset, "it does not follow the record before it");
  if (row.Integer(2) != RecordCrc(offset, entry.epoch, previous->hash, row.Bytes(4))) {
    return Damaged(offset, "its checksum is wrong");
  }
  entry.data = row.Bytes(4);
  previous->offset = offset;
  previous->hash = RecordHash(offset, entry.epoch, previous->hash, entry.data);
  return entry;
}

absl::StatusOr<SqliteLog::Verified> SqliteLog::At(uint64_t offset, const HeadRow& head) {
  if (offset == head.base_offset) return Verified{head.base_offset, head.base_hash};
  if (offset == last_read_.offset) return last_read_;
  select_.Bind(1, offset).Bind(2, uint64_t{1});
  const absl::StatusOr<bool> row = select_.Step("cannot read the log");
  if (!row.ok()) return row.status();
  Verified verified{offset - 1, {}};
  absl::Status status = *row ? absl::OkStatus() : Damaged(offset, "the record is missing");
  if (status.ok() && (!select_.IsBytes(3) || select_.Bytes(3).size() != verified.hash.size())) {
    status = Damaged(offset, "a column is of the wrong type");
  }
  if (status.ok()) {
    // The previous record's hash as stored in this record: its checksum covers it.
    std::memcpy(verified.hash.data(), select_.Bytes(3).data(), verified.hash.size());
    status = TakeRow(select_, &verified).status();
  }
  select_.Reset();
  if (!status.ok()) return status;
  return verified;
}

absl::StatusOr<std::vector<LogEntry>> SqliteLog::Read(uint64_t from, size_t max) {
  absl::MutexLock lock(&read_mutex_);
  while (true) {
    const HeadRow head = CurrentHead();
    absl::StatusOr<std::vector<LogEntry>> entries = ReadUpTo(head, from, max);
    // Another thread may trim meanwhile: records that look damaged may only be trimmed away.
    if (entries.ok() || CurrentHead().base_offset == head.base_offset) return entries;
  }
}

absl::StatusOr<std::vector<LogEntry>> SqliteLog::ReadUpTo(const HeadRow& head, uint64_t from, size_t max) {
  std::vector<LogEntry> entries;
  if (from <= head.base_offset) {
    return absl::OutOfRangeError(absl::StrCat("log records up to ", head.base_offset, " were trimmed away, ",
                                              from, " among them; start from a snapshot"));
  }
  if (from > head.offset || max == 0) return entries;
  const absl::StatusOr<Verified> start = At(from - 1, head);
  if (!start.ok()) return start.status();
  Verified previous = *start;
  const uint64_t count = std::min<uint64_t>(max, head.offset - from + 1);
  select_.Bind(1, from).Bind(2, count);
  size_t bytes = 0;
  absl::Status status;
  while (entries.size() < count && (entries.empty() || bytes < kReadBytes)) {
    const absl::StatusOr<bool> row = select_.Step("cannot read the log");
    if (!row.ok()) return row.status();
    absl::StatusOr<LogEntry> entry =
        *row ? TakeRow(select_, &previous) : Damaged(previous.offset + 1, "the record is missing");
    if (entry.ok() && entry->offset == head.offset && previous.hash != head.hash) {
      entry = Damaged(head.offset, "the last record is not the one that the head names");
    }
    if (!entry.ok()) {
      status = entry.status();
      break;
    }
    bytes += entry->data.size();
    entries.push_back(*std::move(entry));
  }
  select_.Reset();
  if (!status.ok()) return status;
  last_read_ = previous;
  return entries;
}

absl::StatusOr<uint64_t> SqliteLog::Wait(uint64_t after, std::chrono::milliseconds timeout) {
  absl::MutexLock lock(&head_mutex_);
  const auto grown = [this, after]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return head_.offset > after; };
  head_mutex_.AwaitWithTimeout(absl::Condition(&grown), absl::FromChrono(timeout));
  return head_.offset;
}

absl::StatusOr<LogHead> SqliteLog::Head() {
  const HeadRow head = CurrentHead();
  return LogHead{head.offset, head.epoch};
}

absl::StatusOr<uint64_t> SqliteLog::First() {
  return CurrentHead().base_offset + 1;
}

absl::Status SqliteLog::SnapshotPut(uint64_t offset, std::string_view data) {
  if (absl::Status there = CheckPlace(); !there.ok()) return there;
  const uint64_t end = CurrentHead().offset;
  if (offset > end) {
    return absl::InvalidArgumentError(
        absl::StrCat("a snapshot at offset ", offset, " of a log that ends at ", end));
  }
  const absl::StatusOr<ChainHash> chain = HashAt(offset);
  if (!chain.ok()) return chain.status();
  absl::MutexLock lock(&snapshot_mutex_);
  return snapshots_.Put(offset, *chain, data);
}

absl::StatusOr<std::optional<LogSnapshot>> SqliteLog::SnapshotGet(uint64_t at_most) {
  absl::StatusOr<std::optional<SnapshotFiles::Snapshot>> found;
  {
    absl::MutexLock lock(&snapshot_mutex_);
    found = snapshots_.Get(at_most);
  }
  if (!found.ok()) return found.status();
  if (!*found) return std::optional<LogSnapshot>();
  const uint64_t offset = (*found)->content.offset;
  const uint64_t end = CurrentHead().offset;
  if (offset > end) {
    return absl::DataLossError(absl::StrCat("there is a snapshot at offset ", offset, " but the log ends at ",
                                            end, ": it is damaged or an old copy"));
  }
  const absl::StatusOr<ChainHash> chain = HashAt(offset);
  if (!chain.ok()) return chain.status();
  if (*chain != (*found)->chain) {
    return absl::DataLossError(absl::StrCat("the snapshot at offset ", offset, " is not of this log: ",
                                            folder_.path(), " holds files of several data folders"));
  }
  return std::move((*found)->content);
}

absl::StatusOr<std::vector<uint64_t>> SqliteLog::SnapshotOffsets() {
  absl::MutexLock lock(&snapshot_mutex_);
  return snapshots_.Offsets();
}

absl::Status SqliteLog::SnapshotDrop(uint64_t before) {
  absl::MutexLock lock(&snapshot_mutex_);
  return snapshots_.DropBefore(before);
}

absl::StatusOr<ChainHash> SqliteLog::HashAt(uint64_t offset) {
  absl::MutexLock lock(&read_mutex_);
  const HeadRow head = CurrentHead();
  if (offset == head.offset) return head.hash;
  if (offset < head.base_offset) {
    return absl::OutOfRangeError(
        absl::StrCat("log records up to ", head.base_offset, " were trimmed away, ", offset, " among them"));
  }
  const absl::StatusOr<Verified> at = At(offset, head);
  if (!at.ok()) return at.status();
  return at->hash;
}

}  // namespace docent::log
