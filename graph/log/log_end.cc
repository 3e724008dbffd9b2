#include "graph/log/log_end.h"

#include <filesystem>
#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/log/data_folder.h"
#include "graph/log/snapshot_files.h"
#include "graph/log/sqlite_log.h"

namespace docent::log {
namespace {

// `end`: nullopt if there is no log.
absl::Status Check(const std::string& folder, std::optional<uint64_t> end) {
  const std::string mark_file = absl::StrCat(folder, "/", DataFolder::kMarkName);
  const absl::StatusOr<std::optional<uint64_t>> mark = DataFolder::ReadMark(mark_file);
  if (absl::IsDataLoss(mark.status())) {
    return absl::DataLossError(
        absl::StrCat(std::string(mark.status().message()),
                     ", so it is unknown whether the log has lost records at its end; `docent verify ",
                     folder, "` checks those that are there; to go on with them, delete that file"));
  }
  if (!mark.ok()) return mark.status();
  const absl::StatusOr<std::vector<uint64_t>> snapshots = SnapshotFiles(folder, SIZE_MAX).Offsets();
  if (!snapshots.ok()) return snapshots.status();
  std::vector<std::string> signs;
  const uint64_t last = end.value_or(0);
  if (*mark && **mark > last) signs.push_back(absl::StrCat("records up to ", **mark, " were acknowledged"));
  std::vector<uint64_t> beyond;
  for (const uint64_t offset : *snapshots) {
    if (!end || offset > last) beyond.push_back(offset);
  }
  if (!beyond.empty()) {
    signs.push_back(
        absl::StrCat("there are snapshots", end ? " beyond it" : "", " at ", absl::StrJoin(beyond, ", ")));
  }
  if (signs.empty()) return absl::OkStatus();
  const std::string log = absl::StrCat("the log ", folder, "/", SqliteLog::kFileName);
  const std::string go_on =
      beyond.empty()
          ? absl::StrCat("to go on without those records, delete the file ", mark_file)
          : absl::StrCat(
                "`docent restore --from-snapshot ", folder,
                " --data NEW_FOLDER` goes on from the newest of the snapshots, without what came after it");
  return absl::DataLossError(
      absl::StrCat(end ? absl::StrCat(log, " ends at offset ", last) : absl::StrCat(log, " is gone"), " but ",
                   absl::StrJoin(signs, " and "), end ? ": it is damaged or an old copy" : "",
                   "; restore a backup, or: ", go_on));
}

}  // namespace

absl::Status FindLog(const std::string& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) {
    return absl::NotFoundError(absl::StrCat("there is no folder ", folder));
  }
  if (!std::filesystem::is_directory(folder, error)) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot use the data folder ", folder, ": it is not a folder"));
  }
  // A start that ends before it creates the log leaves an empty file.
  const uint64_t bytes = std::filesystem::file_size(absl::StrCat(folder, "/", SqliteLog::kFileName), error);
  if (!error && bytes > 0) return absl::OkStatus();
  if (absl::Status status = Check(folder, std::nullopt); !status.ok()) return status;
  return absl::InvalidArgumentError(
      absl::StrCat(folder, " is not a data folder: it has no file ", SqliteLog::kFileName));
}

absl::Status CheckReach(const std::string& folder, uint64_t end) {
  return Check(folder, end);
}

}  // namespace docent::log
