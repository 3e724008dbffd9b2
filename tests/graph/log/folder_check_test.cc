// A flipped byte anywhere in a data folder is found and named, or what is read is what was written.
#include "graph/log/folder_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <random>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/log/data_folder.h"
#include "graph/log/folder_copy.h"
#include "graph/log/record_codec.h"
#include "graph/log/sqlite_log.h"
#include "tests/graph/log/test_records.h"

namespace docent::log {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr uint64_t kRecords = 60;

std::string RecordOf(uint64_t offset) {
  TurnRecord record = FullRecord();
  record.batch.request_id = absl::StrCat("request-", offset);
  return *EncodeTurnRecord(record);
}
std::string SnapshotOf(uint64_t offset) {
  std::string text;
  for (uint64_t i = 0; i < 200; ++i) absl::StrAppend(&text, "state ", offset, " ", i * offset, "\n");
  return text;
}

// Records, snapshots at 20, 40 and 60, and the first 20 records trimmed away.
void Fill(const std::string& folder) {
  SqliteLogOptions options;
  options.snapshots_kept = 3;
  auto log = SqliteLog::Open(folder, options);
  ASSERT_TRUE(log.ok()) << log.status();
  for (uint64_t i = 1; i <= kRecords; ++i) {
    const std::string data = RecordOf(i);
    ASSERT_TRUE((*log)->Append(absl::MakeSpan(&data, 1), 1, i - 1).ok());
    if (i % 20 != 0) continue;
    ASSERT_TRUE((*log)->SnapshotPut(i, SnapshotOf(i)).ok());
  }
  ASSERT_TRUE((*log)->Trim(21).ok());
}

FolderReport Check(const std::string& folder) {
  auto report = CheckFolder(folder, nullptr);
  EXPECT_TRUE(report.ok()) << report.status();
  return report.ok() ? *report : FolderReport();
}

// Reads every record and snapshot as a server would. OK only if all of it equals the data of Fill.
absl::Status ReadBack(const std::string& folder) {
  auto log = SqliteLog::Open(folder);
  if (!log.ok()) return log.status();
  const auto entries = (*log)->Read(21, 1000);
  if (!entries.ok()) return entries.status();
  EXPECT_EQ(entries->size(), kRecords - 20);
  for (const LogEntry& entry : *entries) EXPECT_EQ(entry.data, RecordOf(entry.offset)) << "silently changed";
  for (const uint64_t offset : {20, 40, 60}) {
    const auto snapshot = (*log)->SnapshotGet(offset);
    if (!snapshot.ok()) return snapshot.status();
    if (!*snapshot || (*snapshot)->offset != offset) return absl::DataLossError("a snapshot is gone");
    EXPECT_EQ((*snapshot)->data, SnapshotOf(offset)) << "silently changed";
  }
  return absl::OkStatus();
}

std::string Contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void Replace(const std::string& file, const std::string& contents) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << contents;
}

