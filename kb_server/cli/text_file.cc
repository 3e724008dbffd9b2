#include "kb_server/cli/text_file.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace docent::server {

absl::Status ReplaceTextFile(const std::string& path, const std::string& text) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path target = fs::canonical(path, error);
  if (error) return absl::NotFoundError(absl::StrCat("cannot write ", path, ": ", error.message()));
  const fs::perms permissions = fs::status(target, error).permissions();
  // A file that may not be written is not replaced either, though its folder would allow it.
  if (access(target.c_str(), W_OK) != 0)
    return absl::ErrnoToStatus(errno, absl::StrCat("cannot write ", path));
  const fs::path aside = absl::StrCat(target.string(), ".", getpid(), ".part");
  std::ofstream out(aside, std::ios::binary);
  out << text;
  out.close();
  const bool written = !out.fail();
  if (written) fs::permissions(aside, permissions, error);
  if (written && !error) fs::rename(aside, target, error);
  if (written && !error) return absl::OkStatus();
  std::error_code ignored;
  fs::remove(aside, ignored);
  return absl::UnavailableError(
      absl::StrCat("cannot write ", path, ": ", error ? error.message() : "the disk may be full"));
}

}  // namespace docent::server
