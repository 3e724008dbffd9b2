#include "graph/log/folder_copy.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/log/data_folder.h"
#include "graph/log/log_end.h"
#include "graph/log/snapshot_files.h"
#include "graph/log/sqlite_handles.h"
#include "graph/log/sqlite_log.h"
#include "graph/log/sqlite_schema.h"

namespace docent::log {
namespace {

namespace fs = std::filesystem;

// If the server drops a snapshot between the copy of the log and the copy of the snapshot, another attempt is
// needed.
constexpr int kAttempts = 3;

// SQLite's online backup in one step: all pages of one moment, with those of the write-ahead log.
absl::Status CopyDatabase(const std::string& from, const std::string& to) {
  absl::StatusOr<DatabaseHandle> source = OpenReadOnly(from);
  if (!source.ok()) return source.status();
  CreateDatabaseFile(to);
  sqlite3* raw = nullptr;
  int code = sqlite3_open_v2(to.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  DatabaseHandle target(raw);
  const std::string what = absl::StrCat("cannot copy the log ", from, " to ", to);
  if (code != SQLITE_OK) return SqliteError(raw, code, what);
  sqlite3_backup* backup = sqlite3_backup_init(target.get(), "main", source->get(), "main");
  if (backup == nullptr) return SqliteError(target.get(), sqlite3_errcode(target.get()), what);
  code = sqlite3_backup_step(backup, -1);
  const int finished = sqlite3_backup_finish(backup);
  if (code != SQLITE_DONE) return SqliteError(target.get(), code, what);
  if (finished != SQLITE_OK) return SqliteError(target.get(), finished, what);
  return absl::OkStatus();
}

absl::Status CopySnapshots(const std::string& from, const std::string& to, const HeadRow& head) {
  const SnapshotFiles source(from, SIZE_MAX);
  const SnapshotFiles target(to, SIZE_MAX);
  const absl::StatusOr<std::vector<uint64_t>> offsets = source.Offsets();
  if (!offsets.ok()) return offsets.status();
  for (const uint64_t offset : *offsets) {
    if (offset > head.offset) continue;
    std::error_code error;
    fs::copy_file(source.Path(offset), target.Path(offset), error);
    if (error == std::errc::no_such_file_or_directory) continue;  // dropped meanwhile
    if (error) return FileError(error.value(), absl::StrCat("cannot copy ", source.Path(offset)));
    if (absl::Status status = SyncPath(target.Path(offset)); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::StatusOr<HeadRow> HeadOf(const std::string& database) {
  absl::StatusOr<DatabaseHandle> db = OpenReadOnly(database);
  if (!db.ok()) return db.status();
  if (absl::Status status = CheckFormat(db->get(), database); !status.ok()) return status;
  return ReadHead(db->get());
}

// Syncs the content of the folder `to` (snapshots are synced already), and checks all of it.
absl::StatusOr<FolderReport> Complete(const std::string& to, uint64_t end) {
  absl::Status status = DataFolder::WriteMark(absl::StrCat(to, "/", DataFolder::kMarkName), end);
  if (!status.ok()) return status;
  absl::StatusOr<FolderReport> report = CheckFolder(to, nullptr);
  if (!report.ok()) return report.status();
  status = SyncPath(report->database);
  if (status.ok()) status = SyncPath(to);
  if (!status.ok()) return status;
  return report;
}

absl::StatusOr<FolderReport> CopyOnce(const std::string& from, const std::string& to) {
  const std::string database = absl::StrCat(to, "/", SqliteLog::kFileName);
  absl::Status status = CopyDatabase(absl::StrCat(from, "/", SqliteLog::kFileName), database);
  if (!status.ok()) return status;
  const absl::StatusOr<HeadRow> head = HeadOf(database);
  if (!head.ok()) return head.status();
  status = CopySnapshots(from, to, *head);
  if (!status.ok()) return status;
  return Complete(to, head->offset);
}

absl::Status MakeAnew(const std::string& path) {
  std::error_code error;
  fs::remove_all(path, error);
  return MakeFolders(path);
}

// The newest undamaged snapshot.
absl::StatusOr<SnapshotFiles::Snapshot> NewestSnapshot(const std::string& folder,
                                                       std::vector<std::string>* passed_over) {
  const SnapshotFiles files(folder, SIZE_MAX);
  const absl::StatusOr<std::vector<uint64_t>> offsets = files.Offsets();
  if (!offsets.ok()) return offsets.status();
  for (auto offset = offsets->rbegin(); offset != offsets->rend(); ++offset) {
    absl::StatusOr<std::optional<SnapshotFiles::Snapshot>> snapshot = files.Get(*offset);
    if (snapshot.ok() && *snapshot && (*snapshot)->content.offset == *offset) return **std::move(snapshot);
    if (!snapshot.ok()) passed_over->push_back(std::string(snapshot.status().message()));
  }
  std::string message = absl::StrCat(folder, " holds no whole snapshot");
  for (const std::string& damaged : *passed_over) absl::StrAppend(&message, "; ", damaged);
  return absl::DataLossError(message);
}

absl::StatusOr<FolderReport> BeginAfter(const SnapshotFiles::Snapshot& snapshot, const std::string& to) {
  const uint64_t offset = snapshot.content.offset;
  absl::Status status = SnapshotFiles(to, SIZE_MAX).Put(offset, snapshot.chain, snapshot.content.data);
  if (!status.ok()) return status;
  const std::string database = absl::StrCat(to, "/", SqliteLog::kFileName);
  {
    absl::StatusOr<DatabaseHandle> db = OpenConnection(database);
    if (!db.ok()) return db.status();
    // As a log whose records were all trimmed away.
    status = PrepareSchema(db->get(), database, {offset, 0, snapshot.chain, offset, snapshot.chain});
  }
  if (!status.ok()) return status;
  return Complete(to, offset);
}

// Runs `make`, which fills a folder with the content of `from`; renames the folder to `to` once it is whole.
absl::StatusOr<FolderReport> MakeWhole(
    const std::string& from, const std::string& to,
    const std::function<absl::StatusOr<FolderReport>(const std::string& unfinished)>& make) {
  std::error_code error;
  if (fs::exists(to, error) && !(fs::is_directory(to, error) && fs::is_empty(to, error))) {
    return absl::InvalidArgumentError(
        absl::StrCat(to, " is there already and not an empty folder; choose another place"));
  }
  fs::path place = fs::absolute(to, error).lexically_normal();
  if (place.filename().empty()) place = place.parent_path();
  const std::string unfinished = absl::StrCat(place.string(), ".unfinished");
  absl::StatusOr<FolderReport> report;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const absl::Status made = MakeAnew(unfinished);
    report = made.ok() ? make(unfinished) : absl::StatusOr<FolderReport>(made);
    if (!report.ok() || report->sound()) break;
  }
  if (report.ok() && !report->sound()) {
    report = absl::DataLossError(absl::StrCat("the copy has faults, so ", from, " is damaged:\n",
                                              absl::StrJoin(report->faults, "\n")));
  }
  if (!report.ok()) {
    fs::remove_all(unfinished, error);
    return report;
  }
  fs::remove(place, error);  // an empty folder
  fs::rename(unfinished, place, error);
  if (error)
    return FileError(error.value(), absl::StrCat("cannot rename ", unfinished, " to ", place.string()));
  if (absl::Status status = SyncPath(place.parent_path().string()); !status.ok()) return status;
  report->database = absl::StrCat(place.string(), "/", SqliteLog::kFileName);
  return report;
}

}  // namespace

absl::StatusOr<FolderReport> CopyFolder(const std::string& from, const std::string& to) {
  if (absl::Status status = FindLog(from); !status.ok()) return status;
  return MakeWhole(from, to, [&from](const std::string& unfinished) { return CopyOnce(from, unfinished); });
}

absl::StatusOr<FolderReport> CopyNewestSnapshot(const std::string& from, const std::string& to) {
  std::vector<std::string> passed_over;
  const absl::StatusOr<SnapshotFiles::Snapshot> snapshot = NewestSnapshot(from, &passed_over);
  if (!snapshot.ok()) return snapshot.status();
  absl::StatusOr<FolderReport> report = MakeWhole(
      from, to, [&snapshot](const std::string& unfinished) { return BeginAfter(*snapshot, unfinished); });
  if (report.ok()) report->passed_over = std::move(passed_over);
  return report;
}

}  // namespace docent::log
