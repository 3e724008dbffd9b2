#include "graph/log/data_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "graph/base/overload.h"
#include "graph/log/record_chain.h"

namespace docent::log {
namespace {

struct Mark {
  uint64_t offset;
  uint64_t crc;
};

// The process that holds the lock wrote its process id into the lock file.
std::string Holder(int fd) {
  char text[32] = {};
  const ssize_t read = pread(fd, text, sizeof(text) - 1, 0);
  const std::string pid(absl::StripSuffix(read > 0 ? text : "", "\n"));
  return pid.empty() ? "another process" : absl::StrCat("process ", pid);
}

// Whoever may write into the folder could have the file elsewhere written over.
absl::Status LinkError(const std::string& path) {
  return absl::FailedPreconditionError(
      absl::StrCat(path, " is a symbolic link, which is not followed: remove it, or put a file there"));
}

}  // namespace

absl::Status FileError(int error, const std::string& what) {
  const std::string message = absl::StrCat(what, ": ", std::strerror(error));
  switch (error) {
    case EACCES:
    case EPERM:
    case EROFS:
      return absl::PermissionDeniedError(message);
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return OverloadError(absl::StrCat(message, "; make room on the disk of the data folder"));
    case ENOENT:
      return absl::NotFoundError(message);
    case ENOTDIR:
      return absl::InvalidArgumentError(message);
    default:
      return absl::UnavailableError(message);
  }
}

absl::Status SyncPath(const std::string& path) {
  FileHandle file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid() || fsync(file.fd()) != 0) return FileError(errno, absl::StrCat("cannot write ", path));
  return absl::OkStatus();
}

absl::Status MakeFolders(const std::string& given) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::string path = given;
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  std::vector<fs::path> above;  // the parent of each folder that is made
  for (fs::path at = fs::absolute(path, error); !fs::exists(at, error) && at.has_relative_path();
       at = at.parent_path())
    above.push_back(at.parent_path());
  const std::string what = absl::StrCat("cannot make the folder ", path);
  if (!above.empty()) fs::create_directories(above.front(), error);
  if (error) return FileError(error.value(), what);
  // Whatever the umask allows, it is for owner and group alone.
  if (mkdir(path.c_str(), 0750) != 0 && errno != EEXIST) return FileError(errno, what);
  for (const fs::path& folder : above) {
    const absl::Status synced = SyncPath(folder);
    if (!synced.ok() && !absl::IsPermissionDenied(synced))
      return synced;  // a folder without read permission cannot be synced
  }
  return absl::OkStatus();
}

std::optional<FileIdentity> IdentityOf(const std::string& path) {
  struct stat found;
  if (stat(path.c_str(), &found) != 0) return std::nullopt;
  return FileIdentity{found.st_dev, found.st_ino};
}

