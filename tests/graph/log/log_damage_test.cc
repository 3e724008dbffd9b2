// Damage of every kind must be found: if any byte of the log's files changes, opening or reading reports it,
// or the data read are still exactly the data written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>

#include <csignal>
#include <fstream>
#include <set>

#include "absl/strings/str_cat.h"
#include "graph/log/sqlite_log.h"
#include "tests/graph/log/test_records.h"

namespace docent::log {
namespace {

using ::testing::HasSubstr;

constexpr uint64_t kRecords = 12;

std::string RecordText(uint64_t offset) {
  return absl::StrCat("the content of record ", offset);
}

void Fill(const std::string& folder) {
  auto log = SqliteLog::Open(folder);
  ASSERT_TRUE(log.ok()) << log.status();
  for (uint64_t i = 1; i <= kRecords; ++i) {
    const std::string data = RecordText(i);
    ASSERT_TRUE((*log)->Append(absl::MakeSpan(&data, 1), 1, i - 1).ok());
  }
}

// Opens and reads everything. OK only if the content equals the data of Fill.
absl::Status ReadBack(const std::string& folder) {
  auto log = SqliteLog::Open(folder);
  if (!log.ok()) return log.status();
  const auto entries = (*log)->Read(1, 1000);
  if (!entries.ok()) return entries.status();
  EXPECT_EQ(entries->size(), kRecords) << "records are silently missing";
  for (const LogEntry& entry : *entries) {
    EXPECT_EQ(entry.data, RecordText(entry.offset)) << "a record is silently changed";
    EXPECT_EQ(entry.epoch, 1u);
  }
  EXPECT_EQ((*log)->Head()->offset, kRecords);
  EXPECT_EQ((*log)->Head()->epoch, 1u);
  return absl::OkStatus();
}

std::string Contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void Replace(const std::string& file, const std::string& contents) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << contents;
}

void RunSql(const std::string& file, const std::string& sql) {
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
  sqlite3_close(db);
}

// After `sql` the log must be found damaged, with `words` in the message.
void ExpectDamage(const std::string& sql, const std::string& words) {
  TestFolder folder(TestFolder::Where::kMemory);
  Fill(folder.path());
  RunSql(folder.File("log.sqlite"), sql);
  const absl::Status status = ReadBack(folder.path());
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << sql << ": " << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr(words)) << sql;
}

TEST(LogDamageTest, EveryColumnOfARecordIsGuarded) {
  ExpectDamage("UPDATE ctxlog SET data=x'00' WHERE seq=5", "damaged at offset 5: its checksum is wrong");
  ExpectDamage("UPDATE ctxlog SET crc=crc+1 WHERE seq=5", "damaged at offset 5: its checksum is wrong");
  ExpectDamage("UPDATE ctxlog SET crc=crc+4294967296 WHERE seq=5", "damaged at offset 5");
  ExpectDamage("UPDATE ctxlog SET epoch=0 WHERE seq=5", "damaged at offset 5: its checksum is wrong");
  ExpectDamage("UPDATE ctxlog SET prev_hash=zeroblob(32) WHERE seq=5",
               "damaged at offset 5: it does not follow");
  ExpectDamage("UPDATE ctxlog SET prev_hash=x'' WHERE seq=5", "damaged at offset 5: it does not follow");
  ExpectDamage("UPDATE ctxlog SET data='text' WHERE seq=5",
               "damaged at offset 5: a column is of the wrong type");
  ExpectDamage("DELETE FROM ctxlog WHERE seq=5", "damaged at offset 5: the record is missing");
  ExpectDamage("UPDATE ctxlog SET seq=100 WHERE seq=5", "offset");
}

TEST(LogDamageTest, TheEndIsGuarded) {
  ExpectDamage("DELETE FROM ctxlog WHERE seq=12", "damaged at offset 12: the record is missing");
  ExpectDamage("UPDATE ctxlog SET data=x'00' WHERE seq=12", "damaged at offset 12");
  ExpectDamage("INSERT INTO ctxlog VALUES(13, 1, 0, zeroblob(32), x'')",
               "damaged at offset 13: a record after the head");
  for (const char* column : {"seq", "epoch", "base_seq", "crc"}) {
    ExpectDamage(absl::StrCat("UPDATE head SET ", column, "=", column, "+1"), "head row is damaged");
  }
  ExpectDamage("UPDATE head SET hash=zeroblob(32)", "head row is damaged");
  ExpectDamage("UPDATE head SET base_hash=x'01'", "head row is damaged");
  ExpectDamage("DELETE FROM head", "head row is damaged");
  ExpectDamage("DROP TABLE head", "tables are damaged");
}

