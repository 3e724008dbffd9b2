#include "kb_server/writer/history.h"

#include <algorithm>
#include <filesystem>

#include "absl/strings/str_format.h"
#include "gmock/gmock.h"
#include "graph/log/record_codec.h"
#include "graph/log/sqlite_log.h"
#include "gtest/gtest.h"
#include "kb_server/writer/recovery.h"
#include "tests/graph/log/test_records.h"
#include "tests/kb_server/random_world.h"

namespace docent::server {
namespace {

using test::Lines;
using test::RandomWorld;
using ::testing::HasSubstr;

// A log written by random turns, with some snapshots, and the expected graph after each
// turn.
class WrittenLog {
 public:
  WrittenLog(uint32_t seed, int turns, size_t snapshots_kept) : world_(seed) {
    log::SqliteLogOptions options;
    options.snapshots_kept = snapshots_kept;
    auto opened = log::SqliteLog::Open(folder_.path(), options);
    EXPECT_TRUE(opened.ok()) << opened.status();
    log = *std::move(opened);
    expected.push_back({});
    times.push_back(0);
    for (int i = 0; i < turns; ++i) Turn();
  }

  void Turn() {
    WriteBatch batch = world_.Next(stages);
    const TimeMicros time_us = batch.time_us;
    std::string record;
    auto result = RunTurn(&stages, std::move(batch), head + 1, &record);
    if (!result.ok()) return;
    ASSERT_TRUE(log->Append(absl::MakeSpan(&record, 1), 1, head).ok());
    ++head;
    versions.push_back(result->version);
    deltas.push_back(result->delta);
    expected.push_back(Lines(dictionary, *result->version));
    times.push_back(time_us);
    if (head % 40 == 0) Snapshot();
  }
  void Snapshot() {
    auto state = EncodeState(TakeState(stages, RequestMemory(10), versions.back(), times.back()), dictionary);
    ASSERT_TRUE(state.ok()) << state.status();
    ASSERT_TRUE(log->SnapshotPut(head, *state).ok());
  }

  log::TestFolder folder_{log::TestFolder::Where::kMemory};
  RandomWorld world_;
  std::unique_ptr<log::SqliteLog> log;
  Dictionary dictionary;
  sparql::FunctionRegistry functions;
  Stages stages{&dictionary, &functions, Limits()};
  uint64_t head = 0;
  std::vector<GraphVersionPtr> versions;           // of offset i + 1
  std::vector<Delta> deltas;                       // that led to it
  std::vector<std::vector<std::string>> expected;  // by offset
  std::vector<TimeMicros> times;
};

// The past of that log.
struct Past {
  explicit Past(WrittenLog* written, const Limits& limits = {})
      : written(written),
        history(written->log.get(), &queries, &written->dictionary, &written->functions, limits) {
    // in groups of one to four turns, of which the last alone has a version
    for (size_t i = 0, size = 1; i < written->versions.size(); i += size, size = size % 4 + 1) {
      size = std::min(size, written->versions.size() - i);
      std::vector<History::Step> turns;
      for (size_t t = i; t < i + size; ++t) {
        turns.push_back({written->times[t + 1], t == i ? Delta() : written->deltas[t]});
      }
      std::vector<GraphVersionPtr> gone;
      history.Keep(written->versions[i + size - 1], std::move(turns), &gone);
    }
    queries.Publish(written->versions.back());
  }
  absl::StatusOr<QueryGraph> At(const AsOf& when) {
    Cancellation cancellation;
    return history.At(when, &cancellation);
  }
  void ExpectAt(const AsOf& when, uint64_t offset) {
    const absl::StatusOr<QueryGraph> graph = At(when);
    ASSERT_TRUE(graph.ok()) << graph.status();
    EXPECT_EQ(graph->version->revision(), Revision(offset));
    EXPECT_EQ(Lines(*graph->dictionary, *graph->version), written->expected[offset]) << offset;
  }

