// Behaviour on a full disk or with an unusable folder. Each case runs in a child process, because it
// changes a limit or the user of the whole process; the child's exit code is the line of the failed
// expectation.
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <csignal>
#include <fstream>

#include "absl/strings/match.h"
#include "graph/log/folder_check.h"
#include "graph/log/folder_copy.h"
#include "graph/log/record_codec.h"
#include "graph/log/sqlite_log.h"
#include "tests/graph/log/test_records.h"

namespace docent::log {
namespace {

#define REQUIRE_IN_CHILD(condition) \
  if (!(condition)) _exit((__LINE__) % 255 + 1)

template <typename Body>
void ExpectGoodChild(Body body) {
  const pid_t child = fork();
  if (child == 0) {
    body();
    _exit(0);
  }
  int state = 0;
  ASSERT_EQ(waitpid(child, &state, 0), child);
  ASSERT_TRUE(WIFEXITED(state)) << "signal " << WTERMSIG(state);
  EXPECT_EQ(WEXITSTATUS(state), 0) << "failed at line " << WEXITSTATUS(state) - 1;
}

// Appends batches of three until one is refused; then `make_room`, and the refused batch must go in whole.
template <typename MakeRoom>
void FillUpAndGoOn(const std::string& folder, MakeRoom make_room) {
  const std::vector<std::string> batch(3, std::string(5000, 'x'));
  uint64_t head = 0;
  {
    auto log = SqliteLog::Open(folder);
    REQUIRE_IN_CHILD(log.ok());
    absl::Status status;
    while (status.ok()) {
      const auto result = (*log)->Append(batch, 1, head);
      status = result.status();
      if (result.ok()) head = result->head.offset;
      REQUIRE_IN_CHILD(head < 30000);
    }
    REQUIRE_IN_CHILD(absl::IsResourceExhausted(status) || absl::IsUnavailable(status));
    REQUIRE_IN_CHILD(head > 3);
    // Reading goes on, appending is refused again, and no batch is half written.
    for (int i = 0; i < 3; ++i) REQUIRE_IN_CHILD(!(*log)->Append(batch, 1, head).ok());
    REQUIRE_IN_CHILD((*log)->Head()->offset == head);
    const auto last = (*log)->Read(head - 2, 10);
    REQUIRE_IN_CHILD(last.ok() && last->size() == 3);
    REQUIRE_IN_CHILD(!(*log)->SnapshotPut(head, std::string(40 << 20, 's')).ok());
    REQUIRE_IN_CHILD(!(*log)->SnapshotGet(head)->has_value());

    make_room();
    const auto result = (*log)->Append(batch, 1, head);
    REQUIRE_IN_CHILD(result.ok() && result->head.offset == head + 3);
    head += 3;
  }
  auto log = SqliteLog::Open(folder);
  REQUIRE_IN_CHILD(log.ok());
  uint64_t next = 1;
  while (next <= head) {
    const auto entries = (*log)->Read(next, 1000);
    REQUIRE_IN_CHILD(entries.ok() && !entries->empty());
    next = entries->back().offset + 1;
  }
  REQUIRE_IN_CHILD(next == head + 1);
}

TEST(LogDiskTest, FileSizeLimitRefusesAndRecovers) {
  TestFolder folder;
  ExpectGoodChild([&] {
    signal(SIGXFSZ, SIG_IGN);
    rlimit limit{4u << 20, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
    FillUpAndGoOn(folder.path(), [] {
      rlimit none{RLIM_INFINITY, RLIM_INFINITY};
      setrlimit(RLIMIT_FSIZE, &none);
    });
  });
}

// Checkpoints run in the background, where no caller sees an error: errors are counted.
TEST(LogDiskTest, FailedCheckpointsAreCounted) {
  TestFolder folder;
  ExpectGoodChild([&] {
    signal(SIGXFSZ, SIG_IGN);
    SqliteLogOptions options;
    options.checkpoint_pages = 50;
    options.restart_pages = 200;  // so that the limit below applies to the database only
    const auto log = SqliteLog::Open(folder.path(), options);
    REQUIRE_IN_CHILD(log.ok());
    const std::vector<std::string> batch(3, std::string(5000, 'x'));
    uint64_t head = 0;
    const auto append = [&] {
      const auto result = (*log)->Append(batch, 1, head);
      if (result.ok()) head = result->head.offset;
      return result.ok();
    };
    while (head < 1500) REQUIRE_IN_CHILD(append());
    REQUIRE_IN_CHILD((*log)->Upkeep().failures == 0);
    REQUIRE_IN_CHILD((*log)->Upkeep().wal_bytes > 0);
    struct stat database {};
    REQUIRE_IN_CHILD(stat(folder.File(SqliteLog::kFileName).c_str(), &database) == 0);
    rlimit limit{static_cast<rlim_t>(database.st_size), RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
    for (int tries = 0; (*log)->Upkeep().failures == 0; ++tries) {
      REQUIRE_IN_CHILD(tries < 3000);
      append();
      usleep(1000);
    }
  });
}

TEST(LogDiskTest, FullDiskRefusesAndRecovers) {
  TestFolder folder;
  if (mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=6m") != 0) {
    return;  // mounting needs root; the limit above covers the same ways through the code
  }
  ExpectGoodChild([&] {
    FillUpAndGoOn(folder.path(), [&] {
      REQUIRE_IN_CHILD(mount("tmpfs", folder.path().c_str(), "tmpfs", MS_REMOUNT, "size=64m") == 0);
    });
  });
  EXPECT_EQ(umount(folder.path().c_str()), 0);
}

void AppendTo(SqliteLog* log) {
  const std::string data = *EncodeTurnRecord(FullRecord());
  REQUIRE_IN_CHILD(log->Append(absl::MakeSpan(&data, 1), 1, log->Head()->offset).ok());
}

// A log of one record whose server shut down in order, or was killed: then the record is in the write-ahead
// log only.
void MakeLog(const std::string& folder, bool closed) {
  ExpectGoodChild([&] {
    auto log = SqliteLog::Open(folder);
    REQUIRE_IN_CHILD(log.ok());
    AppendTo(log->get());
    if (!closed) _exit(0);
  });
}

TEST(LogDiskTest, AFullDiskAtStartIsSaidAndTheLogCanBeCheckedAndCopied) {
  for (const bool closed : {true, false}) {
    TestFolder folder, target;
    if (mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=1m") != 0) return;  // needs root
    MakeLog(folder.path(), closed);
    // A file that a server creates at its start, and has no space for.
    std::filesystem::remove(folder.File("log.sqlite-shm"));
    std::ofstream(folder.File("filler"), std::ios::binary) << std::string(2 << 20, 'x');
    const auto is_full = [](const absl::Status& status) {
      return absl::IsResourceExhausted(status) &&
             absl::StrContains(std::string(status.message()), "log.sqlite: ") &&
             absl::StrContains(std::string(status.message()),
                               "disk is full; make room on the disk of the data folder");
    };
    EXPECT_PRED1(is_full, SqliteLog::Open(folder.path()).status());
    const auto report = CheckFolder(folder.path(), nullptr);
    const auto copy = CopyFolder(folder.path(), target.File("copy"));
    if (closed) {
      EXPECT_TRUE(report.ok() && report->sound() && report->last == 1) << report.status();
      EXPECT_TRUE(copy.ok() && copy->last == 1) << copy.status();
    } else {
      EXPECT_PRED1(is_full, report.status());
      EXPECT_PRED1(is_full, copy.status());
    }
    EXPECT_EQ(umount(folder.path().c_str()), 0);
  }
}

// As on a read-only medium.
TEST(LogDiskTest, AFolderThatCannotBeWrittenCanBeCheckedAndCopiedIfItWasClosed) {
  for (const bool closed : {true, false}) {
    TestFolder folder;
    MakeLog(folder.path(), closed);
    std::filesystem::remove(folder.File("log.sqlite-shm"));
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      ASSERT_EQ(chmod(entry.path().c_str(), 0444), 0);
    }
    ASSERT_EQ(chmod(folder.path().c_str(), 0555), 0);
    ExpectGoodChild([&] {
      if (geteuid() == 0) REQUIRE_IN_CHILD(setuid(65534) == 0);
      TestFolder target;
      const auto report = CheckFolder(folder.path(), nullptr);
      const auto copy = CopyFolder(folder.path(), target.File("copy"));
      if (closed) {
        REQUIRE_IN_CHILD(report.ok() && report->sound() && report->last == 1);
        REQUIRE_IN_CHILD(copy.ok() && copy->last == 1);
      } else {
        for (const absl::Status& status : {report.status(), copy.status()}) {
          REQUIRE_IN_CHILD(absl::IsPermissionDenied(status));
          REQUIRE_IN_CHILD(absl::StrContains(std::string(status.message()), folder.File("log.sqlite-wal")));
          REQUIRE_IN_CHILD(absl::StrContains(std::string(status.message()), "copy the folder"));
        }
      }
    });
    ASSERT_EQ(chmod(folder.path().c_str(), 0700), 0);
  }
}

TEST(LogDiskTest, UnusableFolderIsOneClearLine) {
  TestFolder folder;
  ASSERT_EQ(chmod(folder.path().c_str(), 0500), 0);
  ExpectGoodChild([&] {
    if (geteuid() == 0) REQUIRE_IN_CHILD(setuid(65534) == 0);
    const auto log = SqliteLog::Open(folder.path());
    REQUIRE_IN_CHILD(absl::IsPermissionDenied(log.status()));
    const std::string message(log.status().message());
    REQUIRE_IN_CHILD(message == "cannot use the data folder " + folder.path() + ": Permission denied");
    const auto below = SqliteLog::Open(folder.path() + "/below");
    REQUIRE_IN_CHILD(absl::IsPermissionDenied(below.status()));
  });
  ASSERT_EQ(chmod(folder.path().c_str(), 0700), 0);
}

TEST(LogDiskTest, UnreadableDatabaseIsPermissionDenied) {
  TestFolder folder;
  ASSERT_TRUE(SqliteLog::Open(folder.path()).ok());
  ASSERT_EQ(chmod(folder.path().c_str(), 0777), 0);
  for (const char* name : {"lock", "head"}) ASSERT_EQ(chmod(folder.File(name).c_str(), 0666), 0);
  ASSERT_EQ(chmod(folder.File("log.sqlite").c_str(), 0), 0);
  ExpectGoodChild([&] {
    if (geteuid() == 0) REQUIRE_IN_CHILD(setuid(65534) == 0);
    const auto log = SqliteLog::Open(folder.path());
    REQUIRE_IN_CHILD(absl::IsPermissionDenied(log.status()));
    REQUIRE_IN_CHILD(absl::StrContains(std::string(log.status().message()), "log.sqlite"));
  });
}

}  // namespace
}  // namespace docent::log