TEST(LogDamageTest, ARecordPutInItsPlaceBreaksTheChain) {
  // A forged record with a right checksum: the next one does not follow it.
  TestFolder folder;
  Fill(folder.path());
  ChainHash previous{};
  for (uint64_t i = 1; i < 5; ++i) previous = RecordHash(i, 1, previous, RecordText(i));
  RunSql(folder.File("log.sqlite"), absl::StrCat("UPDATE ctxlog SET data=CAST('forged' AS BLOB), crc=",
                                                 RecordCrc(5, 1, previous, "forged"), " WHERE seq=5"));
  const absl::Status status = ReadBack(folder.path());
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("damaged at offset 6: it does not follow the record before it"));
}

TEST(LogDamageTest, AnOlderCopyIsNoticed) {
  TestFolder folder;
  Fill(folder.path());
  const std::string older = Contents(folder.File("log.sqlite"));
  {
    auto log = SqliteLog::Open(folder.path());
    ASSERT_TRUE(log.ok());
    const std::string data = "one more";
    ASSERT_TRUE((*log)->Append(absl::MakeSpan(&data, 1), 1, kRecords).ok());
  }
  Replace(folder.File("log.sqlite"), older);
  const absl::Status status = ReadBack(folder.path());
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("ends at offset 12 but records up to 13 were acknowledged"));
  std::filesystem::remove(folder.File("head"));
  EXPECT_TRUE(ReadBack(folder.path()).ok());
}

// Must be refused with `words`, without creating anything.
void ExpectRefused(const TestFolder& folder, const std::string& words) {
  const auto files = [&folder] {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      names.insert(entry.path().filename());
    }
    return names;
  };
  const std::set<std::string> before = files();
  const absl::Status status = SqliteLog::Open(folder.path()).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr(words));
  EXPECT_EQ(files(), before);
}

TEST(LogDamageTest, ALostLogIsNotBegunAnew) {
  TestFolder folder;
  Fill(folder.path());
  ASSERT_TRUE((*SqliteLog::Open(folder.path()))->SnapshotPut(10, "state").ok());
  const std::string older = Contents(folder.File("log.sqlite"));
  std::filesystem::remove(folder.File("log.sqlite"));
  ExpectRefused(folder,
                "log.sqlite is gone but records up to 12 were acknowledged and there are snapshots at 10");
  Replace(folder.File("log.sqlite"), "");
  ExpectRefused(folder, "log.sqlite is gone but records up to 12 were acknowledged");
  std::filesystem::remove(folder.File("head"));
  ExpectRefused(folder,
                "log.sqlite is gone but there are snapshots at 10; restore a backup, or: `docent restore "
                "--from-snapshot " +
                    folder.path());
  // An old copy of the log, which does not reach the snapshot.
  Replace(folder.File("log.sqlite"), older);
  EXPECT_TRUE(ReadBack(folder.path()).ok());
  std::filesystem::rename(folder.File("snapshot-00000000000000000010"),
                          folder.File("snapshot-00000000000000000013"));
  std::filesystem::remove(folder.File("head"));
  ExpectRefused(folder,
                "ends at offset 12 but there are snapshots beyond it at 13: it is damaged or an old copy");
}

TEST(LogDamageTest, ADamagedMarkIsNotPassedOver) {
  TestFolder folder;
  Fill(folder.path());
  Replace(folder.File("head"), "damaged");
  ExpectRefused(folder, "/head: the mark of the log's end is damaged, so it is unknown");
  std::filesystem::remove(folder.File("head"));
  EXPECT_TRUE(ReadBack(folder.path()).ok());
  Replace(folder.File("head"), std::string(16, '\0'));  // as some file systems leave it after a power cut
  EXPECT_TRUE(ReadBack(folder.path()).ok());
}