FileHandle& FileHandle::operator=(FileHandle&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

FileHandle::~FileHandle() {
  if (fd_ >= 0) close(fd_);
}

absl::StatusOr<DataFolder> DataFolder::Open(const std::string& path) {
  const std::string what = absl::StrCat("cannot use the data folder ", path);
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) {
    if (std::filesystem::exists(path, error)) {
      return absl::InvalidArgumentError(absl::StrCat(what, ": it is not a folder"));
    }
    if (absl::Status made = MakeFolders(path); !made.ok())
      return absl::Status(made.code(),
                          absl::StrCat("cannot use the data folder: ", std::string(made.message())));
  }
  if (access(path.c_str(), R_OK | W_OK | X_OK) != 0) return FileError(errno, what);

  DataFolder folder;
  folder.path_ = path;
  folder.lock_ =
      FileHandle(open(folder.File("lock").c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0640));
  if (!folder.lock_.valid() && errno == ELOOP) return LinkError(folder.File("lock"));
  if (!folder.lock_.valid()) return FileError(errno, what);
  if (flock(folder.lock_.fd(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return FileError(errno, what);
    return absl::FailedPreconditionError(absl::StrCat(what, ": it is in use by ", Holder(folder.lock_.fd()),
                                                      "; stop that one or choose another folder"));
  }
  // Only for the error message of the next process: a full disk may keep it from being written, without harm.
  const std::string pid = absl::StrCat(getpid(), "\n");
  if (ftruncate(folder.lock_.fd(), 0) == 0 && pwrite(folder.lock_.fd(), pid.data(), pid.size(), 0) < 0)
    errno = 0;
  if (const std::optional<FileIdentity> identity = IdentityOf(path)) {
    folder.watched_.emplace_back(path, *identity);
  }
  folder.Watch("lock");
  return folder;
}

void DataFolder::Watch(const std::string& name) {
  const std::string path = File(name);
  if (const std::optional<FileIdentity> identity = IdentityOf(path)) watched_.emplace_back(path, *identity);
}

absl::Status DataFolder::CheckPlace() const {
  for (const auto& [path, identity] : watched_) {
    const std::optional<FileIdentity> now = IdentityOf(path);
    if (now == identity) continue;
    return absl::UnavailableError(
        absl::StrCat(path,
                     now ? " is another file than the one that this server opened"
                         : " is gone: it was deleted or moved while the server ran",
                     "; nothing is written any more, since it would be lost. Put the data folder ", path_,
                     " back as it was: then writing goes on"));
  }
  return absl::OkStatus();
}

bool DataFolder::InUse(const std::string& path) {
  FileHandle lock(open(absl::StrCat(path, "/lock").c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
  return lock.valid() && flock(lock.fd(), LOCK_SH | LOCK_NB) != 0;
}

absl::StatusOr<std::optional<uint64_t>> DataFolder::ReadMark(const std::string& path) {
  FileHandle file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid() && errno == ENOENT) return std::optional<uint64_t>();
  if (!file.valid()) return FileError(errno, absl::StrCat("cannot read ", path));
  Mark mark;
  const ssize_t got = pread(file.fd(), &mark, sizeof(mark), 0);
  // The log has no record yet; or a file system left zeros after a power cut.
  const bool unset = got == 0 || (got == sizeof(mark) && mark.offset == 0 && mark.crc == 0);
  if (unset) return std::optional<uint64_t>();
  if (got == sizeof(mark) && mark.crc == Crc32c().Add(mark.offset).value()) return std::optional(mark.offset);
  return absl::DataLossError(absl::StrCat(path, ": the mark of the log's end is damaged"));
}

absl::Status DataFolder::WriteMark(const std::string& path, uint64_t offset) {
  const std::string what = absl::StrCat("cannot write ", path);
  FileHandle file(open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0640));
  if (!file.valid() && errno == ELOOP) return LinkError(path);
  if (!file.valid()) return FileError(errno, what);
  const Mark mark = {offset, Crc32c().Add(offset).value()};
  if (pwrite(file.fd(), &mark, sizeof(mark), 0) != sizeof(mark)) return FileError(errno, what);
  return fsync(file.fd()) == 0 ? absl::OkStatus() : FileError(errno, what);
}

absl::Status DataFolder::OpenMark() {
  mark_ = FileHandle(open(File(kMarkName).c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0640));
  if (!mark_.valid() && errno == ELOOP) return LinkError(File(kMarkName));
  return mark_.valid() ? absl::OkStatus()
                       : FileError(errno, absl::StrCat("cannot use the data folder ", path_));
}

void DataFolder::SetHeadMark(uint64_t offset) {
  const Mark mark = {offset, Crc32c().Add(offset).value()};
  if (pwrite(mark_.fd(), &mark, sizeof(mark), 0) != sizeof(mark) && ftruncate(mark_.fd(), 0) != 0) errno = 0;
}

void DataFolder::SyncHeadMark() {
  if (mark_.valid()) fdatasync(mark_.fd());
}

}  // namespace docent::log
