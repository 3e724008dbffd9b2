// Robots that are kept for a run, a workflow or none: who gets them, when it ends, and what is told of it.
#include <algorithm>
#include <memory>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/docent_iris.h"
#include "graph/store/graph_reader.h"
#include "gtest/gtest.h"
#include "kb_server/door/workflow_removal.h"
#include "kb_server/robots/reservations.h"
#include "kb_server/robots/robot_records.h"
#include "kb_server/turn/turn.h"
#include "kb_server/writer/server_state.h"
#include "tests/kb_server/test_world.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;

class RobotReservationTest : public testing::Test {
 protected:
  RobotReservationTest() {
    stages_ = std::make_unique<Stages>(&dictionary_, &functions_, Limits());
    Turn(Tell(test::FreeRobots({"R1", "R2"}, "drive")));
  }

  TurnResult Turn(WriteBatch batch) {
    batch.time_us = now_us_ += 1'000'000;
    auto result = RunTurn(stages_.get(), std::move(batch), ++head_);
    EXPECT_TRUE(result.ok()) << result.status();
    return result.ok() ? *std::move(result) : TurnResult();
  }
  TurnResult After(TimeMicros seconds) {
    now_us_ += seconds * 1'000'000;
    WriteBatch tick;
    tick.clock_tick = true;
    return Turn(std::move(tick));
  }
  // A workflow NAME whose nodes A, B, … stand one after the other.
  void Deploy(const std::string& name, const std::vector<std::string>& nodes, const std::string& flow = "") {
    std::string text =
        absl::StrCat("<CAWL name=\"", name,
                     "\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\" xmlns:w=\"urn:w:\"><flow name=\"",
                     name, "\" ", flow, "><variable name=\"robot\"/><source name=\"s\"/>");
    std::string links, last = "s";
    for (size_t i = 0; i < nodes.size(); ++i) {
      const std::string node(1, static_cast<char>('A' + i));
      absl::StrAppend(&text, "<node name=\"", node, "\">", nodes[i], "</node>");
      absl::StrAppend(&links, "<link from=\"", last, "\" to=\"", node, "\"/>");
      last = node;
    }
    absl::StrAppend(&links, "<link from=\"", last, "\" to=\"e\"/>");
    Turn(Put(Document::Kind::kCawl, name + ".xml", text + "<sink name=\"e\"/>" + links + "</flow></CAWL>"));
  }
  static constexpr char kDrive[] = "<invoke operation=\"drive\"/>";
  // A node that opens when w:go is told of `who`.
  static std::string WhenTold(const std::string& who, const std::string& inside) {
    return absl::StrCat(
        "<condition><context name=\"c\"><rule><constraint><subject>w:", who,
        "</subject><verb>w:is</verb><object>w:Go</object></constraint></rule></context></condition>", inside);
  }
  TurnResult Go(const std::string& who) { return Turn(Tell({Fact(who, "is", "Go")})); }
  TurnResult Start(const std::string& name, const std::string& robot = "") {
    std::vector<std::pair<std::string, Term>> arguments;
    if (!robot.empty()) arguments.emplace_back("robot", test::Iri(robot));
    return Turn(test::Start(name, std::move(arguments)));
  }
  absl::StatusOr<engine::Reservation> Reserve(ReservationRequest request) {
    for (std::string& robot : request.robots) robot = test::Name(robot);
    if (absl::Status valid = CheckReservation(request); !valid.ok()) return valid;
    WriteBatch batch;
    engine::Reservation made;
    const GraphVersionPtr version = stages_->writer.Freeze(Revision(head_));
    const absl::Status status =
        MakeReservation(request, dictionary_, *version, now_us_ + 1'000'000, &batch, &made);
    if (!status.ok()) return status;
    last_ = Turn(std::move(batch));
    return made;
  }
  static std::string Commands(const TurnResult& turn) {
    std::string text;
    for (const RobotCommand& command : turn.record.commands)
      absl::StrAppend(&text, text.empty() ? "" : ", ",
                      command.id.value().substr(0, command.id.value().find('/')), " ", command.robot.value());
    return text;
  }
  TurnResult Done(const TurnResult& turn) {
    return Turn(test::Report(turn.record.commands.at(0).id, CommandReport::Outcome::kSucceeded));
  }
  std::string Told(const std::string& iri, const std::string& local) {
    const GraphVersionPtr version = stages_->writer.Freeze(Revision(head_));
    return GraphReader(dictionary_, *version).Object(iri, DocentIri(local));
  }
  std::vector<engine::Reservation> Reservations() {
    const GraphVersionPtr version = stages_->writer.Freeze(Revision(head_));
    return ReadReservations(dictionary_, *version);
  }

