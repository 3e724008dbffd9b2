#include "kb_server/writer/snapshot_keeper.h"

#include <filesystem>
#include <fstream>
#include <future>
#include <thread>

#include "absl/strings/str_format.h"
#include "gmock/gmock.h"
#include "graph/log/folder_check.h"
#include "graph/log/sqlite_log.h"
#include "gtest/gtest.h"
#include "kb_server/writer/writer.h"
#include "tests/graph/log/test_records.h"
#include "tests/kb_server/random_world.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Lines;
using test::Put;
using test::Tell;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A writer that keeps snapshots and history in a folder, as a server does.
class Keeper {
 public:
  Keeper(const std::string& folder, const Limits& limits) : inbox(&clock, limits) {
    log::SqliteLogOptions options;
    options.snapshots_kept = limits.snapshots_kept;
    auto opened = log::SqliteLog::Open(folder, options);
    recovered = opened.status();
    if (!opened.ok()) return;
    log = *std::move(opened);
    snapshots = std::make_unique<SnapshotKeeper>(log.get(), &dictionary, limits);
    history = std::make_unique<History>(log.get(), &queries, &dictionary, &functions, limits);
    Writer::Ports ports;
    ports.inbox = &inbox;
    ports.log = log.get();
    ports.queries = &queries;
    ports.catalog = &catalog;
    ports.feed = &feed;
    ports.snapshots = snapshots.get();
    ports.history = history.get();
    ports.dictionary = &dictionary;
    ports.functions = &functions;
    ports.limits = limits;
    writer = std::make_unique<Writer>(ports);
    recovered = writer->Recover(nullptr);
    if (recovered.ok()) thread = std::thread([this] { writer->Run().IgnoreError(); });
  }
  ~Keeper() { Stop(); }

  void Stop() {
    inbox.Close();
    if (thread.joinable()) thread.join();
  }
  // An orderly shutdown.
  absl::Status StopWithSnapshot() {
    Stop();
    return snapshots->TakeLast(writer->State());
  }
  absl::StatusOr<BatchOutcome> Ask(WriteBatch batch) {
    std::promise<absl::StatusOr<BatchOutcome>> answer;
    inbox.Push(std::move(batch),
               [&answer](const absl::StatusOr<BatchOutcome>& outcome) { answer.set_value(outcome); });
    return answer.get_future().get();
  }
  void Tells(int from, int to) {
    for (int i = from; i < to; ++i) {
      WriteBatch batch = Tell({Fact(absl::StrCat("s", i % 50), "says", Term::Integer(i))});
      batch.request_id = absl::StrCat("r", i);
      ASSERT_TRUE(Ask(std::move(batch)).ok());
    }
  }
  void AwaitSnapshots(uint64_t count) {
    for (int i = 0; i < 6000 && snapshots->counters().written < count; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ASSERT_GE(snapshots->counters().written, count);
  }
  std::vector<std::string> Quads() const { return Lines(dictionary, *queries.Newest()); }

  SystemClock clock;
  Inbox inbox;
  QueryPort queries;
  CatalogPort catalog;
  RunFeed feed;
  Dictionary dictionary;
  sparql::FunctionRegistry functions;
  std::unique_ptr<log::SqliteLog> log;
  std::unique_ptr<SnapshotKeeper> snapshots;
  std::unique_ptr<History> history;
  std::unique_ptr<Writer> writer;
  std::thread thread;
  absl::Status recovered;
};

Limits Often() {
  Limits limits;
  limits.snapshot_records = 40;
  return limits;
}

std::string File(const std::string& folder, uint64_t offset) {
  return absl::StrFormat("%s/snapshot-%020d", folder, offset);
}
void Damage(const std::string& file) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekg(-3, std::ios::end);
  const char byte = static_cast<char>(stream.get());
  stream.seekp(-3, std::ios::end);
  stream.put(static_cast<char>(byte ^ 4));
}

TEST(SnapshotKeeperTest, SnapshotsAreTakenWhileServingAndTheNextStartUsesThem) {
  log::TestFolder folder;
  std::vector<std::string> quads;
  {
    Keeper keeper(folder.path(), Often());
    ASSERT_TRUE(keeper.recovered.ok()) << keeper.recovered;
    ASSERT_TRUE(keeper.Ask(test::WorldFacts()).ok());
    ASSERT_TRUE(keeper.Ask(Put(Document::Kind::kRules, "near.rules", test::kRules)).ok());
    ASSERT_TRUE(keeper.Ask(Put(Document::Kind::kCawl, "greeting.xml", test::kGreeting)).ok());
    ASSERT_TRUE(keeper.Ask(test::Start("Greeting")).ok());
    keeper.Tells(0, 100);
    keeper.AwaitSnapshots(1);
    keeper.Tells(100, 200);
    keeper.AwaitSnapshots(2);
    quads = keeper.Quads();
  }
  const auto report = log::CheckFolder(folder.path(), nullptr);
  ASSERT_TRUE(report.ok());
  EXPECT_THAT(report->faults, IsEmpty());
  ASSERT_GE(report->snapshots.size(), 2u);

  Keeper again(folder.path(), Often());
  ASSERT_TRUE(again.recovered.ok()) << again.recovered;
  EXPECT_EQ(again.Quads(), quads);
  EXPECT_EQ(again.writer->counters().live_runs, 1u);
  EXPECT_EQ(again.catalog.Get()->workflows.size(), 1u);
  EXPECT_EQ(again.catalog.Get()->modules.size(), 1u);
  // request ids are remembered across it, and its feed knows what the log knows
  WriteBatch repeated = Tell({Fact("never", "told", "this")});
  repeated.request_id = "r7";
  EXPECT_TRUE(again.Ask(repeated)->repeated);
  EXPECT_TRUE(again.feed.FirstAfter(Revision(0)).ok());
  EXPECT_GT(again.feed.Next(), 1u);
}

