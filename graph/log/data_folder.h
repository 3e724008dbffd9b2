// The folder in which a server keeps its log: created if absent, checked, and locked by one process at a
// time.
//
// It also holds the *head mark*: a file of a few bytes that is overwritten, without a sync, after each
// commit. If the database later ends before the mark, acknowledged records have been lost. (To SQLite a
// damaged write-ahead log looks like one that a crash cut off, and it drops the rest silently.) After a power
// cut the mark may be older than the database, never newer. One thread at a time.
#ifndef DOCENT_GRAPH_LOG_DATA_FOLDER_H_
#define DOCENT_GRAPH_LOG_DATA_FOLDER_H_

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace docent::log {

// A file descriptor that is closed at the end of its life.
class FileHandle {
 public:
  FileHandle() = default;
  explicit FileHandle(int fd) : fd_(fd) {}
  FileHandle(FileHandle&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  FileHandle& operator=(FileHandle&& other) noexcept;
  ~FileHandle();
  int fd() const { return fd_; }
  bool valid() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

// The identity of the file or folder under a path: another file in its place, even a copy, is not equal.
struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  friend bool operator==(const FileIdentity&, const FileIdentity&) = default;
};
// nullopt: the path does not exist.
std::optional<FileIdentity> IdentityOf(const std::string& path);

class DataFolder {
 public:
  // Creates `path` (with parents) if absent and takes its lock; creates nothing else. Errors, each one line:
  // INVALID_ARGUMENT (not a folder), PERMISSION_DENIED (cannot be read or written), FAILED_PRECONDITION (in
  // use; names the process).
  static absl::StatusOr<DataFolder> Open(const std::string& path);

  // True if a process holds the lock of the folder `path`.
  static bool InUse(const std::string& path);

  const std::string& path() const { return path_; }
  std::string File(const std::string& name) const { return path_ + "/" + name; }

  // The file of the head mark, read and written by its path. nullopt: there is none. DATA_LOSS: it is damaged.
  static constexpr char kMarkName[] = "head";
  static absl::StatusOr<std::optional<uint64_t>> ReadMark(const std::string& path);
  static absl::Status WriteMark(const std::string& path, uint64_t offset);

  // Remembers the identity of the file `name`, for CheckPlace. Call it before other threads use the folder.
  void Watch(const std::string& name);
  // Checks that the folder, its lock and the watched files are still in place. UNAVAILABLE: they were
  // deleted, moved or replaced, and the next start would not find what is written into them now. Any thread.
  absl::Status CheckPlace() const;

  // Opens the mark for writing, created if absent. Call it once the log is known to be whole.
  absl::Status OpenMark();
  // Best effort: if the mark cannot be written, only the check is lost.
  void SetHeadMark(uint64_t offset);
  // Syncs the mark, for an orderly shutdown.
  void SyncHeadMark();

 private:
  std::string path_;
  FileHandle lock_;
  FileHandle mark_;
  std::vector<std::pair<std::string, FileIdentity>> watched_;  // by path
};

// The status of errno value `error` while doing `what`: as SqliteError.
absl::Status FileError(int error, const std::string& what);

// Syncs a file, or the names in a folder, so that it survives a power cut.
absl::Status SyncPath(const std::string& path);

// Creates a folder and its missing parents, durably.
absl::Status MakeFolders(const std::string& path);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_DATA_FOLDER_H_
