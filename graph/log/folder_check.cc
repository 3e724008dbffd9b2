#include "graph/log/folder_check.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/log/data_folder.h"
#include "graph/log/log_end.h"
#include "graph/log/record_codec.h"
#include "graph/log/snapshot_files.h"
#include "graph/log/sqlite_handles.h"
#include "graph/log/sqlite_log.h"
#include "graph/log/sqlite_schema.h"

namespace docent::log {
namespace {

constexpr uint64_t kRecordsPerProgress = 10000;

// True for errors about the content of the folder, false for errors of reading it.
bool IsDamage(const absl::Status& status) {
  return absl::IsDataLoss(status);
}

class FolderChecker {
 public:
  FolderChecker(const std::string& folder, const std::function<void(uint64_t, uint64_t)>& progress)
      : folder_(folder), progress_(progress) {}

  absl::StatusOr<FolderReport> Run() {
    report_.database = absl::StrCat(folder_, "/", SqliteLog::kFileName);
    const absl::Status found = FindLog(folder_);
    if (!found.ok() && !IsDamage(found)) return found;
    // The log must reach the marks that exist before it is read, even if a server goes on meanwhile.
    const absl::StatusOr<std::vector<uint64_t>> snapshots = SnapshotFiles(folder_, SIZE_MAX).Offsets();
    if (!snapshots.ok()) return snapshots.status();
    of_interest_ = *snapshots;
    absl::Status status = ReadMark();
    if (!status.ok()) return status;
    if (found.ok()) {
      status = CheckLog();
    } else {
      Fault(std::string(found.message()));
    }
    if (status.ok()) CheckMark();
    if (status.ok()) status = CheckSnapshots();
    if (!status.ok()) return status;
    return std::move(report_);
  }

 private:
  void Fault(std::string text) {
    if (report_.faults.size() < kFaultsKept) report_.faults.push_back(std::move(text));
  }

  // A fault if it says that something is damaged; else the error itself.
  absl::Status Judge(const absl::Status& status) {
    if (!IsDamage(status)) return status;
    Fault(absl::StrCat(report_.database, ": ", std::string(status.message())));
    return absl::OkStatus();
  }

  // The file says in its header that it has a write-ahead log (SQLite file format, section 1.3.3). Otherwise
  // SQLite reads it, but does not write it, and a server could not go on with it.
  absl::Status CheckHeader() {
    FileHandle file(open(report_.database.c_str(), O_RDONLY | O_CLOEXEC));
    if (!file.valid()) return FileError(errno, absl::StrCat("cannot read ", report_.database));
    unsigned char versions[2] = {};  // for writing, for reading
    if (pread(file.fd(), versions, sizeof(versions), 18) != sizeof(versions) || versions[0] != 2 ||
        versions[1] != 2) {
      Fault(absl::StrCat(report_.database, ": bytes 18 and 19, its kind of journal, are damaged"));
    }
    return absl::OkStatus();
  }

  absl::Status CheckLog() {
    if (absl::Status status = CheckHeader(); !status.ok()) return status;
    absl::StatusOr<DatabaseHandle> db = OpenReadOnly(report_.database);
    if (!db.ok()) return Judge(db.status());
    db_ = *std::move(db);
    const std::string what = absl::StrCat("cannot read the log ", report_.database);
    // One consistent view, even if a server appends meanwhile.
    absl::Status status = Execute(db_.get(), "BEGIN", what);
    if (status.ok()) status = CheckFormat(db_.get(), report_.database);
    if (!status.ok()) return Judge(status);
    const absl::StatusOr<HeadRow> head = ReadHead(db_.get());
    if (head.ok()) {
      head_ = *head;
      report_.first = head_->base_offset + 1;
      report_.last = head_->offset;
    } else if (status = Judge(head.status()); !status.ok()) {
      return status;
    }
    status = CheckRecords();
    if (!status.ok()) return Judge(status);
    status = CheckPages();
    return status.ok() ? status : Judge(status);
  }

  // Finds damage of SQLite's own structure that reading all records does not touch.
  absl::Status CheckPages() {
    absl::StatusOr<Statement> check = Statement::Prepare(db_.get(), "PRAGMA integrity_check(20)");
    if (!check.ok()) return check.status();
    while (true) {
      const absl::StatusOr<bool> row = check->Step("cannot check the database file");
      if (!row.ok()) return row.status();
      if (!*row) return absl::OkStatus();
      if (check->Text(0) != "ok") Fault(absl::StrCat(report_.database, ": ", std::string(check->Text(0))));
    }
  }

  absl::Status CheckRecords() {
    absl::StatusOr<Statement> rows =
        Statement::Prepare(db_.get(), "SELECT seq, epoch, crc, prev_hash, data FROM ctxlog ORDER BY seq");
    if (!rows.ok()) return rows.status();
    uint64_t last = head_ ? head_->base_offset : 0;
    std::optional<ChainHash> previous;
    if (head_) previous = head_->base_hash;
    while (true) {
      const absl::StatusOr<bool> row = rows->Step("cannot read the log");
      if (!row.ok()) {
        return absl::Status(row.status().code(), absl::StrCat("at or after offset ", last + 1, ": ",
                                                              std::string(row.status().message())));
      }
      if (!*row) break;
      const uint64_t offset = rows->IsInteger(0) ? rows->Integer(0) : 0;
      if (offset != last + 1) {
        FaultAt(last + 1, offset > last + 2
                              ? absl::StrCat("this record and those up to ", offset - 1, " are missing")
                              : "the record is missing");
        previous.reset();
      }
      previous = CheckRecord(*rows, offset, previous);
      if (head_ && offset == head_->offset && previous && *previous != head_->hash) {
        FaultAt(offset, "the last record is not the one that the head names");
      }
      const bool wanted = std::binary_search(of_interest_.begin(), of_interest_.end(), offset);
      if (wanted && previous) hashes_[offset] = *previous;
      last = offset;
      if (progress_ && last % kRecordsPerProgress == 0) progress_(last, report_.last);
    }
    if (head_ && last < head_->offset) {
      FaultAt(last + 1, absl::StrCat("the log ends before it, but its head is ", head_->offset));
    }
    if (head_ && last > head_->offset) FaultAt(head_->offset + 1, "a record after the head");
    if (progress_) progress_(report_.last, report_.last);
    return absl::OkStatus();
  }