TEST(SnapshotKeeperTest, ADamagedSnapshotMakesRoomForTheOneBeforeAndTheLog) {
  log::TestFolder folder;
  std::vector<std::string> quads;
  {
    Keeper keeper(folder.path(), Often());
    keeper.Tells(0, 60);
    keeper.AwaitSnapshots(1);
    keeper.Tells(60, 130);
    keeper.AwaitSnapshots(2);
    quads = keeper.Quads();
    ASSERT_TRUE(keeper.StopWithSnapshot().ok());
  }
  auto report = log::CheckFolder(folder.path(), nullptr);
  ASSERT_GE(report->snapshots.size(), 3u);
  ASSERT_EQ(report->snapshots.back(), 130u);
  for (auto it = report->snapshots.rbegin(); it != report->snapshots.rend(); ++it) {
    Damage(File(folder.path(), *it));
    Keeper again(folder.path(), Often());
    ASSERT_TRUE(again.recovered.ok()) << again.recovered;
    EXPECT_EQ(again.Quads(), quads);
  }
}

TEST(SnapshotKeeperTest, TheLogIsTrimmedAndWithoutAGoodSnapshotThereIsNoStart) {
  log::TestFolder folder;
  Limits limits = Often();
  limits.log_bytes_kept = 20000;
  limits.snapshots_kept = 2;
  std::vector<std::string> quads;
  {
    Keeper keeper(folder.path(), limits);
    for (uint64_t i = 0; i < 6; ++i) {
      keeper.Tells(static_cast<int>(i) * 100, static_cast<int>(i) * 100 + 100);
      keeper.AwaitSnapshots(i + 1);
    }
    quads = keeper.Quads();
  }
  auto report = log::CheckFolder(folder.path(), nullptr);
  ASSERT_TRUE(report.ok());
  EXPECT_THAT(report->faults, IsEmpty());
  EXPECT_GT(report->first, 1u);
  ASSERT_EQ(report->snapshots.size(), 2u);
  EXPECT_LE(report->first, report->snapshots.front() + 1);
  {
    Keeper again(folder.path(), limits);
    ASSERT_TRUE(again.recovered.ok()) << again.recovered;
    EXPECT_EQ(again.Quads(), quads);
    Cancellation cancellation;
    const absl::Status old = again.history->At(Revision(3), &cancellation).status();
    EXPECT_EQ(old.code(), absl::StatusCode::kOutOfRange);
  }
  report = log::CheckFolder(folder.path(), nullptr);
  for (const uint64_t offset : report->snapshots) Damage(File(folder.path(), offset));
  Keeper lost(folder.path(), limits);
  EXPECT_EQ(lost.recovered.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(lost.recovered.message()), HasSubstr("snapshot"));
}

TEST(SnapshotKeeperTest, AnOrderlyEndLeavesASnapshotOfTheLastTurn) {
  log::TestFolder folder;
  {
    Keeper keeper(folder.path(), {});
    keeper.Tells(0, 5);
    ASSERT_TRUE(keeper.StopWithSnapshot().ok());
  }
  for (int i = 0; i < 2; ++i) {  // nothing new: nothing is written
    Keeper again(folder.path(), {});
    EXPECT_EQ(*again.log->SnapshotOffsets(), std::vector<uint64_t>{5});
    ASSERT_TRUE(again.StopWithSnapshot().ok());
  }
}

TEST(SnapshotKeeperTest, TurnsThatTheLogRefusedLeaveNoSnapshot) {
  log::TestFolder folder;
  auto log = log::SqliteLog::Open(folder.path());
  ASSERT_TRUE(log.ok());
  Dictionary dictionary;
  sparql::FunctionRegistry functions;
  Stages stages(&dictionary, &functions, {});
  ASSERT_TRUE(RunTurn(&stages, Tell({Fact("a", "b", "c")}), 1).ok());
  SnapshotKeeper keeper(log->get(), &dictionary, {});
  keeper.Take(TakeState(stages, RequestMemory(1), stages.writer.Freeze(Revision(1)), 1));
  keeper.Discard();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  // another turn takes the offset
  const std::string record = "another";
  ASSERT_TRUE((*log)->Append(absl::MakeConstSpan(&record, 1), 1, 0).ok());
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_THAT(*(*log)->SnapshotOffsets(), IsEmpty());
  EXPECT_EQ(keeper.counters().written, 0u);
}

TEST(SnapshotKeeperTest, ALargeGraphIsNotWrittenAgainForAFewRecords) {
  log::TestFolder folder;
  Limits limits = Often();
  Keeper keeper(folder.path(), limits);
  WriteBatch many;
  for (int i = 0; i < 20000; ++i) {
    many.operations.push_back({QuadOperation::Kind::kAdd, Fact(absl::StrCat("subject", i), "has",
                                                               Term::Literal(absl::StrCat("text ", i)))});
  }
  ASSERT_TRUE(keeper.Ask(many).ok());
  keeper.Tells(0, 45);
  keeper.AwaitSnapshots(1);
  keeper.Tells(45, 300);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(keeper.snapshots->counters().written, 1u);
}

}  // namespace
}  // namespace docent::server
