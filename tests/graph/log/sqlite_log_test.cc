#include "graph/log/sqlite_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/graph/log/test_records.h"

namespace docent::log {
namespace {

using ::testing::HasSubstr;
using Outcome = AppendResult::Outcome;

std::unique_ptr<SqliteLog> OpenLog(const std::string& folder, const SqliteLogOptions& options = {}) {
  absl::StatusOr<std::unique_ptr<SqliteLog>> log = SqliteLog::Open(folder, options);
  EXPECT_TRUE(log.ok()) << log.status();
  return log.ok() ? *std::move(log) : nullptr;
}

std::vector<std::string> Records(uint64_t first, uint64_t count) {
  std::vector<std::string> records;
  for (uint64_t i = first; i < first + count; ++i) records.push_back(absl::StrCat("record ", i));
  return records;
}

void MustAppend(SqliteLog& log, uint64_t first, uint64_t count, uint64_t epoch = 1) {
  const absl::StatusOr<AppendResult> result = log.Append(Records(first, count), epoch, first - 1);
  ASSERT_TRUE(result.ok()) << result.status();
  ASSERT_EQ(result->outcome, Outcome::kAppended);
  ASSERT_EQ(result->head.offset, first + count - 1);
}

void ExpectRecords(SqliteLog& log, uint64_t from, uint64_t to) {
  uint64_t next = from;
  while (next <= to) {
    const absl::StatusOr<std::vector<LogEntry>> entries = log.Read(next, 7);
    ASSERT_TRUE(entries.ok()) << entries.status();
    ASSERT_FALSE(entries->empty());
    for (const LogEntry& entry : *entries) {
      EXPECT_EQ(entry.offset, next);
      EXPECT_EQ(entry.data, absl::StrCat("record ", next));
      ++next;
    }
  }
}

void RunSql(const std::string& file, const std::string& sql) {
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
  sqlite3_close(db);
}

TEST(SqliteLogTest, StartsEmpty) {
  TestFolder folder;
  auto log = OpenLog(folder.path() + "/made/on/the/way");
  EXPECT_EQ(*log->Head(), LogHead{});
  EXPECT_EQ(*log->First(), 1u);
  EXPECT_TRUE(log->Read(1, 10)->empty());
  EXPECT_FALSE(log->SnapshotGet(1000)->has_value());
}

TEST(SqliteLogTest, NothingInItsFolderIsReadByOthers) {
  TestFolder folder;
  auto log = OpenLog(folder.path());
  MustAppend(*log, 1, 1);
  size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
    const auto others = file.status().permissions() & std::filesystem::perms::others_all;
    EXPECT_EQ(others, std::filesystem::perms::none) << file.path();
    ++files;
  }
  EXPECT_GE(files, 3u);  // the log, its write-ahead log, the lock
}

TEST(SqliteLogTest, RecordsComeBackInOrderAndAfterReopening) {
  TestFolder folder;
  {
    auto log = OpenLog(folder.path());
    MustAppend(*log, 1, 1);
    MustAppend(*log, 2, 10);
    MustAppend(*log, 12, 100);
    ExpectRecords(*log, 1, 111);
  }
  auto log = OpenLog(folder.path());
  EXPECT_EQ(*log->Head(), (LogHead{111, 1}));
  ExpectRecords(*log, 1, 111);
  ExpectRecords(*log, 50, 111);
  EXPECT_TRUE(log->Read(112, 10)->empty());
  EXPECT_TRUE(log->Read(1, 0)->empty());
  MustAppend(*log, 112, 3);
  ExpectRecords(*log, 100, 114);
}

TEST(SqliteLogTest, EmptyAndLargeRecords) {
  TestFolder folder;
  auto log = OpenLog(folder.path());
  const std::string large(3 << 20, 'x');
  const std::vector<std::string> records = {"", large, std::string("\0\xFF\0", 3)};
  ASSERT_TRUE(log->Append(records, 1, 0).ok());
  const auto entries = log->Read(1, 10);
  ASSERT_TRUE(entries.ok()) << entries.status();
  ASSERT_EQ(entries->size(), 3u);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ((*entries)[i].data, records[i]);
}

TEST(SqliteLogTest, OneReadIsBoundedInBytes) {
  TestFolder folder;
  auto log = OpenLog(folder.path());
  const std::vector<std::string> records(20, std::string(2 << 20, 'x'));
  ASSERT_TRUE(log->Append(records, 1, 0).ok());
  const auto entries = log->Read(1, 1000);
  ASSERT_TRUE(entries.ok());
  EXPECT_EQ(entries->size(), ContextLog::kReadBytes / (2 << 20));
  EXPECT_EQ(log->Read(9, 1000)->size(), 8u);
}

TEST(SqliteLogTest, GroupCommitIsAllOrNothing) {
  TestFolder folder;
  auto log = OpenLog(folder.path());
  MustAppend(*log, 1, 5);
  const auto conflict = log->Append(Records(4, 3), 1, 3);
  ASSERT_TRUE(conflict.ok());
  EXPECT_EQ(conflict->outcome, Outcome::kConflict);
  EXPECT_EQ(conflict->head, (LogHead{5, 1}));
  EXPECT_EQ(log->Append(Records(8, 3), 1, 7)->outcome, Outcome::kConflict);
  EXPECT_EQ(log->Head()->offset, 5u);
  EXPECT_EQ(log->Append({}, 1, 5)->head.offset, 5u);
  ExpectRecords(*log, 1, 5);
}

TEST(SqliteLogTest, HigherEpochFencesTheLower) {
  TestFolder folder;
  {
    auto log = OpenLog(folder.path());
    MustAppend(*log, 1, 2, 3);
    // Claims without a record.
    const auto claimed = log->Append({}, 4, 2);
    ASSERT_TRUE(claimed.ok()) << claimed.status();
    EXPECT_EQ(claimed->head, (LogHead{2, 4}));
    const auto fenced = log->Append(Records(3, 1), 3, 2);
    ASSERT_TRUE(fenced.ok());
    EXPECT_EQ(fenced->outcome, Outcome::kFenced);
    EXPECT_EQ(fenced->head, (LogHead{2, 4}));
  }
  auto log = OpenLog(folder.path());
  EXPECT_EQ(log->Append(Records(3, 1), 3, 2)->outcome, Outcome::kFenced);
  MustAppend(*log, 3, 1, 4);
  const auto entries = log->Read(1, 10);
  EXPECT_EQ((*entries)[1].epoch, 3u);
  EXPECT_EQ((*entries)[2].epoch, 4u);
}

TEST(SqliteLogTest, WaitReturnsWhenARecordIsThere) {
  TestFolder folder;
  auto log = OpenLog(folder.path());
  EXPECT_EQ(*log->Wait(0, std::chrono::milliseconds(1)), 0u);
  std::thread writer([&] { MustAppend(*log, 1, 1); });
  EXPECT_EQ(*log->Wait(0, std::chrono::seconds(60)), 1u);
  writer.join();
  EXPECT_EQ(*log->Wait(0, std::chrono::seconds(0)), 1u);
}

TEST(SqliteLogTest, SnapshotsAreFoundByOffset) {
  TestFolder folder;
  auto log = OpenLog(folder.path());
  MustAppend(*log, 1, 10);
  EXPECT_EQ(log->SnapshotPut(11, "x").code(), absl::StatusCode::kInvalidArgument);
  ASSERT_TRUE(log->SnapshotPut(4, std::string(100000, 'a')).ok());
  ASSERT_TRUE(log->SnapshotPut(8, "").ok());
  EXPECT_FALSE((*log->SnapshotGet(3)).has_value());
  EXPECT_EQ((*log->SnapshotGet(7))->data, std::string(100000, 'a'));
  EXPECT_EQ((*log->SnapshotGet(8))->offset, 8u);
  ASSERT_TRUE(log->SnapshotPut(10, "c").ok());
  EXPECT_EQ((*log->SnapshotGet(UINT64_MAX))->data, "c");
  EXPECT_FALSE((*log->SnapshotGet(7)).has_value());  // the two newest are kept
}

TEST(SqliteLogTest, LargeSnapshotIsReadAsWritten) {
  TestFolder folder;
  auto log = OpenLog(folder.path());
  MustAppend(*log, 1, 2);
  std::string data;  // of several pieces, the last not whole
  for (uint32_t i = 0; data.size() < (3u << 20) + 5; ++i) data += absl::StrCat(i, ";");
  ASSERT_TRUE(log->SnapshotPut(2, data).ok());
  const auto snapshot = log->SnapshotGet(2);
  ASSERT_TRUE(snapshot.ok() && snapshot->has_value());
  EXPECT_TRUE((*snapshot)->data == data);
}

TEST(SqliteLogTest, DamagedSnapshotIsAnErrorThatNamesIt) {
  TestFolder folder;
  auto log = OpenLog(folder.path());
  MustAppend(*log, 1, 10);
  ASSERT_TRUE(log->SnapshotPut(3, "older").ok());
  ASSERT_TRUE(log->SnapshotPut(7, "the state").ok());
  const std::string file = folder.File("snapshot-00000000000000000007");
  std::string good;
  {
    std::ifstream in(file, std::ios::binary);
    good.assign(std::istreambuf_iterator<char>(in), {});
  }
  ASSERT_FALSE(good.empty());
  for (size_t i = 0; i <= good.size(); ++i) {
    std::string bad = i < good.size() ? good : good.substr(0, good.size() - 1);
    if (i < good.size()) bad[i] = static_cast<char>(bad[i] ^ 0x10);
    std::ofstream(file, std::ios::binary) << bad;
    const auto snapshot = log->SnapshotGet(10);
    ASSERT_EQ(snapshot.status().code(), absl::StatusCode::kDataLoss) << "byte " << i;
    EXPECT_THAT(std::string(snapshot.status().message()), HasSubstr("offset 7"));
  }
  EXPECT_EQ((*log->SnapshotGet(6))->data, "older");
}

TEST(SqliteLogTest, TrimKeepsTheChain) {
  TestFolder folder;
  SqliteLogOptions options;
  options.trim_step = 7;  // several steps
  {
    auto log = OpenLog(folder.path(), options);
    MustAppend(*log, 1, 100);
    EXPECT_EQ(log->Trim(51).code(), absl::StatusCode::kFailedPrecondition);
    ASSERT_TRUE(log->SnapshotPut(50, "s").ok());
    EXPECT_EQ(log->Trim(52).code(), absl::StatusCode::kFailedPrecondition);
    ASSERT_TRUE(log->Trim(51).ok());
    ASSERT_TRUE(log->Trim(20).ok());  // already gone
    EXPECT_EQ(*log->First(), 51u);
    EXPECT_EQ(log->Read(50, 1).status().code(), absl::StatusCode::kOutOfRange);
    ExpectRecords(*log, 51, 100);
    MustAppend(*log, 101, 5);
  }
  {
    auto log = OpenLog(folder.path(), options);
    EXPECT_EQ(*log->First(), 51u);
    ExpectRecords(*log, 51, 105);
    ASSERT_TRUE(log->SnapshotPut(105, "all").ok());
    ASSERT_TRUE(log->Trim(106).ok());
    EXPECT_EQ(*log->First(), 106u);
    EXPECT_TRUE(log->Read(106, 10)->empty());
  }
  auto log = OpenLog(folder.path(), options);
  EXPECT_EQ(*log->Head(), (LogHead{105, 1}));
  MustAppend(*log, 106, 2);
  ExpectRecords(*log, 106, 107);
}

TEST(SqliteLogTest, ReadersAndTrimmerBesideTheWriter) {
  TestFolder folder;
  SqliteLogOptions options;
  options.checkpoint_pages = 8;  // carried over again and again meanwhile
  options.restart_pages = 32;
  auto log = OpenLog(folder.path(), options);
  constexpr uint64_t kLast = 600;
  std::thread writer([&] {
    for (uint64_t i = 1; i <= kLast; i += 3) MustAppend(*log, i, 3);
  });
  std::thread trimmer([&] {
    for (uint64_t at = 50; at <= 300; at += 50) {
      uint64_t head = 0;
      while (head < at) head = *log->Wait(head, std::chrono::seconds(60));
      EXPECT_TRUE(log->SnapshotPut(at, "s").ok());
      EXPECT_TRUE(log->Trim(at + 1).ok());
    }
  });
  uint64_t next = 1;
  while (next <= kLast) {
    ASSERT_TRUE(log->Wait(next - 1, std::chrono::seconds(60)).ok());
    const auto entries = log->Read(next, 20);
    if (entries.status().code() == absl::StatusCode::kOutOfRange) {
      next = *log->First();
      continue;
    }
    ASSERT_TRUE(entries.ok()) << entries.status();
    for (const LogEntry& entry : *entries) {
      EXPECT_EQ(entry.offset, next);
      EXPECT_EQ(entry.data, absl::StrCat("record ", next));
      ++next;
    }
  }
  writer.join();
  trimmer.join();
  EXPECT_EQ(log->Head()->offset, kLast);
}

TEST(SqliteLogTest, WriteAheadLogDoesNotGrow) {
  TestFolder folder(TestFolder::Where::kMemory);
  SqliteLogOptions options;
  options.checkpoint_pages = 8;
  options.restart_pages = 16;
  auto log = OpenLog(folder.path(), options);
  const std::string record(20000, 'x');
  for (uint64_t i = 0; i < 1000; ++i) ASSERT_TRUE(log->Append(absl::MakeSpan(&record, 1), 1, i).ok());
  // 20 MB were written; the file restarts after each complete checkpoint, and appends wait when it is four
  // times as long as intended.
  EXPECT_LT(std::filesystem::file_size(folder.File("log.sqlite-wal")), 1u << 20);
}

// Records appended to moved files are not acknowledged.
class MovedLogTest : public ::testing::Test {
 protected:
  void ExpectRefused(const std::string& what) {
    const absl::StatusOr<AppendResult> result = log_->Append({"record"}, 1, 1);
    EXPECT_EQ(result.status().code(), absl::StatusCode::kUnavailable) << result.status();
    EXPECT_THAT(std::string(result.status().message()), HasSubstr(what));
    EXPECT_FALSE(log_->CheckPlace().ok());
    EXPECT_FALSE(log_->Probe().ok());
    EXPECT_FALSE(log_->SnapshotPut(1, "state").ok());
  }
  void Open() {
    log_ = OpenLog(folder_.path() + "/data");
    MustAppend(*log_, 1, 1);
    EXPECT_TRUE(log_->CheckPlace().ok());
  }