  void Restart() {
    const auto bytes = EncodeState(
        TakeState(*stages_, requests_, stages_->writer.Freeze(Revision(head_)), now_us_), dictionary_);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    auto state = DecodeState(*bytes, &dictionary_, &functions_, Limits());
    ASSERT_TRUE(state.ok()) << state.status();
    stages_ = std::move(state->stages);
  }

  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  std::unique_ptr<Stages> stages_;
  RequestMemory requests_{10};
  uint64_t head_ = 0;
  TimeMicros now_us_ = 1'700'000'000'000'000;
  TurnResult last_;
};

TEST_F(RobotReservationTest, AnotherRunDoesNotGetTheRobotUntilTheTimeIsOver) {
  Deploy("W", {kDrive});
  const auto made = Reserve({{"R1"}, "", 0, 60'000, "a visit"});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(Commands(Start("W")), "W-1 urn:w:R2");
  EXPECT_EQ(Commands(Start("W", "R1")), "");
  EXPECT_EQ(Told("urn:docent:run:W-2/A/0", "reason"),
            absl::StrCat("<urn:w:R1> is reserved until ", Told(made->iri, "reservedUntil"),
                         ", with priority 0 (a visit)"));
  EXPECT_EQ(Commands(After(50)), "");
  EXPECT_EQ(Commands(After(20)), "W-2 urn:w:R1");
  EXPECT_TRUE(Reservations().empty());
}

TEST_F(RobotReservationTest, AReleaseFreesIt) {
  Deploy("W", {kDrive});
  const auto made = Reserve({{"R1"}, "", 0, 60'000, ""});
  EXPECT_EQ(Commands(Start("W", "R1")), "");
  WriteBatch batch;
  ASSERT_TRUE(
      ReleaseReservation(made->iri, dictionary_, *stages_->writer.Freeze(Revision(head_)), &batch).ok());
  EXPECT_EQ(Commands(Turn(std::move(batch))), "W-1 urn:w:R1");
  WriteBatch again;
  EXPECT_EQ(
      ReleaseReservation(made->iri, dictionary_, *stages_->writer.Freeze(Revision(head_)), &again).code(),
      absl::StatusCode::kNotFound);
}

TEST_F(RobotReservationTest, OnlyRunsOfAHigherPriorityTakeIt) {
  Deploy("Equal", {kDrive}, "ext:priority=\"5\"");
  Deploy("Higher", {kDrive}, "ext:priority=\"6\"");
  ASSERT_TRUE(Reserve({{"R1"}, "", 5, 60'000, ""}).ok());
  EXPECT_EQ(Commands(Start("Equal", "R1")), "");
  const TurnResult turn = Start("Higher", "R1");
  EXPECT_EQ(Commands(turn), "Higher-2 urn:w:R1");
  EXPECT_EQ(Commands(Done(turn)), "") << "it is kept again";
}

TEST_F(RobotReservationTest, RunsOfTheWorkflowGetIt) {
  Deploy("Tour", {kDrive});
  Deploy("W", {kDrive});
  ASSERT_TRUE(Reserve({{"R1", "R2"}, "Tour", 0, 0, ""}).ok());
  EXPECT_EQ(Commands(Start("W")), "");
  EXPECT_EQ(Commands(Start("Tour")), "Tour-2 urn:w:R1");
}

TEST_F(RobotReservationTest, AReservationEndsWithTheRunThatItIsFor) {
  Deploy("Tour", {WhenTold("Tour", kDrive)});
  Deploy("W", {kDrive});
  Start("Tour");
  ASSERT_TRUE(Reserve({{"R1"}, "Tour-1", 0, 0, ""}).ok());
  EXPECT_EQ(Commands(Start("W", "R1")), "");
  EXPECT_TRUE(absl::StrContains(Told("urn:docent:run:W-2/A/0", "reason"),
                                "is reserved for run Tour-1, with priority 0"));
  const TurnResult tour = Go("Tour");
  EXPECT_EQ(Commands(tour), "Tour-1 urn:w:R2") << "nothing waits for this one";
  EXPECT_EQ(Commands(Done(tour)), "W-2 urn:w:R1");
  EXPECT_TRUE(Reservations().empty());
}

// What each of them waits for was said when it was looked at last: the older one came before the reservation.
TEST_F(RobotReservationTest, WhenAReservationEndsTheOldestGetsTheRobotAlsoAfterARestart) {
  Deploy("W", {kDrive});
  for (const bool restarts : {false, true}) {
    const TurnResult tour = Start("W", "R1");
    const std::string run = tour.record.commands.at(0).id.value();
    Start("W", "R1");
    const std::string older = absl::StrCat("W-", restarts ? 5 : 2);
    ASSERT_TRUE(Reserve({{"R1"}, run.substr(0, run.find('/')), 0, 0, ""}).ok());
    Start("W", "R1");
    if (restarts) Restart();
    const TurnResult freed = Done(tour);
    EXPECT_EQ(Commands(freed), older + " urn:w:R1");
    Done(Done(freed));
  }
}

// A run that ceased to be kept from a robot is looked at as one that never was.
TEST_F(RobotReservationTest, WhoWaitsIsTheSameAfterARestart) {
  const auto play = [this](bool restarts) {
    stages_ = std::make_unique<Stages>(&dictionary_, &functions_, Limits());
    Turn(Tell(test::FreeRobots({"R1", "R2"}, "drive")));
    Deploy("W", {kDrive});
    const TurnResult first = Start("W", "R1");
    const auto made = Reserve({{"R1"}, "", 0, 600'000, ""});
    Start("W", "R1");
    WriteBatch release;
    EXPECT_TRUE(
        ReleaseReservation(made->iri, dictionary_, *stages_->writer.Freeze(Revision(head_)), &release).ok());
    Turn(std::move(release));
    Start("W", "R1");
    if (restarts) Restart();
    return Commands(Done(first));
  };
  EXPECT_EQ(play(false), "W-2 urn:w:R1");
  EXPECT_EQ(play(true), "W-2 urn:w:R1");
}

TEST_F(RobotReservationTest, AReservationForAWorkflowEndsWhenItIsUndeployed) {
  const auto undeploy = [this](const char* how) {
    WriteBatch batch;
    batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, "Tour", how});
    Turn(std::move(batch));
  };
  for (const bool cancels : {false, true}) {
    Deploy("Tour", {WhenTold(cancels ? "a" : "b", kDrive)});
    ASSERT_TRUE(Reserve({{"R1"}, "Tour", 5, 600'000, ""}).ok());
    Start("Tour");
    undeploy(cancels ? kRemovesRuns : "");
    EXPECT_EQ(Reservations().size(), cancels ? 0u : 1u) << "a live run of it may need the robot";
    if (!cancels) Done(Go("b"));
    EXPECT_TRUE(Reservations().empty());
  }
  Deploy("Tour", {kDrive});
  ASSERT_TRUE(Reserve({{"R1"}, "Tour", 5, 600'000, ""}).ok());
  Deploy("Tour", {kDrive});
  EXPECT_EQ(Reservations().size(), 1u) << "it is loaded again";
  undeploy("");
  EXPECT_TRUE(Reservations().empty());
}

TEST_F(RobotReservationTest, ARunReservesAheadOfNeed) {
  Deploy("Tour",
         {"<ext:reserve robots=\"w:R1 w:R2\" lasting=\"10min\" priority=\"3\"/>", WhenTold("Tour", kDrive)});
  Deploy("W", {kDrive}, "ext:priority=\"3\"");
  Start("Tour");
  const std::vector<engine::Reservation> made = Reservations();
  ASSERT_EQ(made.size(), 1u);
  EXPECT_EQ(made[0].kept_for, "urn:docent:run:Tour-1");
  EXPECT_EQ(made[0].priority, 3);
  EXPECT_EQ(made[0].robots.size(), 2u);
  EXPECT_EQ(made[0].until_us - made[0].since_us, 600'000'000);
  EXPECT_EQ(Commands(Start("W")), "");
  const TurnResult tour = Go("Tour");
  EXPECT_EQ(Commands(tour), "Tour-1 urn:w:R1");
  EXPECT_EQ(Commands(Done(tour)), "W-2 urn:w:R2")
      << "the robots are free with the end of the run, and this one was not used";
}

TEST_F(RobotReservationTest, ARunReleasesWhatItReserved) {
  Deploy("Tour", {"<ext:reserve robots=\"w:R1\"/>", WhenTold("Tour", "<ext:release/>"), WhenTold("End", "")});
  Deploy("W", {kDrive});
  Start("Tour");
  EXPECT_EQ(Commands(Start("W", "R1")), "");
  EXPECT_EQ(Commands(Go("Tour")), "W-2 urn:w:R1");
}

TEST_F(RobotReservationTest, WhatIsReservedInTheSameTurnIsReleasedToo) {
  Deploy("Tour", {"<ext:reserve robots=\"w:R1\"/>", WhenTold("Tour", "<ext:reserve robots=\"w:R2\"/>"),
                  "<ext:release/>", "<ext:reserve robots=\"w:R1\"/>", WhenTold("End", "<ext:release/>"),
                  WhenTold("End", "<ext:reserve robots=\"w:R2\"/>"), WhenTold("Never", "")});
  Start("Tour");
  ASSERT_EQ(Reservations().size(), 1u);
  Go("Tour");
  ASSERT_EQ(Reservations().size(), 1u);
  EXPECT_EQ(Reservations()[0].robots, std::set<RobotId>{RobotId("urn:w:R1")});
  Go("End");
  ASSERT_EQ(Reservations().size(), 1u);
  EXPECT_EQ(Reservations()[0].robots, std::set<RobotId>{RobotId("urn:w:R2")});
}

TEST_F(RobotReservationTest, WhatIsNoRobotCannotBeReserved) {
  Deploy("Tour", {"<ext:reserve robots=\"w:R1 w:Chair\"/>"});
  Start("Tour");
  EXPECT_EQ(Told("urn:docent:run:Tour-1", "runState"), "failed");
  EXPECT_TRUE(absl::StrContains(Told("urn:docent:run:Tour-1", "reason"),
                                "it cannot reserve <urn:w:Chair>: it is no robot"));
  EXPECT_TRUE(Reservations().empty()) << "all of them, or none";
}

TEST_F(RobotReservationTest, RunsThatReserveTwoRobotsInOppositeOrderDoNotWaitForEachOther) {
  // Each reserves one, then both, and then takes both.
  for (const auto& [name, first, second] :
       {std::tuple{"X", "w:R1", "w:R2"}, std::tuple{"Y", "w:R2", "w:R1"}}) {
    Deploy(
        name,
        {absl::StrCat("<ext:reserve robots=\"", first, "\"/>"),
         WhenTold(name, absl::StrCat("<ext:reserve robots=\"", second, " ", first, "\"/>")),
         absl::StrCat("<ext:assign variable=\"robot\">SELECT (", first, " AS ?r) {}</ext:assign>", kDrive),
         absl::StrCat("<ext:assign variable=\"robot\">SELECT (", second, " AS ?r) {}</ext:assign>", kDrive)});
  }
  Start("X");
  Start("Y");
  std::vector<RobotCommand> open;
  for (const TurnResult& turn : {Go("X"), Go("Y")})
    open.insert(open.end(), turn.record.commands.begin(), turn.record.commands.end());
  size_t commands = 0;
  while (!open.empty() && commands < 10) {
    const RobotCommand command = open.back();
    open.pop_back();
    ++commands;
    const TurnResult turn = Turn(test::Report(command.id, CommandReport::Outcome::kSucceeded));
    open.insert(open.end(), turn.record.commands.begin(), turn.record.commands.end());
  }
  EXPECT_EQ(commands, 4u) << "each run drives both";
  EXPECT_EQ(Told("urn:docent:run:X-1", "runState"), "done");
  EXPECT_EQ(Told("urn:docent:run:Y-2", "runState"), "done");
}

TEST_F(RobotReservationTest, ARunThatHoldsARobotOfAReservationIsNotKeptFromTheOthers) {
  Deploy("W",
         {"<ext:assign variable=\"robot\">SELECT (w:R1 AS ?r) {}</ext:assign><invoke operation=\"drive\"/>",
          "<ext:assign variable=\"robot\">SELECT (w:R2 AS ?r) {}</ext:assign><invoke operation=\"drive\"/>"});
  const TurnResult turn = Start("W");
  EXPECT_EQ(Commands(turn), "W-1 urn:w:R1");
  ASSERT_TRUE(Reserve({{"R1", "R2"}, "", 9, 60'000, ""}).ok());
  EXPECT_EQ(Commands(Done(turn)), "W-1 urn:w:R2");
}

TEST_F(RobotReservationTest, APreemptingRunDoesNotTakeARobotThatIsReservedAgainstIt) {
  Deploy("Long", {kDrive, WhenTold("Long", kDrive)});
  Deploy("Urgent", {kDrive}, "ext:priority=\"10\" ext:preempt=\"true\"");
  const TurnResult turn = Start("Long", "R1");
  ASSERT_TRUE(Reserve({{"R1"}, "Long-1", 20, 0, ""}).ok());
  Done(turn);
  EXPECT_EQ(Commands(Start("Urgent", "R1")), "");
  EXPECT_EQ(Commands(Go("Long")), "Long-1 urn:w:R1");
}

TEST_F(RobotReservationTest, OfTwoReservationsTheHigherThenTheOlderCounts) {
  Deploy("A", {WhenTold("A", kDrive)});
  Deploy("B", {WhenTold("B", kDrive)});
  Start("A");
  Start("B");
  ASSERT_TRUE(Reserve({{"R1"}, "A-1", 0, 0, ""}).ok());
  ASSERT_TRUE(Reserve({{"R1", "R2"}, "B-2", 0, 0, ""}).ok());
  EXPECT_EQ(Commands(Go("B")), "B-2 urn:w:R2") << "R1 is kept for A, which asked first";
  EXPECT_EQ(Commands(Go("A")), "A-1 urn:w:R1");
}

TEST_F(RobotReservationTest, AReservationOutlivesARestart) {
  Deploy("W", {kDrive});
  ASSERT_TRUE(Reserve({{"R1"}, "", 0, 60'000, ""}).ok());
  EXPECT_EQ(Commands(Start("W", "R1")), "");
  Restart();
  EXPECT_EQ(Commands(After(30)), "");
  EXPECT_EQ(Commands(After(40)), "W-1 urn:w:R1");
}

TEST_F(RobotReservationTest, RecordsOfRobotsHaveTheirReservations) {
  ASSERT_TRUE(Reserve({{"R1"}, "", 1, 60'000, ""}).ok());
  ASSERT_TRUE(Reserve({{"R1", "R2"}, "", 7, 60'000, "the mayor"}).ok());
  const GraphVersionPtr version = stages_->writer.Freeze(Revision(head_));
  const std::vector<RobotRecord> robots = ReadRobots(dictionary_, *version);
  ASSERT_EQ(robots.size(), 2u);
  ASSERT_EQ(robots[0].reservations.size(), 2u);
  EXPECT_EQ(robots[0].reservations[0].priority, 7);
  EXPECT_EQ(robots[0].reservations[0].reason, "the mayor");
  EXPECT_EQ(robots[1].reservations.size(), 1u);
}

TEST_F(RobotReservationTest, RequestsThatCannotBeAreRefused) {
  const auto code = [this](ReservationRequest request) {
    return Reserve(std::move(request)).status().code();
  };
  EXPECT_EQ(code({{}, "", 0, 1000, ""}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code({{"R1"}, "", 0, 0, ""}), absl::StatusCode::kInvalidArgument) << "it has no end";
  EXPECT_EQ(code({{"R1"}, "", 1001, 1000, ""}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code({{"R1"}, "", 0, kLongestReservationMs + 1, ""}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code({{"R9"}, "", 0, 1000, ""}), absl::StatusCode::kNotFound);
  EXPECT_EQ(code({{"R1"}, "Nothing", 0, 1000, ""}), absl::StatusCode::kNotFound);
  EXPECT_EQ(code({std::vector<std::string>(kWorkflowLimits.reserved_robots + 1, "R1"), "", 0, 1000, ""}),
            absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(code({std::vector<std::string>(kWorkflowLimits.reserved_robots, "R1"), "", 0, 1000, ""}),
            absl::StatusCode::kOk);
}

}  // namespace
}  // namespace docent::server
