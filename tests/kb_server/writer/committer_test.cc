// Turns that are decided while earlier turns are being made durable.
#include "kb_server/writer/committer.h"

#include <future>
#include <optional>
#include <random>
#include <set>
#include <thread>

#include "absl/synchronization/notification.h"
#include "gmock/gmock.h"
#include "graph/log/record_codec.h"
#include "gtest/gtest.h"
#include "tests/kb_server/writer_node.h"

namespace docent::server {
namespace {

using test::Fact;
using test::FakeLog;
using test::Named;
using test::Node;
using test::Put;
using test::Tell;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Answer = std::future<absl::StatusOr<BatchOutcome>>;

bool Answered(const Answer& answer) {
  return answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

// Appends wait for it while it is shut.
class Gate {
 public:
  explicit Gate(FakeLog* log) {
    log->on_append = [this](size_t records) {
      absl::MutexLock lock(&mutex_);
      sizes_.push_back(records);
      mutex_.Await(absl::Condition(&open_));
    };
  }
  // Waits until this many appends have begun.
  void WaitForAppends(size_t count) {
    absl::MutexLock lock(&mutex_);
    const auto begun = [this, count]()
                           ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return sizes_.size() >= count; };
    mutex_.Await(absl::Condition(&begun));
  }
  void Open() {
    absl::MutexLock lock(&mutex_);
    open_ = true;
  }
  std::vector<size_t> sizes() {
    absl::MutexLock lock(&mutex_);
    return sizes_;
  }

 private:
  absl::Mutex mutex_;
  bool open_ = false;
  std::vector<size_t> sizes_;
};

// A world with turns in flight behind a shut gate: the first is being appended, the others wait.
class InFlight {
 public:
  explicit InFlight(const std::vector<WriteBatch>& batches) : node(&log) {
    node.Begin();
    EXPECT_TRUE(node.Ask(test::WorldFacts()).ok());
    EXPECT_TRUE(node.Ask(Put(Document::Kind::kCawl, "greeting.xml", test::kGreeting)).ok());
    gate.emplace(&log);
    answers.push_back(node.Push(batches[0]));
    gate->WaitForAppends(1);
    for (size_t i = 1; i < batches.size(); ++i) answers.push_back(node.Push(batches[i]));
    Look();
    Look();  // taken after the group of the first: all those before it have been handed over
  }
  ~InFlight() { EXPECT_TRUE(node.End().ok()); }

  // Waits until the writer has decided all turns pushed so far.
  void Look() {
    absl::Notification looked;
    node.inbox.Visit(
        [&](Stages*, Revision revision) {
          decided = revision.value();
          looked.Notify();
        },
        [](const absl::Status&) {});
    looked.WaitForNotification();
  }

