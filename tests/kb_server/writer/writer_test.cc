#include "kb_server/writer/writer.h"

#include <filesystem>
#include <future>
#include <memory>
#include <thread>

#include "absl/synchronization/notification.h"
#include "gmock/gmock.h"
#include "graph/log/record_codec.h"
#include "graph/log/sqlite_log.h"
#include "gtest/gtest.h"
#include "tests/kb_server/scripted_adapter.h"
#include "tests/kb_server/writer_node.h"

namespace docent::server {
namespace {

using test::Fact;
using test::FakeLog;
using test::Named;
using test::Node;
using test::Put;
using test::Story;
using test::Tell;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

// The command of this node, by its name in the graph.
CommandId CommandOf(const std::string& node, const std::vector<std::string>& quads) {
  for (const std::string& quad : quads) {
    const size_t at = quad.find(absl::StrCat("\"", node, "/"));
    if (at != std::string::npos) return CommandId(quad.substr(at + 1, quad.find('"', at + 1) - at - 1));
  }
  return CommandId("none");
}

TEST(WriterTest, NothingIsSeenOrAnsweredBeforeTheAppend) {
  FakeLog log;
  Node node(&log);
  ASSERT_TRUE(node.recovered.ok());
  std::vector<std::future<absl::StatusOr<BatchOutcome>>> answers;
  bool looked = false;
  log.on_append = [&](size_t records) {
    looked = true;
    EXPECT_EQ(records, 5u);
    for (auto& answer : answers)
      EXPECT_EQ(answer.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
    EXPECT_EQ(node.revision(), 0u);
    EXPECT_THAT(node.Events(), IsEmpty());
    EXPECT_THAT(node.catalog.Get()->workflows, IsEmpty());
  };
  for (const WriteBatch& batch : Story()) answers.push_back(node.Push(batch));
  node.inbox.Close();
  EXPECT_TRUE(node.writer->Run().ok());
  EXPECT_TRUE(looked);
  for (uint64_t i = 0; i < answers.size(); ++i) {
    absl::StatusOr<BatchOutcome> outcome = answers[i].get();
    ASSERT_TRUE(outcome.ok()) << outcome.status();
    EXPECT_EQ(outcome->offset, i + 1);
  }
  EXPECT_EQ(node.revision(), 5u);
  EXPECT_EQ(node.catalog.Get()->workflows.size(), 1u);
  EXPECT_THAT(node.Events(), ::testing::Contains("node Greet-1/Hello running"));
  EXPECT_THAT(node.Events(), ::testing::Contains("command Greet-1/Hello sent"));
  EXPECT_EQ(node.writer->counters().commits, 1u);
  EXPECT_EQ(node.writer->counters().turns, 5u);
}

TEST(WriterTest, AnAnswerComesAfterItsVersionIsPublished) {
  FakeLog log;
  Node node(&log);
  uint64_t seen = 0;
  node.inbox.Push(test::WorldFacts(), [&](const absl::StatusOr<BatchOutcome>&) { seen = node.revision(); });
  node.inbox.Close();
  EXPECT_TRUE(node.writer->Run().ok());
  EXPECT_EQ(seen, 1u);
}

TEST(WriterTest, ARefusedAppendRefusesTheWholeGroupAndNothingOfItHappened) {
  FakeLog log;
  Node node(&log);
  node.Begin();
  ASSERT_TRUE(node.Ask(test::WorldFacts()).ok());
  ASSERT_TRUE(node.Ask(Put(Document::Kind::kCawl, "greeting.xml", test::kGreeting)).ok());
  std::vector<std::string> before = node.Quads();
  std::vector<std::string> events = node.Events();

  // while the first append waits, the others gather: the next group
  std::promise<void> go;
  std::shared_future<void> gate = go.get_future().share();
  std::vector<size_t> groups;
  log.on_append = [&](size_t records) {
    gate.wait();
    groups.push_back(records);
  };
  log.refusal = absl::ResourceExhaustedError("the disk is full");
  std::vector<std::future<absl::StatusOr<BatchOutcome>>> answers;
  answers.push_back(node.Push(Named("a", Tell({Fact("John", "docent:isAt", "Hall")}))));
  answers.push_back(node.Push(Named("b", Put(Document::Kind::kRules, "near.rules", test::kRules))));
  answers.push_back(node.Push(Named("c", test::Start("Greeting"))));
  go.set_value();
  for (auto& answer : answers) {
    absl::Status status = answer.get().status();
    EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
    EXPECT_THAT(std::string(status.message()), HasSubstr("the disk is full"));
  }
  // an answered batch of the next group shows that the writer is past the last refused append
  log.on_append = nullptr;
  log.refusal = absl::OkStatus();
  absl::StatusOr<BatchOutcome> start = node.Ask(Named("c", test::Start("Greeting")));
  ASSERT_TRUE(start.ok()) << start.status();
  EXPECT_FALSE(start->repeated);
  EXPECT_EQ(start->offset, 3u);
  EXPECT_THAT(start->started, ElementsAre(RunId("Greet-1")));
  EXPECT_FALSE(node.Knows("<urn:w:John> <https://w3id.org/docent#isAt>"));
  EXPECT_EQ(node.Ask(Named("a", Tell({Fact("John", "docent:isAt", "Hall")})))->inferred, 0u)
      << "the rules were refused";
  EXPECT_TRUE(node.Ask(Named("b", Put(Document::Kind::kRules, "near.rules", test::kRules))).ok());
  EXPECT_TRUE(node.Knows("<urn:w:John> <https://w3id.org/docent#isNear> <urn:w:R1>"));
  EXPECT_TRUE(node.End().ok());
  EXPECT_EQ(log.size(), 5u);

  Node again(&log);
  EXPECT_TRUE(again.recovered.ok()) << again.recovered;
  EXPECT_EQ(again.Quads(), node.Quads());
}

TEST(WriterTest, AfterARefusedAppendTheVersionIsTheOldOne) {
  FakeLog log;
  Node node(&log);
  log.refusal = absl::UnavailableError("input/output error");
  auto outcomes = node.AskTogether(Story());
  for (const auto& outcome : outcomes) EXPECT_EQ(outcome.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_TRUE(node.ended.ok());
  EXPECT_EQ(node.revision(), 0u);
  EXPECT_THAT(node.Quads(), IsEmpty());
  EXPECT_THAT(node.Events(), IsEmpty());
  EXPECT_EQ(node.writer->counters().refused, 5u);
  EXPECT_EQ(node.writer->counters().turns, 0u);
}

TEST(WriterTest, ABatchThatTheLogCannotHoldIsRefusedAlone) {
  FakeLog log;
  Limits limits;
  limits.record_bytes = 2000;
  Node node(&log, false, limits);
  std::vector<TermQuad> many;
  for (int i = 0; i < 200; ++i) many.push_back(Fact("John", "p", absl::StrCat("value-", i)));
  auto outcomes = node.AskTogether({Tell({Fact("a", "b", "c")}), Tell(many), Tell({Fact("d", "e", "f")})});
  ASSERT_TRUE(outcomes[0].ok()) << outcomes[0].status();
  EXPECT_EQ(outcomes[1].status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(outcomes[1].status().message()), HasSubstr("record_bytes is 2000"));
  ASSERT_TRUE(outcomes[2].ok()) << outcomes[2].status();
  EXPECT_EQ(outcomes[2]->offset, 2u);
  EXPECT_EQ(node.writer->counters().commits, 1u);
  EXPECT_FALSE(node.Knows("<urn:w:John>"));

  limits.record_bytes = 1;  // what the log has already is not refused
  Node again(&log, false, limits);
  ASSERT_TRUE(again.recovered.ok()) << again.recovered;
  EXPECT_EQ(again.Quads(), node.Quads());
}

TEST(WriterTest, WhatWentIntoALostLogIsNotAcknowledged) {
  FakeLog log;
  Node node(&log);
  node.Begin();
  ASSERT_TRUE(node.Ask(test::WorldFacts()).ok());
  EXPECT_TRUE(node.writer->LogStatus().ok());
  log.lost_answer = absl::UnavailableError("the data folder is gone");
  log.place = absl::UnavailableError("the data folder is gone");
  const auto refused = node.Ask(Named("a", Tell({Fact("John", "docent:isAt", "Hall")})));
  EXPECT_EQ(refused.status().message(), "the data folder is gone") << "though the log that is lost has it";
  EXPECT_FALSE(node.writer->LogStatus().ok());
  log.lost_answer = absl::OkStatus();
  log.place = absl::OkStatus();
  EXPECT_TRUE(node.Ask(Named("b", Tell({Fact("John", "docent:isAt", "Hall")}))).ok());
}

TEST(WriterTest, TheLogIsAskedAgainThoughNothingIsWritten) {
  FakeLog log;
  Node node(&log);
  node.Begin();
  log.refusal = absl::ResourceExhaustedError("the disk is full");
  ASSERT_FALSE(node.Ask(test::WorldFacts()).ok());
  while (node.writer->LogStatus().ok()) absl::SleepFor(absl::Milliseconds(1));
  node.writer->AskLogAgain();
  absl::SleepFor(absl::Milliseconds(20));
  EXPECT_EQ(node.writer->LogStatus().message(), "the disk is full");
  ASSERT_FALSE(node.Ask(test::WorldFacts()).ok());  // the writer is between two questions to the log
  log.refusal = absl::OkStatus();
  for (int i = 0; i < 6000 && !node.writer->LogStatus().ok(); ++i) {
    node.writer->AskLogAgain();
    absl::SleepFor(absl::Milliseconds(10));
  }
  EXPECT_TRUE(node.writer->LogStatus().ok());
}

TEST(WriterTest, AnAppendWhoseAnswerWasLostIsJudgedByWhatTheLogHas) {
  FakeLog log;
  test::ScriptedAdapter adapter;
  Node node(&log, /*with_robots=*/true);
  node.Begin();
  std::vector<WriteBatch> story = Story();
  story[0].operations.push_back(
      {QuadOperation::Kind::kAdd, Fact("R1", "docent:adapterAddress", Term::Literal(adapter.address()))});
  for (size_t i = 0; i < 4; ++i) ASSERT_TRUE(node.Ask(story[i]).ok());
  log.lost_answer = absl::UnavailableError("input/output error");
  absl::StatusOr<BatchOutcome> outcome = node.Ask(Named("john", story[4]));
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_EQ(outcome->offset, 5u);
  EXPECT_EQ(node.revision(), 5u);
  EXPECT_TRUE(node.Knows("<urn:w:John> <https://w3id.org/docent#isNear> <urn:w:R1>"));
  EXPECT_THAT(node.Events(), ::testing::Contains("node Greet-1/Hello running"));
  adapter.WaitForCommands(1);
  EXPECT_THAT(adapter.commands(), ElementsAre(StartsWith("Greet-1/Hello/0/0.1/1/1@")));
  log.lost_answer = absl::OkStatus();
  EXPECT_TRUE(node.Ask(Named("john", story[4]))->repeated);
  EXPECT_TRUE(node.End().ok());
}

TEST(WriterTest, ARefusedAppendDoesNotDisturbCommandsThatAreUnderWay) {
  FakeLog log;
  absl::Notification done;
  test::ScriptedAdapter adapter([&](const v1::InvokeRequest&) {
    done.WaitForNotificationWithTimeout(absl::Seconds(20));
    v1::Feedback feedback;
    feedback.set_state(v1::Feedback::SUCCEEDED);
    return feedback;
  });
  Node node(&log, /*with_robots=*/true);
  node.Begin();
  TermQuad first = Fact("R1", "docent:adapterAddress", Term::Literal("127.0.0.1:1"));
  TermQuad second = Fact("R1", "docent:adapterAddress", Term::Literal(adapter.address()));
  ASSERT_TRUE(node.Ask(Tell({first})).ok());
  ASSERT_TRUE(node.Ask(Tell({second}, {first})).ok());
  for (const WriteBatch& batch : Story()) ASSERT_TRUE(node.Ask(batch).ok());
  adapter.WaitForCommands(1);
  log.refusal = absl::ResourceExhaustedError("the disk is full");
  EXPECT_FALSE(node.Ask(Tell({Fact("a", "b", "c")})).ok());
  EXPECT_FALSE(node.Ask(Tell({Fact("a", "b", "c")})).ok()) << "the writer is past the first one";
  log.refusal = absl::OkStatus();
  done.Notify();
  ASSERT_TRUE(node.Ask(Tell({Fact("John", "docent:feels", "docent:Glad")})).ok());
  adapter.WaitForCommands(2);
  EXPECT_THAT(adapter.commands(),
              ElementsAre(StartsWith("Greet-1/Hello/0/0.1/1/1@"), StartsWith("Greet-1/Goodbye/0/0.1/1/1@")));
  EXPECT_TRUE(node.End().ok());
}

TEST(WriterTest, AWriterThatWasReplacedStops) {
  FakeLog log;
  log.fenced = true;
  Limits limits;
  limits.turns_per_commit = 1;
  Node node(&log, false, limits);
  auto outcomes = node.AskTogether({test::WorldFacts(), test::Reading("tag-17")});
  EXPECT_EQ(node.ended.code(), absl::StatusCode::kFailedPrecondition);
  for (const auto& outcome : outcomes) {
    EXPECT_EQ(outcome.status().code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_THAT(std::string(outcome.status().message()), HasSubstr("taken over"));
  }
}

TEST(WriterTest, ARepeatedRequestIdGetsTheFirstAnswer) {
  FakeLog log;
  std::vector<WriteBatch> story = Story();
  WriteBatch fact = Named("one", Tell({Fact("John", "p", "q"), Fact("John", "p", "r")}));
  {
    Node node(&log);
    auto outcomes = node.AskTogether(
        {fact, fact, Named("bad", Tell({{Term::Literal("x"), test::Iri("p"), test::Iri("q"), Term()}})),
         Named("bad", Tell({Fact("a", "b", "c")})), story[0]});
    ASSERT_TRUE(outcomes[0].ok());
    EXPECT_FALSE(outcomes[0]->repeated);
    ASSERT_TRUE(outcomes[1].ok());
    EXPECT_TRUE(outcomes[1]->repeated);
    EXPECT_EQ(outcomes[1]->offset, 1u);
    EXPECT_EQ(outcomes[1]->added, 2u);
    EXPECT_EQ(outcomes[2].status().code(), absl::StatusCode::kInvalidArgument);
    ASSERT_TRUE(outcomes[3].ok()) << "its first was refused: it did not use up the id";
    EXPECT_FALSE(outcomes[3]->repeated);
    EXPECT_EQ(outcomes[3]->offset, 2u) << "a batch that was refused leaves no gap";
    EXPECT_EQ(outcomes[4]->offset, 3u);
    EXPECT_EQ(log.size(), 3u);
  }
  Node node(&log);
  node.Begin();
  absl::StatusOr<BatchOutcome> repeat = node.Ask(fact);
  ASSERT_TRUE(repeat.ok());
  EXPECT_TRUE(repeat->repeated);
  EXPECT_EQ(repeat->offset, 1u);
  EXPECT_EQ(repeat->added, 2u);
  ASSERT_TRUE(node.Ask(story[2]).ok());
  absl::StatusOr<BatchOutcome> started = node.Ask(story[3]);
  ASSERT_TRUE(started.ok());
  absl::StatusOr<BatchOutcome> again = node.Ask(story[3]);
  ASSERT_TRUE(again.ok());
  EXPECT_TRUE(again->repeated);
  EXPECT_EQ(again->started, started->started);
  EXPECT_EQ(log.size(), 5u);
  // two batches without an id are two
  EXPECT_FALSE(node.Ask(Tell({Fact("a", "b", "c")}))->repeated);
  EXPECT_FALSE(node.Ask(Tell({Fact("a", "b", "c")}))->repeated);
  EXPECT_EQ(log.size(), 7u);
}

TEST(WriterTest, RecoveryGivesTheStateBeforeAndGoesOn) {
  std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / absl::StrCat("writer_test_", getpid());
  std::filesystem::remove_all(folder);
  std::vector<std::string> quads;
  TimeMicros last_us = 0;
  {
    auto log = log::SqliteLog::Open(folder.string());
    ASSERT_TRUE(log.ok()) << log.status();
    Node node(log->get());
    node.clock.Advance(std::chrono::hours(1));
    last_us = node.clock.Now();
    for (const auto& outcome : node.AskTogether(Story())) ASSERT_TRUE(outcome.ok()) << outcome.status();
    quads = node.Quads();
    EXPECT_EQ(node.writer->counters().live_runs, 1u);
  }
  auto log = log::SqliteLog::Open(folder.string());
  ASSERT_TRUE(log.ok()) << log.status();
  uint64_t done = 0, all = 0;
  Node node(log->get());
  ASSERT_TRUE(node.recovered.ok()) << node.recovered;
  ASSERT_TRUE(node.writer->Recover([&](uint64_t d, uint64_t a) { done = d, all = a; }).ok());
  EXPECT_EQ(done, 5u);
  EXPECT_EQ(all, 5u);
  EXPECT_EQ(node.Quads(), quads);
  EXPECT_EQ(node.revision(), 5u);
  EXPECT_EQ(node.catalog.Get()->workflows.size(), 1u);
  EXPECT_EQ(node.catalog.Get()->modules.size(), 1u);
  EXPECT_EQ(node.writer->counters().live_runs, 1u);
  EXPECT_THAT(node.Events(), IsEmpty()) << "a replay is no news";

  node.Begin();
  absl::StatusOr<BatchOutcome> report =
      node.Ask(test::Report(CommandOf("Greet-1/Hello", quads), CommandReport::Outcome::kSucceeded));
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->offset, 6u);
  EXPECT_THAT(node.Events(), ::testing::Contains("node Greet-1/Goodbye waiting"));
  ASSERT_TRUE(node.End().ok());
  auto entries = (*log)->Read(6, 1);
  ASSERT_TRUE(entries.ok());
  EXPECT_GE(log::DecodeTurnRecord(6, (*entries)[0].data)->time_us, last_us) << "time does not go back";
  std::filesystem::remove_all(folder);
}

TEST(WriterTest, ALogThatWasDecidedOtherwiseIsRefusedWithItsOffset) {
  FakeLog log;
  {
    Node node(&log);
    for (const auto& outcome : node.AskTogether(Story())) ASSERT_TRUE(outcome.ok()) << outcome.status();
  }
  const std::string good = log.record(5);
  auto record = log::DecodeTurnRecord(5, good);
  ASSERT_TRUE(record.ok());
  ASSERT_EQ(record->commands.size(), 1u);
  record->commands[0].operation = "dance";
  log.record(5) = *log::EncodeTurnRecord(*record);
  {
    Node node(&log);
    EXPECT_EQ(node.recovered.code(), absl::StatusCode::kDataLoss);
    EXPECT_THAT(std::string(node.recovered.message()), HasSubstr("log offset 5"));
    EXPECT_THAT(std::string(node.recovered.message()), HasSubstr("dance"));
  }
  log.record(5) = "\x01garbage";
  {
    Node node(&log);
    EXPECT_EQ(node.recovered.code(), absl::StatusCode::kDataLoss);
    EXPECT_THAT(std::string(node.recovered.message()), HasSubstr("5"));
  }
  record = log::DecodeTurnRecord(5, good);
  record->batch.run_requests.push_back({RunRequest::Kind::kStart, "Nobody", {}});
  log.record(5) = *log::EncodeTurnRecord(*record);
  {
    Node node(&log);
    EXPECT_EQ(node.recovered.code(), absl::StatusCode::kDataLoss);
    EXPECT_THAT(std::string(node.recovered.message()), HasSubstr("refused on replay"));
  }
}

TEST(WriterTest, AClockTickIsMadeWhenADeadlineIsDue) {
  FakeLog log;
  Node node(&log);
  node.Begin();
  WriteBatch seen = Tell({Fact("John", "docent:isAt", "Hall")});
  seen.lifetime_ms = 5;
  ASSERT_TRUE(node.Ask(seen).ok());
  node.clock.Advance(std::chrono::seconds(1));
  ASSERT_TRUE(node.queries.WaitForRevision(Revision(2), absl::Now() + absl::Seconds(20)).ok());
  EXPECT_FALSE(node.Knows("<urn:w:John>"));
}

TEST(WriterTest, CommandsGoOutAfterTheAppendOnly) {
  FakeLog log;
  std::atomic<bool> early = false;
  test::ScriptedAdapter adapter([&](const v1::InvokeRequest& request) {
    if (log.size() < request.guard_revision()) early = true;
    v1::Feedback feedback;
    feedback.set_state(v1::Feedback::SUCCEEDED);
    return feedback;
  });
  Node node(&log, /*with_robots=*/true);
  node.Begin();
  std::vector<WriteBatch> story = Story();
  story[0].operations.push_back(
      {QuadOperation::Kind::kAdd, Fact("R1", "docent:adapterAddress", Term::Literal(adapter.address()))});
  for (size_t i = 0; i < 4; ++i) ASSERT_TRUE(node.Ask(story[i]).ok());

  // refused: never sent
  log.refusal = absl::ResourceExhaustedError("the disk is full");
  EXPECT_FALSE(node.Ask(story[4]).ok());
  EXPECT_EQ(node.Ask(story[4]).status().code(), absl::StatusCode::kResourceExhausted);
  log.refusal = absl::OkStatus();
  // a slow disk: a command that did not wait would be there before it
  log.on_append = [](size_t) { std::this_thread::sleep_for(std::chrono::milliseconds(50)); };
  ASSERT_TRUE(node.Ask(story[4]).ok());
  adapter.WaitForCommands(1);
  ASSERT_TRUE(node.Ask(Tell({Fact("John", "docent:feels", "docent:Glad")})).ok());
  adapter.WaitForCommands(2);
  EXPECT_THAT(adapter.commands(),
              ElementsAre(StartsWith("Greet-1/Hello/0/0.1/1/1@"), StartsWith("Greet-1/Goodbye/0/0.1/1/1@")));
  EXPECT_FALSE(early);
  EXPECT_TRUE(node.End().ok());
}

TEST(WriterTest, CommandsThatWereOpenAreAskedForAfterARestart) {
  FakeLog log;
  std::vector<WriteBatch> story = Story();
  {
    Node node(&log);
    for (const auto& outcome : node.AskTogether(story)) ASSERT_TRUE(outcome.ok()) << outcome.status();
  }
  test::ScriptedAdapter adapter;  // began nothing: the command comes once more, with its id
  Node node(&log, /*with_robots=*/true);
  ASSERT_TRUE(node.recovered.ok());
  node.writer->ResumeCommands();
  node.Begin();
  ASSERT_TRUE(node.Ask(Tell({Fact("R1", "docent:adapterAddress", Term::Literal(adapter.address()))})).ok());
  adapter.WaitForCommands(1);
  EXPECT_THAT(adapter.commands(), ElementsAre(StartsWith("Greet-1/Hello/0/0.1/1/1@")));
  EXPECT_TRUE(node.End().ok());
}

}  // namespace
}  // namespace docent::server