std::vector<std::string> Files(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(FolderCheckTest, AWholeFolderIsSound) {
  TestFolder folder(TestFolder::Where::kMemory);
  Fill(folder.path());
  const FolderReport report = Check(folder.path());
  EXPECT_THAT(report.faults, IsEmpty());
  EXPECT_EQ(report.first, 21u);
  EXPECT_EQ(report.last, kRecords);
  EXPECT_THAT(report.snapshots, ElementsAre(20, 40, 60));
}

TEST(FolderCheckTest, WhatIsNoDataFolderIsSaidSo) {
  TestFolder folder;
  EXPECT_EQ(CheckFolder(folder.File("nothing"), nullptr).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(CheckFolder(folder.path(), nullptr).status().code(), absl::StatusCode::kInvalidArgument);
  Replace(folder.File("file"), "text");
  const absl::Status file = CheckFolder(folder.File("file"), nullptr).status();
  EXPECT_EQ(file.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(file.message()), HasSubstr("/file: it is not a folder"));
}

TEST(FolderCopyTest, FoldersOnTheWayAreMade) {
  TestFolder folder;
  EXPECT_TRUE(MakeFolders(folder.File("a/b/c/")).ok());
  EXPECT_TRUE(fs::is_directory(folder.File("a/b/c")));
  EXPECT_TRUE(MakeFolders(folder.File("a/b/c")).ok());
  Replace(folder.File("file"), "text");
  EXPECT_THAT(std::string(MakeFolders(folder.File("file/d")).message()), HasSubstr("cannot make the folder"));
}

TEST(FolderCheckTest, EveryFaultIsNamedWithFileAndOffset) {
  TestFolder folder(TestFolder::Where::kMemory);
  Fill(folder.path());
  const std::string file = folder.File("log.sqlite");
  std::string log = Contents(file);
  for (const uint64_t offset : {30, 45}) {
    const size_t at = log.find(absl::StrCat("request-", offset));
    ASSERT_NE(at, std::string::npos);
    log[at] ^= 1;
  }
  Replace(file, log);
  const std::string snapshot = folder.File("snapshot-00000000000000000040");
  std::string bytes = Contents(snapshot);
  bytes.back() ^= 1;
  Replace(snapshot, bytes);
  const FolderReport report = Check(folder.path());
  ASSERT_EQ(report.faults.size(), 3u) << absl::StrJoin(report.faults, "\n");
  EXPECT_THAT(report.faults[0], HasSubstr("log.sqlite: offset 30: its checksum is wrong"));
  EXPECT_THAT(report.faults[1], HasSubstr("log.sqlite: offset 45: its checksum is wrong"));
  EXPECT_THAT(report.faults[2], HasSubstr("snapshot-00000000000000000040"));
  EXPECT_THAT(report.snapshots, ElementsAre(20, 60));
}

TEST(FolderCheckTest, ASnapshotOfAnotherLogIsNoticed) {
  TestFolder folder(TestFolder::Where::kMemory), other(TestFolder::Where::kMemory);
  Fill(folder.path());
  {
    auto log = SqliteLog::Open(other.path());
    const std::vector<std::string> records(40, RecordOf(7));
    ASSERT_TRUE((*log)->Append(records, 1, 0).ok());
    ASSERT_TRUE((*log)->SnapshotPut(40, SnapshotOf(40)).ok());
  }
  const char* name = "snapshot-00000000000000000040";
  fs::copy_file(other.File(name), folder.File(name), fs::copy_options::overwrite_existing);
  const FolderReport report = Check(folder.path());
  ASSERT_EQ(report.faults.size(), 1u);
  EXPECT_THAT(report.faults[0], HasSubstr("not of this log"));
  auto log = SqliteLog::Open(folder.path());
  const auto snapshot = (*log)->SnapshotGet(40);
  EXPECT_EQ(snapshot.status().code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(snapshot.status().message()), HasSubstr("not of this log"));
}

TEST(FolderCheckTest, TheLossOfTheEndIsNoticed) {
  TestFolder folder(TestFolder::Where::kMemory);
  Fill(folder.path());
  const std::string older = Contents(folder.File("log.sqlite"));
  {
    auto log = SqliteLog::Open(folder.path());
    const std::string data = RecordOf(61);
    ASSERT_TRUE((*log)->Append(absl::MakeSpan(&data, 1), 1, 60).ok());
  }
  Replace(folder.File("log.sqlite"), older);
  const FolderReport report = Check(folder.path());
  ASSERT_EQ(report.faults.size(), 1u);
  EXPECT_THAT(report.faults[0], HasSubstr("ends at offset 60 but records up to 61 were acknowledged"));
}

TEST(FolderCheckTest, ALostLogIsNamedAndItsSnapshotsAreChecked) {
  TestFolder folder(TestFolder::Where::kMemory);
  Fill(folder.path());
  fs::remove(folder.File("log.sqlite"));
  const std::vector<std::string> files = Files(folder.path());
  const FolderReport report = Check(folder.path());
  ASSERT_EQ(report.faults.size(), 1u);
  EXPECT_THAT(report.faults[0],
              HasSubstr("log.sqlite is gone but records up to 60 were acknowledged and there are "
                        "snapshots at 20, 40, 60"));
  EXPECT_THAT(report.snapshots, ElementsAre(20, 40, 60));
  EXPECT_EQ(CopyFolder(folder.path(), folder.File("backup")).status().code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(Files(folder.path()), files);
}

TEST(FolderCheckTest, ASnapshotBeyondTheEndIsNamedWhetherOrNotAServerRuns) {
  TestFolder folder(TestFolder::Where::kMemory), longer(TestFolder::Where::kMemory);
  Fill(longer.path());
  const std::string data = RecordOf(1);
  auto log = SqliteLog::Open(folder.path());
  ASSERT_TRUE((*log)->Append(absl::MakeSpan(&data, 1), 1, 0).ok());
  const char* name = "snapshot-00000000000000000060";
  fs::copy_file(longer.File(name), folder.File(name));
  for (const bool running : {true, false}) {
    if (!running) log->reset();
    const FolderReport report = Check(folder.path());
    ASSERT_EQ(report.faults.size(), 1u) << running;
    EXPECT_THAT(report.faults[0],
                HasSubstr(absl::StrCat(name, ": it is of offset 60 but the log ends at 1")));
  }
}

// DOCENT_FLIPS=1000 for more of them.
TEST(FolderCheckTest, ARandomFlippedByteIsFoundOrHarmless) {
  TestFolder good(TestFolder::Where::kMemory);
  Fill(good.path());
  std::vector<std::string> files;
  uint64_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(good.path())) {
    if (entry.path().filename() == "lock") continue;  // names the process that uses the folder, nothing else
    files.push_back(entry.path().filename().string());
    bytes += entry.file_size();
  }
  const char* asked = std::getenv("DOCENT_FLIPS");
  const int flips = asked != nullptr ? std::atoi(asked) : 150;
  std::mt19937_64 random(std::random_device{}());
  int found = 0;
  constexpr int kHeaderBytes = 100;  // of the database file: each of them, too
  for (int i = -kHeaderBytes; i < flips; ++i) {
    TestFolder bad(TestFolder::Where::kMemory);
    fs::copy(good.path(), bad.path(), fs::copy_options::recursive);
    uint64_t at = i < 0 ? static_cast<uint64_t>(i + kHeaderBytes) : random() % bytes;
    std::string file = "log.sqlite";
    for (size_t f = 0; f < files.size() && i >= 0; ++f) {
      file = files[f];
      const uint64_t size = fs::file_size(good.File(file));
      if (at < size) break;
      at -= size;
    }
    std::string contents = Contents(bad.File(file));
    contents[at] ^= static_cast<char>(1 << random() % 8);
    Replace(bad.File(file), contents);
    SCOPED_TRACE(absl::StrCat("byte ", at, " of ", file));
    const auto report = CheckFolder(bad.path(), nullptr);
    const bool named = !report.ok() || !report->sound();
    if (report.ok()) {
      for (const std::string& fault : report->faults) EXPECT_THAT(fault, HasSubstr(bad.path()));
    }
    found += named ? 1 : 0;
    const absl::Status read = ReadBack(bad.path());
    EXPECT_TRUE(named || read.ok()) << "a server says " << read << ", but the check found nothing";
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(found, flips / 2);
}

TEST(FolderCopyTest, ACopyIsTheSameAndGoesOn) {
  TestFolder folder(TestFolder::Where::kMemory);
  Fill(folder.path());
  const std::string target = folder.File("backup");
  {
    auto log = SqliteLog::Open(folder.path());  // uses the folder meanwhile
    const auto report = CopyFolder(folder.path(), target + "/");
    ASSERT_TRUE(report.ok()) << report.status();
    EXPECT_EQ(report->last, kRecords);
    EXPECT_THAT(report->snapshots, ElementsAre(20, 40, 60));
  }
  EXPECT_TRUE(ReadBack(target).ok());
  auto log = SqliteLog::Open(target);
  const std::string data = RecordOf(61);
  EXPECT_TRUE((*log)->Append(absl::MakeSpan(&data, 1), 1, 60).ok());
}

TEST(FolderCopyTest, WhereTheLogIsLostTheNewestWholeSnapshotIsGoneOnFrom) {
  TestFolder folder(TestFolder::Where::kMemory);
  Fill(folder.path());
  fs::remove(folder.File("log.sqlite"));
  const std::string newest = folder.File("snapshot-00000000000000000060");
  std::string bytes = Contents(newest);
  bytes.back() ^= 1;
  Replace(newest, bytes);
  const std::string target = folder.File("target");
  const auto report = CopyNewestSnapshot(folder.path(), target);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->last, 40u);
  EXPECT_THAT(report->snapshots, ElementsAre(40));
  EXPECT_THAT(report->passed_over, ElementsAre(HasSubstr("snapshot-00000000000000000060")));
  {
    auto log = SqliteLog::Open(target);
    ASSERT_TRUE(log.ok()) << log.status();
    EXPECT_EQ((*log)->Head()->offset, 40u);
    EXPECT_EQ(*(*log)->First(), 41u);
    EXPECT_EQ((*(*log)->SnapshotGet(40))->data, SnapshotOf(40));
    const std::string data = RecordOf(41);
    EXPECT_TRUE((*log)->Append(absl::MakeSpan(&data, 1), 1, 40).ok());
  }
  EXPECT_THAT(Check(target).faults, IsEmpty());
  fs::remove_all(target);
  for (const char* offset : {"20", "40"})
    Replace(folder.File(absl::StrCat("snapshot-000000000000000000", offset)), "");
  const auto none = CopyNewestSnapshot(folder.path(), target);
  EXPECT_EQ(none.status().code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(none.status().message()), HasSubstr("no whole snapshot"));
  EXPECT_FALSE(fs::exists(target));
}

TEST(FolderCopyTest, CopiesWhileTheLogGrowsAndIsTrimmed) {
  TestFolder folder;
  auto log = SqliteLog::Open(folder.path());
  ASSERT_TRUE(log.ok());
  std::atomic<bool> stop{false};
  std::thread writer([&] {
    for (uint64_t i = 1; !stop; ++i) {
      const std::string data = RecordOf(i);
      ASSERT_TRUE((*log)->Append(absl::MakeSpan(&data, 1), 1, i - 1).ok());
      if (i % 50 != 0) continue;
      ASSERT_TRUE((*log)->SnapshotPut(i, SnapshotOf(i)).ok());
      if (i < 100) continue;
      ASSERT_TRUE((*log)->Trim(i - 49).ok());
    }
  });
  ASSERT_TRUE((*log)->Wait(60, std::chrono::seconds(60)).ok());
  for (int i = 0; i < 5; ++i) {
    const std::string target = folder.File(absl::StrCat("backup-", i));
    const auto report = CopyFolder(folder.path(), target);
    ASSERT_TRUE(report.ok()) << report.status();
    auto copy = SqliteLog::Open(target);
    ASSERT_TRUE(copy.ok()) << copy.status();
    EXPECT_EQ((*copy)->Head()->offset, report->last);
    EXPECT_EQ((*copy)->Read(report->first, 100000)->size(), report->last - report->first + 1);
  }
  stop = true;
  writer.join();
}

TEST(FolderCopyTest, NothingIsOverwrittenAndDamageIsNotCopied) {
  TestFolder folder(TestFolder::Where::kMemory);
  Fill(folder.path());
  EXPECT_EQ(CopyFolder(folder.path(), folder.path()).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(CopyFolder(folder.File("nothing"), folder.File("x")).status().code(),
            absl::StatusCode::kNotFound);
  std::string log = Contents(folder.File("log.sqlite"));
  log[log.find("request-33")] ^= 1;
  Replace(folder.File("log.sqlite"), log);
  const absl::Status status = CopyFolder(folder.path(), folder.File("backup")).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(status.message()), HasSubstr("offset 33"));
  EXPECT_FALSE(fs::exists(folder.File("backup")));
  EXPECT_FALSE(fs::exists(folder.File("backup.unfinished")));
}

}  // namespace
}  // namespace docent::log
