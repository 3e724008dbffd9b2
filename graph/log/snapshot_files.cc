#include "graph/log/snapshot_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/log/data_folder.h"
#include "graph/log/record_chain.h"

namespace docent::log {
namespace {

constexpr std::string_view kPrefix = "snapshot-";
constexpr char kMagic[8] = {'D', 'O', 'C', 'S', 'N', 'A', 'P', '2'};

struct Header {
  char magic[8];
  uint64_t offset;
  uint64_t length;
  ChainHash chain;  // the log's chain hash at the offset
  ChainHash hash;   // SHA-256 of the fields above and of the content
};

absl::Status WriteAll(int fd, std::string_view bytes, const std::string& what) {
  while (!bytes.empty()) {
    const ssize_t written = write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return FileError(errno, what);
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return absl::OkStatus();
}

// Reads up to `size` bytes; fewer only at the end of the file.
absl::StatusOr<size_t> ReadAll(int fd, char* to, size_t size, const std::string& what) {
  size_t done = 0;
  while (done < size) {
    const ssize_t got = read(fd, to + done, size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return FileError(errno, what);
    if (got == 0) break;
    done += static_cast<size_t>(got);
  }
  return done;
}

// Hashes and writes the content piece by piece, and waits for the disk after each piece. An append to the
// log, which syncs on the same disk, then waits for one piece at most, and other threads get the core in
// between. Not durable before an fsync.
absl::Status WriteInPieces(int fd, std::string_view data, RecordHasher* hasher, const std::string& what) {
  constexpr size_t kPiece = 1 << 20;
  for (; !data.empty(); data.remove_prefix(std::min(kPiece, data.size()))) {
    const std::string_view piece = data.substr(0, kPiece);
    hasher->Add(piece);
    const absl::Status status = WriteAll(fd, piece, what);
    if (!status.ok()) return status;
    // Waits for all pages not yet on disk: those of the last piece. Errors must be reported here, because
    // fsync reports each error only once. On systems without this call, fsync does all the work.
    constexpr unsigned kAndWait =
        SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER;
    if (sync_file_range(fd, 0, 0, kAndWait) != 0 && errno != ENOSYS) return FileError(errno, what);
  }
  return absl::OkStatus();
}

// Writes the header last: its hash is known only after the content.
absl::Status WriteSynced(const std::string& path, Header header, std::string_view data,
                         const std::string& what) {
  unlink(path.c_str());  // of a writer that was killed, or a link that somebody put there
  FileHandle file(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0640));
  if (!file.valid()) return FileError(errno, what);
  if (lseek(file.fd(), sizeof(header), SEEK_SET) < 0) return FileError(errno, what);
  RecordHasher hasher(header.offset, header.length, header.chain);
  absl::Status status = WriteInPieces(file.fd(), data, &hasher, what);
  if (!status.ok()) return status;
  header.hash = hasher.Finish();
  if (lseek(file.fd(), 0, SEEK_SET) < 0) return FileError(errno, what);
  status = WriteAll(file.fd(), {reinterpret_cast<const char*>(&header), sizeof(header)}, what);
  if (status.ok() && fsync(file.fd()) != 0) status = FileError(errno, what);
  return status;
}

}  // namespace

std::string SnapshotFiles::Path(uint64_t offset) const {
  return absl::StrFormat("%s/%s%020d", folder_, std::string(kPrefix), offset);
}

absl::Status SnapshotFiles::Put(uint64_t offset, const ChainHash& chain, std::string_view data) {
  const std::string what = absl::StrCat("cannot write the snapshot at offset ", offset);
  Header header = {{}, offset, data.size(), chain, {}};
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  const std::string temporary = absl::StrCat(folder_, "/", kUnfinished);
  absl::Status status = WriteSynced(temporary, header, data, what);
  if (status.ok() && rename(temporary.c_str(), Path(offset).c_str()) != 0) status = FileError(errno, what);
  if (!status.ok()) {
    unlink(temporary.c_str());
    return status;
  }
  status = SyncPath(folder_);
  return status.ok() ? Thin() : status;
}

absl::Status SnapshotFiles::Thin() {
  absl::StatusOr<std::vector<uint64_t>> offsets = Offsets();
  if (!offsets.ok()) return offsets.status();
  while (offsets->size() > std::max(kept_, kNewestKept)) {
    size_t least = 0;
    uint64_t least_gap = UINT64_MAX;
    for (size_t i = 0; i + kNewestKept < offsets->size(); ++i) {
      const uint64_t before = i == 0 ? 0 : (*offsets)[i - 1];
      const uint64_t gap = (*offsets)[i + 1] - before;
      if (gap >= least_gap) continue;
      least = i;
      least_gap = gap;
    }
    unlink(Path((*offsets)[least]).c_str());
    offsets->erase(offsets->begin() + static_cast<std::ptrdiff_t>(least));
  }
  return absl::OkStatus();
}

absl::Status SnapshotFiles::DropBefore(uint64_t offset) {
  const absl::StatusOr<std::vector<uint64_t>> offsets = Offsets();
  if (!offsets.ok()) return offsets.status();
  for (size_t i = 0; i + kNewestKept < offsets->size() && (*offsets)[i] < offset; ++i) {
    unlink(Path((*offsets)[i]).c_str());
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<uint64_t>> SnapshotFiles::Offsets() const {
  std::vector<uint64_t> offsets;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder_, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    uint64_t offset = 0;
    if (name.starts_with(kPrefix) && absl::SimpleAtoi(name.substr(kPrefix.size()), &offset))
      offsets.push_back(offset);
  }
  if (error) return FileError(error.value(), absl::StrCat("cannot list the data folder ", folder_));
  std::sort(offsets.begin(), offsets.end());
  return offsets;
}

absl::StatusOr<std::optional<SnapshotFiles::Snapshot>> SnapshotFiles::Get(uint64_t at_most) const {
  const absl::StatusOr<std::vector<uint64_t>> offsets = Offsets();
  if (!offsets.ok()) return offsets.status();
  const auto after = std::upper_bound(offsets->begin(), offsets->end(), at_most);
  if (after == offsets->begin()) return std::optional<Snapshot>();
  Snapshot result;
  LogSnapshot& snapshot = result.content;
  snapshot.offset = *std::prev(after);

  const std::string what = absl::StrCat("cannot read the snapshot at offset ", snapshot.offset);
  const absl::Status damaged = absl::DataLossError(
      absl::StrCat("the snapshot at offset ", snapshot.offset, " is damaged: ", Path(snapshot.offset)));
  FileHandle file(open(Path(snapshot.offset).c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid()) return FileError(errno, what);
  struct stat facts;
  if (fstat(file.fd(), &facts) != 0) return FileError(errno, what);
  Header header;
  if (static_cast<size_t>(facts.st_size) < sizeof(header)) return damaged;
  absl::StatusOr<size_t> got = ReadAll(file.fd(), reinterpret_cast<char*>(&header), sizeof(header), what);
  if (!got.ok()) return got.status();
  if (*got != sizeof(header) || std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0 ||
      header.offset != snapshot.offset ||
      header.length != static_cast<size_t>(facts.st_size) - sizeof(header)) {
    return damaged;
  }
  snapshot.data.resize(header.length);
  got = ReadAll(file.fd(), snapshot.data.data(), snapshot.data.size(), what);
  if (!got.ok()) return got.status();
  const ChainHash hash = RecordHash(header.offset, header.length, header.chain, snapshot.data);
  if (*got != header.length || hash != header.hash) return damaged;
  result.chain = header.chain;
  return std::optional<Snapshot>(std::move(result));
}

}  // namespace docent::log