  WrittenLog* written;
  QueryPort queries;
  History history;
};

class HistoryTest : public ::testing::TestWithParam<uint32_t> {};

TEST_P(HistoryTest, AsOfEqualsAReplayToThatOffset) {
  WrittenLog written(GetParam(), 300, 4);
  ASSERT_FALSE(HasFatalFailure());
  Limits nothing_in_memory;
  nothing_in_memory.history_bytes = 0;
  for (const Limits& limits : {Limits(), nothing_in_memory}) {
    Past past(&written, limits);
    for (int i = 0; i < 25; ++i) {
      const uint64_t offset = written.world_.Below(static_cast<uint32_t>(written.head) + 1);
      past.ExpectAt(Revision(offset), offset);
      past.ExpectAt(AsOf(TimeMicros{written.times[offset]}),
                    static_cast<uint64_t>(
                        std::upper_bound(written.times.begin(), written.times.end(), written.times[offset]) -
                        written.times.begin() - 1));
    }
    past.ExpectAt(AsOf(TimeMicros{0}), 0);
    past.ExpectAt(AsOf(TimeMicros{INT64_MAX}), written.head);
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, HistoryTest, ::testing::Range(1u, 4u));

TEST(HistoryTest, WhatLiesAheadIsRefusedWithTheNewest) {
  WrittenLog written(1, 30, 2);
  Past past(&written);
  const absl::Status status = past.At(Revision(written.head + 1)).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kOutOfRange);
  EXPECT_THAT(std::string(status.message()), HasSubstr(absl::StrCat("the newest is ", written.head)));
}

TEST(HistoryTest, WhatWasTrimmedIsRefusedWithTheOldestThatIsKept) {
  WrittenLog written(2, 200, 2);
  const auto snapshots = written.log->SnapshotOffsets();
  ASSERT_TRUE(snapshots.ok());
  ASSERT_GE(snapshots->size(), 2u);
  const uint64_t oldest = snapshots->front();
  ASSERT_TRUE(written.log->Trim(oldest + 1).ok());
  Limits limits;
  limits.history_bytes = 0;
  Past past(&written, limits);
  for (const AsOf& when : {AsOf(Revision(oldest - 1)), AsOf(Revision(0)), AsOf(TimeMicros{5})}) {
    const absl::Status status = past.At(when).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kOutOfRange);
    EXPECT_THAT(std::string(status.message()),
                HasSubstr(absl::StrCat("the oldest revision that is kept is ", oldest)));
  }
  past.ExpectAt(Revision(oldest), oldest);
  past.ExpectAt(Revision(oldest + 1), oldest + 1);
}

TEST(HistoryTest, MemoryIsBounded) {
  WrittenLog written(3, 250, 2);
  Limits limits;
  limits.history_bytes = 300000;
  Past past(&written, limits);
  EXPECT_LE(past.history.kept_bytes(), limits.history_bytes);
  EXPECT_GT(past.history.kept_versions(), 3u);
  EXPECT_LT(past.history.kept_versions(), written.versions.size());
}

TEST(HistoryTest, ReplaysAndOpenGraphsAreLimited) {
  WrittenLog written(4, 80, 2);
  Limits limits;
  limits.history_bytes = 0;
  limits.as_of_open = 2;
  limits.as_of_records = 20;
  Past past(&written, limits);
  past.ExpectAt(Revision(20), 20);
  absl::Status status = past.At(Revision(21)).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("as_of_records is 20"));
  {
    const auto one = past.At(Revision(5)), two = past.At(Revision(6)), again = past.At(Revision(5));
    ASSERT_TRUE(one.ok() && two.ok() && again.ok());
    EXPECT_EQ(one->version.get(), again->version.get());
    status = past.At(Revision(7)).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
    EXPECT_THAT(std::string(status.message()), HasSubstr("as_of_open is 2"));
    EXPECT_EQ(Lines(*one->dictionary, *one->version), written.expected[5]);
  }
  past.ExpectAt(Revision(7), 7);
}

