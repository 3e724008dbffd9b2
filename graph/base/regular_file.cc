#include "graph/base/regular_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace docent {
namespace {

constexpr size_t kPiece = 1u << 20;

bool IsOfShell(const std::string& path) {
  return path == "/dev/stdin" || absl::StartsWith(path, "/dev/fd/") ||
         absl::StartsWith(path, "/proc/self/fd/");
}

// An open file, or why not. Opening does not wait for the other end of a pipe.
absl::StatusOr<int> Open(const std::string& path, bool shell_pipes) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (file < 0) return absl::NotFoundError(absl::StrCat("cannot read ", path, ": ", std::strerror(errno)));
  struct stat is {};
  std::string why;
  if (fstat(file, &is) != 0) {
    why = std::strerror(errno);
  } else if (S_ISDIR(is.st_mode)) {
    why = "is a directory; name its files";
  } else if (!S_ISREG(is.st_mode) && !(shell_pipes && IsOfShell(path))) {
    why = "is no regular file, but a pipe or device; give what it holds as a file";
  }
  if (why.empty()) {
    if (!S_ISREG(is.st_mode)) fcntl(file, F_SETFL, 0);  // what the shell writes is waited for
    return file;
  }
  close(file);
  return absl::InvalidArgumentError(absl::StrCat(path, " ", why));
}

}  // namespace

absl::StatusOr<RegularFile> ReadRegularFile(const std::string& path, size_t max_bytes, bool shell_pipes) {
  const absl::StatusOr<int> file = Open(path, shell_pipes);
  if (!file.ok()) return file.status();
  const absl::Cleanup closes = [&file] { close(*file); };
  RegularFile result;
  std::error_code unknown;
  const std::filesystem::path real =
      std::filesystem::read_symlink(absl::StrCat("/proc/self/fd/", *file), unknown);
  if (!unknown) result.real_path = real.string();
  std::string& text = result.text;
  while (text.size() <= max_bytes) {
    const size_t before = text.size();
    text.resize(before + std::min(kPiece, max_bytes + 1 - before));
    const ssize_t length = read(*file, text.data() + before, text.size() - before);
    const int error = errno;
    text.resize(before + static_cast<size_t>(std::max<ssize_t>(0, length)));
    if (length == 0) break;
    if (length < 0 && error != EINTR)
      return absl::UnavailableError(absl::StrCat("reading ", path, " failed: ", std::strerror(error)));
  }
  return result;
}

absl::Status CheckRegularFile(const std::string& path) {
  const absl::StatusOr<int> file = Open(path, false);
  if (file.ok()) close(*file);
  return file.status();
}

}  // namespace docent
