#include "graph/base/data_files.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace docent {
namespace {

namespace fs = std::filesystem;

// From build/PRESET/bin up to the source tree.
constexpr int kFoldersAbove = 3;

std::vector<std::string> Places(const std::string& program_folder) {
  if (const char* given = std::getenv("DOCENT_DATA_DIR"); given != nullptr && *given != '\0') return {given};
  std::vector<std::string> places;
  fs::path folder = fs::path(program_folder).lexically_normal();
  places.push_back((folder.parent_path() / "share" / "docent").string());
  for (int i = 0; i < kFoldersAbove && folder.has_relative_path(); ++i) {
    folder = folder.parent_path();
    places.push_back(folder.string());
  }
  return places;
}

}  // namespace

absl::StatusOr<std::string> FindDataFile(const std::string& name, const std::string& program_folder) {
  const std::vector<std::string> places = Places(program_folder);
  for (const std::string& place : places) {
    const fs::path path = fs::path(place) / name;
    std::error_code error;
    if (fs::exists(path, error)) return path.string();
  }
  return absl::NotFoundError(
      absl::StrCat("there is no file ", name, " in ", absl::StrJoin(places, ", "),
                   "; name the folder that has it in the environment variable DOCENT_DATA_DIR"));
}

absl::StatusOr<std::string> FindDataFile(const std::string& name) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return FindDataFile(name, error ? "." : program.parent_path().string());
}

}  // namespace docent