TEST(HistoryTest, AQueryWhoseClientWentAwayStopsTheReplay) {
  WrittenLog written(5, 60, 2);
  Limits limits;
  limits.history_bytes = 0;
  Past past(&written, limits);
  Cancellation cancellation;
  cancellation.Cancel();
  EXPECT_EQ(past.history.At(Revision(3), &cancellation).status().code(), absl::StatusCode::kCancelled);
  past.ExpectAt(Revision(3), 3);  // and nothing is left behind
}

TEST(ParseAsOfTest, RevisionsAndTimes) {
  EXPECT_EQ(*ParseAsOf("17"), AsOf(Revision(17)));
  EXPECT_EQ(*ParseAsOf("1970-01-01T00:00:01.5Z"), AsOf(TimeMicros{1'500'000}));
  EXPECT_EQ(*ParseAsOf("1970-01-01T01:00:00+01:00"), AsOf(TimeMicros{0}));
  EXPECT_EQ(*ParseAsOf("1970-01-01T00:00:01"), AsOf(TimeMicros{1'000'000}));
  for (const char* text : {"", "yesterday", "-1", "1970-01-01", "99999999999999999999999"}) {
    EXPECT_EQ(ParseAsOf(text).status().code(), absl::StatusCode::kInvalidArgument) << text;
  }
}

// Recovery is a replay, too: from any snapshot, or from none, to the same state.
TEST(RecoveryTest, EverySnapshotLeadsToTheSameEnd) {
  WrittenLog written(6, 250, 100);
  auto snapshots = *written.log->SnapshotOffsets();
  ASSERT_GE(snapshots.size(), 3u);
  while (true) {
    Dictionary dictionary;
    auto start = FindStart(written.log.get(), written.head, &dictionary, &written.functions, {});
    ASSERT_TRUE(start.ok()) << start.status();
    EXPECT_EQ(start->offset, snapshots.empty() ? 0 : snapshots.back());
    const absl::Status replayed =
        ReplayTurns(written.log.get(), start->offset + 1, written.head, start->stages.get(),
                    [](const TurnResult&, size_t) { return absl::OkStatus(); });
    ASSERT_TRUE(replayed.ok()) << replayed;
    EXPECT_EQ(Lines(dictionary, start->stages->writer.current()), written.expected[written.head]);
    if (snapshots.empty()) break;
    // the newest is damaged from now on
    const std::string file = absl::StrFormat("%s/snapshot-%020d", written.folder_.path(), snapshots.back());
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
    snapshots.pop_back();
  }
}

TEST(RecoveryTest, ALogOfAnotherEngineThatDecidedOtherwiseSaysWhatToDo) {
  WrittenLog written(7, 60, 2);
  // the same log, but one record says that an older engine decided something else
  log::TestFolder folder(log::TestFolder::Where::kMemory);
  auto log = log::SqliteLog::Open(folder.path());
  ASSERT_TRUE(log.ok());
  auto entries = written.log->Read(1, 1000);
  ASSERT_TRUE(entries.ok());
  uint64_t changed = 0;
  for (const log::LogEntry& entry : *entries) {
    auto record = log::DecodeTurnRecord(entry.offset, entry.data);
    ASSERT_TRUE(record.ok());
    if (changed == 0 && !record->transitions.empty()) {
      record->engine_version = "0";
      record->transitions[0].to = "elsewhere";
      changed = entry.offset;
    }
    const std::string data = *log::EncodeTurnRecord(*record);
    ASSERT_TRUE((*log)->Append(absl::MakeConstSpan(&data, 1), 1, entry.offset - 1).ok());
  }
  ASSERT_GT(changed, 0u);
  Dictionary dictionary;
  auto start = FindStart(log->get(), written.head, &dictionary, &written.functions, {});
  ASSERT_TRUE(start.ok());
  const absl::Status status = ReplayTurns(log->get(), 1, written.head, start->stages.get(),
                                          [](const TurnResult&, size_t) { return absl::OkStatus(); });
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(status.message()), HasSubstr(absl::StrCat("log offset ", changed)));
  EXPECT_THAT(std::string(status.message()), HasSubstr("end it in order"));
}

}  // namespace
}  // namespace docent::server