  FakeLog log;
  Node node;
  std::optional<Gate> gate;
  std::vector<Answer> answers;
  uint64_t decided = 0;  // offset of the newest turn when it was looked
};

TEST(CommitterTest, TheNextTurnsAreDecidedDuringAnAppendAndNothingOfThemIsSeen) {
  InFlight flight({Put(Document::Kind::kRules, "near.rules", test::kRules), test::Start("Greeting"),
                   test::Reading("tag-17")});
  Node& node = flight.node;
  EXPECT_EQ(flight.decided, 5u);
  EXPECT_EQ(node.revision(), 2u);
  EXPECT_EQ(flight.log.size(), 2u);
  EXPECT_THAT(node.Events(), IsEmpty());
  EXPECT_THAT(node.catalog.Get()->modules, IsEmpty());
  for (const Answer& answer : flight.answers) EXPECT_FALSE(Answered(answer));
  flight.gate->Open();
  for (size_t i = 0; i < flight.answers.size(); ++i) {
    absl::StatusOr<BatchOutcome> outcome = flight.answers[i].get();
    ASSERT_TRUE(outcome.ok()) << outcome.status();
    EXPECT_EQ(outcome->offset, i + 3);
    EXPECT_GE(node.revision(), outcome->offset);
  }
  EXPECT_THAT(flight.gate->sizes(), ElementsAre(1, 2)) << "what waited shared an append";
  EXPECT_THAT(node.Events(), ::testing::Contains("node Greet-1/Hello running"));
  EXPECT_EQ(node.catalog.Get()->modules.size(), 1u);
}

TEST(CommitterTest, GroupsInFlightAreRefusedTogetherAndNothingOfThemHappened) {
  const std::vector<WriteBatch> batches = {
      Named("a", Tell({Fact("John", "docent:isAt", "Hall")})),
      Named("b", Put(Document::Kind::kRules, "near.rules", test::kRules)),
      Named("c", test::Start("Greeting"))};
  InFlight flight(batches);
  Node& node = flight.node;
  const std::vector<std::string> before = node.Quads();
  EXPECT_EQ(flight.decided, 5u);
  flight.log.refusal = absl::ResourceExhaustedError("the disk is full");
  flight.log.once = true;
  flight.gate->Open();
  for (Answer& answer : flight.answers) {
    const absl::Status status = answer.get().status();
    EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
    EXPECT_THAT(std::string(status.message()), HasSubstr("the disk is full"));
  }
  EXPECT_THAT(flight.gate->sizes(), ElementsAre(1)) << "what supposes a refused turn is not appended";
  EXPECT_EQ(node.writer->counters().refused, 3u);
  EXPECT_EQ(flight.log.size(), 2u);
  EXPECT_EQ(node.revision(), 2u);
  EXPECT_EQ(node.Quads(), before);
  EXPECT_THAT(node.Events(), IsEmpty());

  for (size_t i = 0; i < batches.size(); ++i) {
    absl::StatusOr<BatchOutcome> again = node.Ask(batches[i]);
    ASSERT_TRUE(again.ok()) << again.status();
    EXPECT_FALSE(again->repeated);
    EXPECT_EQ(again->offset, i + 3);
  }
  Node restarted(&flight.log);
  ASSERT_TRUE(restarted.recovered.ok()) << restarted.recovered;
  EXPECT_EQ(restarted.Quads(), node.Quads());
}

TEST(CommitterTest, WhereAnAnswerIsLostTheLogSaysWhichOfTheGroupsInFlightHappened) {
  InFlight flight({Named("a", test::Start("Greeting")), Named("b", test::Reading("tag-17"))});
  Node& node = flight.node;
  flight.log.lost_answer = absl::UnavailableError("input/output error");
  flight.log.once = true;
  flight.gate->Open();
  absl::StatusOr<BatchOutcome> first = flight.answers[0].get();
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ(first->offset, 3u);
  EXPECT_THAT(first->started, ElementsAre(RunId("Greet-1")));
  EXPECT_EQ(flight.answers[1].get().status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(flight.log.size(), 3u);
  EXPECT_EQ(node.revision(), 3u);
  EXPECT_THAT(node.Events(), ::testing::Contains(HasSubstr("run Greet-1/")));
  EXPECT_TRUE(node.Ask(Named("a", test::Start("Greeting")))->repeated);
  absl::StatusOr<BatchOutcome> second = node.Ask(Named("b", test::Reading("tag-17")));
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_FALSE(second->repeated);
  EXPECT_EQ(second->offset, 4u);
}

// A rule explosion is noticed after the turn has changed the graph: the changes of earlier turns of the group
// stay.
TEST(CommitterTest, ATurnThatFailsLateTakesBackItsOwnChangesAlone) {
  FakeLog log;
  Limits limits;
  limits.inferred_per_turn = 5;
  Node node(&log, false, limits);
  std::vector<TermQuad> many;
  for (int i = 0; i < 20; ++i) many.push_back(Fact(absl::StrCat("b", i), "p", "q"));
  auto outcomes = node.AskTogether(
      {Put(Document::Kind::kRules, "r.rules", "RULE { ?s <urn:w:r> ?o } WHERE { ?s <urn:w:p> ?o }"),
       Tell({Fact("a", "p", "q")}), Tell(many), Tell({Fact("c", "p", "q")}, {Fact("a", "p", "q")})});
  ASSERT_TRUE(outcomes[0].ok()) << outcomes[0].status();
  EXPECT_TRUE(outcomes[1].ok()) << outcomes[1].status();
  EXPECT_EQ(outcomes[2].status().code(), absl::StatusCode::kResourceExhausted) << outcomes[2].status();
  EXPECT_TRUE(outcomes[3].ok()) << outcomes[3].status();
  EXPECT_EQ(node.writer->counters().commits, 1u);
  EXPECT_EQ(node.Quads().size(), 2u) << "told and inferred";
  EXPECT_TRUE(node.Knows("<urn:w:c> <urn:w:r> <urn:w:q>"));
  Node restarted(&log, false, limits);
  ASSERT_TRUE(restarted.recovered.ok()) << restarted.recovered;
  EXPECT_EQ(restarted.Quads(), node.Quads());
}

TEST(CommitterTest, ARepeatIsAnsweredWhenItsFirstIsDurable) {
  const WriteBatch batch = Named("x", Tell({Fact("John", "p", "q")}));
  {
    InFlight flight({batch, batch});
    EXPECT_EQ(flight.decided, 3u);
    EXPECT_FALSE(Answered(flight.answers[1]));
    flight.gate->Open();
    EXPECT_FALSE(flight.answers[0].get()->repeated);
    absl::StatusOr<BatchOutcome> repeat = flight.answers[1].get();
    ASSERT_TRUE(repeat.ok()) << repeat.status();
    EXPECT_TRUE(repeat->repeated);
    EXPECT_EQ(repeat->offset, 3u);
    EXPECT_EQ(repeat->added, 1u);
    EXPECT_EQ(flight.log.size(), 3u);
  }
  InFlight flight({batch, batch});
  flight.log.refusal = absl::ResourceExhaustedError("the disk is full");
  flight.log.once = true;
  flight.gate->Open();
  for (Answer& answer : flight.answers) {
    EXPECT_EQ(answer.get().status().code(), absl::StatusCode::kResourceExhausted);
  }
  EXPECT_FALSE(flight.node.Ask(batch)->repeated);
  EXPECT_EQ(flight.log.size(), 3u);
}

TEST(CommitterTest, ARefusalThatSupposesTurnsInFlightIsToldAfterThem) {
  const std::vector<WriteBatch> batches = {
      Tell({Fact("John", "p", "q")}),
      Tell({{Term::Literal("John"), test::Iri("p"), test::Iri("q"), Term()}})};
  {
    InFlight flight(batches);
    EXPECT_FALSE(Answered(flight.answers[1]));
    flight.gate->Open();
    EXPECT_TRUE(flight.answers[0].get().ok());
    EXPECT_EQ(flight.answers[1].get().status().code(), absl::StatusCode::kInvalidArgument);
  }
  InFlight flight(batches);
  flight.log.refusal = absl::UnavailableError("input/output error");
  flight.log.once = true;
  flight.gate->Open();
  for (Answer& answer : flight.answers)
    EXPECT_EQ(answer.get().status().code(), absl::StatusCode::kUnavailable);
}

TEST(CommitterTest, AVisitIsAnsweredWhenWhatItSawIsDurable) {
  const std::vector<WriteBatch> batches = {Tell({Fact("John", "p", "q")})};
  const auto visit = [](InFlight* flight, uint64_t* seen) {
    auto answer = std::make_shared<std::promise<absl::Status>>();
    flight->node.inbox.Visit([seen](Stages*, Revision revision) { *seen = revision.value(); },
                             [answer](const absl::Status& status) { answer->set_value(status); });
    flight->Look();
    return answer->get_future();
  };
  uint64_t seen = 0;
  {
    InFlight flight(batches);
    std::future<absl::Status> answer = visit(&flight, &seen);
    EXPECT_EQ(seen, 3u);
    EXPECT_EQ(answer.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
    flight.gate->Open();
    EXPECT_TRUE(answer.get().ok());
    EXPECT_EQ(flight.log.size(), 3u);  // it left no record
  }
  InFlight flight(batches);
  std::future<absl::Status> answer = visit(&flight, &seen);
  flight.log.refusal = absl::ResourceExhaustedError("the disk is full");
  flight.log.once = true;
  flight.gate->Open();
  EXPECT_EQ(answer.get().code(), absl::StatusCode::kResourceExhausted);
}

// Clients assert facts at the same time, while the log refuses some appends and loses the answers of others.
TEST(CommitterTest, WhatIsAcknowledgedIsInTheLogAndWhatIsRefusedIsNot) {
  constexpr int kClients = 4, kFacts = 300;
  FakeLog log;
  log.once = true;
  std::mt19937 random(7);
  log.on_append = [&](size_t) {
    const auto dice = random() % 8;
    if (dice == 0) log.refusal = absl::ResourceExhaustedError("the disk is full");
    if (dice == 1) log.lost_answer = absl::UnavailableError("input/output error");
  };
  Limits limits;
  limits.turns_per_commit = 5;
  Node node(&log, false, limits);
  node.Begin();
  std::vector<std::vector<std::pair<std::string, bool>>> told(kClients);
  std::vector<std::thread> clients;
  for (int c = 0; c < kClients; ++c) {
    clients.emplace_back([&node, &told, c] {
      std::vector<std::pair<std::string, Answer>> open;
      for (int i = 0; i < kFacts; ++i) {
        const std::string id = absl::StrCat("c", c, "-", i);
        open.emplace_back(id, node.Push(Named(id, Tell({Fact(id, "p", Term::Integer(i % 7))}))));
        if (open.size() < 16 && i + 1 < kFacts) continue;
        for (auto& [name, answer] : open) told[c].emplace_back(name, answer.get().ok());
        open.clear();
      }
    });
  }
  for (std::thread& client : clients) client.join();
  ASSERT_TRUE(node.End().ok());
  std::set<std::string> logged;
  const auto entries = log.Read(1, SIZE_MAX);
  ASSERT_TRUE(entries.ok());
  for (const log::LogEntry& entry : *entries)
    logged.insert(log::DecodeTurnRecord(entry.offset, entry.data)->batch.request_id);
  size_t acknowledged = 0;
  for (const auto& client : told) {
    for (const auto& [id, ok] : client) {
      EXPECT_EQ(ok, logged.contains(id)) << id;
      acknowledged += ok ? 1 : 0;
    }
  }
  EXPECT_EQ(acknowledged, logged.size());
  EXPECT_GT(acknowledged, 0u);
  EXPECT_LT(acknowledged, static_cast<size_t>(kClients * kFacts)) << "nothing was refused";
  EXPECT_EQ(node.revision(), logged.size());
  EXPECT_EQ(node.Quads().size(), logged.size());
  Node restarted(&log);
  ASSERT_TRUE(restarted.recovered.ok()) << restarted.recovered;
  EXPECT_EQ(restarted.Quads(), node.Quads());
}

}  // namespace
}  // namespace docent::server