TEST(LogDamageTest, FlippedByteOfTheDatabaseFileIsFoundOrHarmless) {
  TestFolder folder(TestFolder::Where::kMemory);
  Fill(folder.path());
  const std::string good = Contents(folder.File("log.sqlite"));
  const std::string mark = Contents(folder.File("head"));
  size_t found = 0;
  for (size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (i % 2 == 0 ? 0x01 : 0x80));
    Replace(folder.File("log.sqlite"), bad);
    Replace(folder.File("head"), mark);
    if (!ReadBack(folder.path()).ok()) ++found;
    ASSERT_FALSE(HasFailure()) << "byte " << i << " of " << good.size();
    std::filesystem::remove(folder.File("log.sqlite-wal"));
    std::filesystem::remove(folder.File("log.sqlite-shm"));
  }
  // Flips that are not found are in unused space; each record of ~40 bytes with its hash is used.
  EXPECT_GT(found, kRecords * 60);
}

TEST(LogDamageTest, FlippedByteOfTheWriteAheadLogIsFoundOrHarmless) {
  // The files of a killed server: the records are in the write-ahead log only, and SQLite takes the bytes
  // after a wrong one for the torn end of a crash.
  TestFolder folder(TestFolder::Where::kMemory);
  TestFolder killed(TestFolder::Where::kMemory);
  {
    auto log = SqliteLog::Open(folder.path());
    ASSERT_TRUE(log.ok());
    for (uint64_t i = 1; i <= kRecords; ++i) {
      const std::string data = RecordText(i);
      ASSERT_TRUE((*log)->Append(absl::MakeSpan(&data, 1), 1, i - 1).ok());
    }
    for (const char* name : {"log.sqlite", "log.sqlite-wal", "head"}) {
      std::filesystem::copy_file(folder.File(name), killed.File(name));
    }
  }
  const std::string database = Contents(killed.File("log.sqlite"));
  const std::string mark = Contents(killed.File("head"));
  const std::string good = Contents(killed.File("log.sqlite-wal"));
  size_t found = 0;
  for (size_t i = 0; i < good.size(); i += i < 4300 ? 1 : 13) {  // header and first frame whole, then samples
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x04);
    Replace(killed.File("log.sqlite"), database);
    Replace(killed.File("log.sqlite-wal"), bad);
    Replace(killed.File("head"), mark);
    std::filesystem::remove(killed.File("log.sqlite-shm"));
    if (!ReadBack(killed.path()).ok()) ++found;
    ASSERT_FALSE(HasFailure()) << "byte " << i << " of " << good.size();
  }
  EXPECT_GT(found, 4000u);
}

TEST(LogDamageTest, KilledServerLosesNothingThatWasAcknowledged) {
  TestFolder folder;
  int acknowledgements[2];
  ASSERT_EQ(pipe(acknowledgements), 0);
  const pid_t child = fork();
  if (child == 0) {
    auto log = SqliteLog::Open(folder.path());
    if (!log.ok()) _exit(1);
    for (uint64_t i = 1;; ++i) {
      const std::string data = RecordText(i);
      if (!(*log)->Append(absl::MakeSpan(&data, 1), 1, i - 1).ok()) _exit(2);
      if (write(acknowledgements[1], &i, sizeof(i)) != sizeof(i)) _exit(3);
    }
  }
  close(acknowledgements[1]);
  uint64_t acknowledged = 0;
  while (acknowledged < 500) ASSERT_EQ(read(acknowledgements[0], &acknowledged, sizeof(acknowledged)), 8);
  ASSERT_EQ(kill(child, SIGKILL), 0);
  uint64_t later = 0;
  while (read(acknowledgements[0], &later, sizeof(later)) == 8) acknowledged = later;
  waitpid(child, nullptr, 0);
  close(acknowledgements[0]);

  auto log = SqliteLog::Open(folder.path());
  ASSERT_TRUE(log.ok()) << log.status();
  EXPECT_GE((*log)->Head()->offset, acknowledged);
  const auto entries = (*log)->Read(1, 1000000);
  ASSERT_TRUE(entries.ok()) << entries.status();
  EXPECT_EQ(entries->size(), (*log)->Head()->offset);
  for (const LogEntry& entry : *entries) EXPECT_EQ(entry.data, RecordText(entry.offset));
}

}  // namespace
}  // namespace docent::log