  TestFolder folder_;
  std::unique_ptr<SqliteLog> log_;
};

TEST_F(MovedLogTest, ADeletedFolderTakesNothing) {
  Open();
  std::filesystem::remove_all(folder_.path() + "/data");
  ExpectRefused("data is gone: it was deleted or moved while the server ran");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/data")) << "nothing is made again";
}

TEST_F(MovedLogTest, AFolderInThePlaceOfTheOldOneTakesNothing) {
  Open();
  std::filesystem::rename(folder_.path() + "/data", folder_.path() + "/old");
  ExpectRefused("data is gone");
  std::filesystem::copy(folder_.path() + "/old", folder_.path() + "/data");
  ExpectRefused("data is another file than the one that this server opened");
  std::filesystem::remove_all(folder_.path() + "/data");
  std::filesystem::rename(folder_.path() + "/old", folder_.path() + "/data");
  EXPECT_TRUE(log_->CheckPlace().ok()) << "as it was";
  MustAppend(*log_, 2, 1);
}

TEST_F(MovedLogTest, AFileOfTheLogThatIsGoneIsNoticed) {
  for (const std::string name : {"log.sqlite", "log.sqlite-wal", "log.sqlite-shm", "lock"}) {
    Open();
    const std::string path = folder_.path() + "/data/" + name;
    std::filesystem::rename(path, path + ".old");
    ExpectRefused(name + " is gone");
    std::ofstream(path) << "another";
    ExpectRefused(name + " is another file");
    log_.reset();
    std::filesystem::remove_all(folder_.path() + "/data");
  }
}

TEST(SqliteLogTest, SecondServerIsRefused) {
  TestFolder folder;
  auto log = OpenLog(folder.path());
  const auto second = SqliteLog::Open(folder.path());
  ASSERT_EQ(second.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(second.status().message()),
              HasSubstr(absl::StrCat("cannot use the data folder ", folder.path(),
                                     ": it is in use by process ", getpid())));
  log.reset();
  EXPECT_TRUE(SqliteLog::Open(folder.path()).ok());
}

TEST(SqliteLogTest, NewerFormatIsRefusedInOneLine) {
  TestFolder folder;
  OpenLog(folder.path()).reset();
  RunSql(folder.File("log.sqlite"), "PRAGMA user_version=2");
  const auto log = SqliteLog::Open(folder.path());
  ASSERT_EQ(log.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(log.status().message()), HasSubstr("has format 2, written by a newer Docent"));
  EXPECT_EQ(std::string(log.status().message()).find('\n'), std::string::npos);
}

TEST(SqliteLogTest, OtherDatabasesAndFilesAreRefused) {
  TestFolder folder;
  RunSql(folder.File("log.sqlite"), "CREATE TABLE other(x)");
  EXPECT_EQ(SqliteLog::Open(folder.path()).status().code(), absl::StatusCode::kInvalidArgument);
  TestFolder second;
  std::ofstream(second.File("log.sqlite")) << std::string(10000, 'x');
  EXPECT_EQ(SqliteLog::Open(second.path()).status().code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(SqliteLog::Open(second.File("log.sqlite")).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace docent::log