  void FaultAt(uint64_t offset, const std::string& what) {
    Fault(absl::StrCat(report_.database, ": offset ", offset, ": ", what));
  }

  // The hash of the record, if it is whole. `previous`: the hash of the record before, if that was whole.
  std::optional<ChainHash> CheckRecord(Statement& row, uint64_t offset,
                                       const std::optional<ChainHash>& previous) {
    ChainHash stated;
    if (!row.IsInteger(1) || !row.IsInteger(2) || !row.IsBytes(3) || !row.IsBytes(4) ||
        row.Bytes(3).size() != stated.size()) {
      FaultAt(offset, "a column is of the wrong type");
      return std::nullopt;
    }
    std::memcpy(stated.data(), row.Bytes(3).data(), stated.size());
    const uint64_t epoch = row.Integer(1);
    if (row.Integer(2) != RecordCrc(offset, epoch, stated, row.Bytes(4))) {
      FaultAt(offset, "its checksum is wrong");
      return std::nullopt;
    }
    if (previous && stated != *previous) FaultAt(offset, "it does not follow the record before it");
    if (absl::Status decoded = DecodeTurnRecord(offset, row.Bytes(4)).status(); !decoded.ok()) {
      FaultAt(offset, std::string(decoded.message()));
    }
    return RecordHash(offset, epoch, stated, row.Bytes(4));
  }

  absl::Status ReadMark() {
    const absl::StatusOr<std::optional<uint64_t>> mark = DataFolder::ReadMark(MarkFile());
    if (!mark.ok() && !IsDamage(mark.status())) return mark.status();
    if (mark.ok()) {
      mark_ = *mark;
    } else {
      Fault(std::string(mark.status().message()));
    }
    return absl::OkStatus();
  }

  void CheckMark() {
    if (!mark_ || !head_ || *mark_ <= head_->offset) return;
    Fault(absl::StrCat(report_.database, ": it ends at offset ", head_->offset, " but records up to ", *mark_,
                       " were acknowledged (", MarkFile(), ")"));
  }
  std::string MarkFile() const { return absl::StrCat(folder_, "/", DataFolder::kMarkName); }

  absl::Status CheckSnapshots() {
    SnapshotFiles files(folder_, SIZE_MAX);
    const absl::StatusOr<std::vector<uint64_t>> offsets = files.Offsets();
    if (!offsets.ok()) return offsets.status();
    for (const uint64_t offset : *offsets) {
      const absl::StatusOr<std::optional<SnapshotFiles::Snapshot>> snapshot = files.Get(offset);
      if (absl::IsNotFound(snapshot.status())) continue;  // a server dropped it meanwhile
      if (!snapshot.ok() && !IsDamage(snapshot.status())) return snapshot.status();
      if (!snapshot.ok()) {
        Fault(std::string(snapshot.status().message()));
      } else if (*snapshot && (*snapshot)->content.offset == offset && CheckPlace(files, **snapshot)) {
        report_.snapshots.push_back(offset);
      }
    }
    if (report_.first > 1 && head_ &&
        (report_.snapshots.empty() || report_.snapshots.back() < head_->base_offset)) {
      Fault(absl::StrCat(report_.database, ": the records before offset ", report_.first,
                         " were trimmed away, and no good snapshot takes their place"));
    }
    return absl::OkStatus();
  }

  bool CheckPlace(const SnapshotFiles& files, const SnapshotFiles::Snapshot& snapshot) {
    const uint64_t offset = snapshot.content.offset;
    if (!head_ || offset < head_->base_offset) return true;  // of no use, but not wrong
    if (offset > head_->offset) {
      if (!std::binary_search(of_interest_.begin(), of_interest_.end(), offset)) return false;  // taken later
      Fault(absl::StrCat(files.Path(offset), ": it is of offset ", offset, " but the log ends at ",
                         head_->offset));
      return false;
    }
    std::optional<ChainHash> hash;
    if (offset == head_->base_offset) hash = head_->base_hash;
    if (const auto it = hashes_.find(offset); it != hashes_.end()) hash = it->second;
    if (!hash || *hash == snapshot.chain) return true;  // no hash: the record itself was found to be wrong
    Fault(absl::StrCat(files.Path(offset), ": it is not of this log"));
    return false;
  }

  const std::string folder_;
  const std::function<void(uint64_t, uint64_t)>& progress_;
  FolderReport report_;
  DatabaseHandle db_;
  std::optional<HeadRow> head_;
  std::optional<uint64_t> mark_;          // as it was before the log was read
  std::vector<uint64_t> of_interest_;     // offsets of the snapshots at that time
  std::map<uint64_t, ChainHash> hashes_;  // of these records
};

}  // namespace

absl::StatusOr<FolderReport> CheckFolder(const std::string& folder,
                                         const std::function<void(uint64_t, uint64_t)>& progress) {
  return FolderChecker(folder, progress).Run();
}

}  // namespace docent::log
