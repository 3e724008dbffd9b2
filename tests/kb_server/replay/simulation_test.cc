// RunReplays::Simulate: a document on the facts of now, with simulated robots in simulated time.
#include "absl/strings/match.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "tests/kb_server/replay/replay_fixture.h"

namespace docent::server::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SimulationTest : public ReplayTest {
 protected:
  SimulationRequest Request(const std::string& text = kGuide) {
    SimulationRequest request;
    request.text = text;
    request.name = "edited.cawl.xml";
    request.lasting_us = 3600 * kSecond;
    request.now_us = now_us_;
    return request;
  }
  static SimulatedTelling Telling(double after_s, const std::string& s, const std::string& p,
                                  const std::string& o) {
    return {static_cast<TimeMicros>(after_s * kSecond), {{QuadOperation::Kind::kAdd, Fact(s, p, o)}}};
  }
  absl::StatusOr<Simulation> Simulate(const SimulationRequest& request) {
    RunReplays replays(Ports());
    Cancellation cancellation;
    return replays.Simulate(request, &cancellation);
  }
  // "SECONDS NODE STATE" or "SECONDS NODE OPERATION".
  static std::vector<std::string> Steps(const absl::StatusOr<Simulation>& simulation) {
    EXPECT_TRUE(simulation.ok()) << simulation.status();
    std::vector<std::string> steps;
    if (!simulation.ok()) return steps;
    const TimeMicros begin_us = simulation->world.turns.front().time_us;
    for (const Decision& decision : simulation->play.course.decisions) {
      if (decision.node.empty() || (decision.kind == Decision::Kind::kState && decision.to == "inactive"))
        continue;
      steps.push_back(
          absl::StrCat((decision.time_us - begin_us) / kSecond, " ", decision.node, " ",
                       decision.kind == Decision::Kind::kState ? decision.to : decision.operation));
    }
    return steps;
  }
};

TEST_F(SimulationTest, RunsToItsEndWithWhatIsToldMeanwhile) {
  World();
  Tell("John", "docent:chose", "Guide");
  const uint64_t before = head_;
  SimulationRequest request = Request();
  request.told = {Telling(20, "John", "docent:selected", "B03")};
  const auto simulation = Simulate(request);
  EXPECT_THAT(Steps(simulation),
              ElementsAre("0 Come waiting", "0 Come running", "0 Come come", "3 Come done", "3 Lead waiting",
                          "20 Lead running", "20 Lead lead", "23 Lead done", "23 Bye waiting",
                          "23 Bye running", "23 Bye bye", "26 Bye done"));
  EXPECT_EQ(simulation->play.course.state, "done");
  EXPECT_EQ(simulation->play.course.variables.at("user").lexical, Iri("John").lexical);
  EXPECT_EQ(head_, before) << "nothing is written";
}

TEST_F(SimulationTest, EndsWhereNothingMoreCanHappenAndSaysWhatItLacks) {
  World();
  const auto simulation = Simulate(Request(Edited(R"( ext:timeout="60s")", "")));
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_EQ(simulation->play.course.state, "running");
  EXPECT_THAT(simulation->play.stopped, IsEmpty());
  std::vector<std::string> nodes;
  for (const PlayedWait& wait : simulation->play.waits) nodes.push_back(wait.node);
  EXPECT_THAT(nodes, ElementsAre(kActivator, "Lead"));
  EXPECT_THAT(simulation->play.waits.front().missing, HasSubstr("chose"));
  EXPECT_THAT(absl::StrJoin(simulation->play.notes, "\n"), HasSubstr("does not fire on these facts"));
}

TEST_F(SimulationTest, TimersGoOffInSimulatedTime) {
  World();
  Tell("John", "docent:chose", "Guide");
  const auto simulation = Simulate(Request());  // nobody selects a booth: ext:timeout of Lead
  EXPECT_EQ(Steps(simulation).back(), "63 Lead failed");
  EXPECT_EQ(simulation->play.course.state, "failed");
}

TEST_F(SimulationTest, RobotsThatAreBusyHeldOrAwayAreTakenToBeReady) {
  World();
  Tell("John", "docent:chose", "Guide");  // the live run holds R1
  Tell("R1", "docent:status", "docent:Offline");
  SimulationRequest request = Request();
  request.arguments = {{"user", Iri("John")}};
  request.told = {Telling(1, "John", "docent:selected", "B03")};
  const auto simulation = Simulate(request);
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_EQ(simulation->play.course.state, "done") << absl::StrJoin(Steps(simulation), "\n");
  EXPECT_THAT(absl::StrJoin(simulation->play.notes, "\n"), HasSubstr("taken to be ready: <"));
}

TEST_F(SimulationTest, OperationThatNoRobotOffersHasASimulatedRobot) {
  Turn(test::Tell({Fact("docent:selected", "a", "docent:StateProperty"), Fact("John", "docent:isAt", "Hall"),
                   Fact("John", "docent:chose", "Guide"), Fact("John", "docent:selected", "B03")}));
  const auto simulation = Simulate(Request());  // neither robot nor workflow is known to the server
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_EQ(simulation->play.course.state, "done") << absl::StrJoin(Steps(simulation), "\n");
  EXPECT_THAT(absl::StrJoin(simulation->play.notes, "\n"), HasSubstr("no robot offers bye, come, lead"));
}

TEST_F(SimulationTest, WhatIsToldAtTheBeginStartsTheRun) {
  World();
  SimulationRequest request = Request();
  request.told = {Telling(0, "John", "docent:chose", "Guide"), Telling(9, "John", "docent:selected", "B03")};
  const auto simulation = Simulate(request);
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_EQ(simulation->play.course.state, "done") << absl::StrJoin(Steps(simulation), "\n");
  EXPECT_THAT(simulation->play.notes, IsEmpty());
}

TEST_F(SimulationTest, DescribedRobotThatNeverJoinedIsSimulated) {
  Turn(test::Tell({Fact("docent:selected", "a", "docent:StateProperty"), Fact("R7", "a", "docent:Robot"),
                   Fact("John", "docent:isAt", "Hall"), Fact("John", "docent:chose", "Guide"),
                   Fact("John", "docent:selected", "B03")}));
  const auto simulation = Simulate(Request());
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_EQ(simulation->play.course.state, "done") << absl::StrJoin(Steps(simulation), "\n");
  EXPECT_THAT(absl::StrJoin(simulation->play.notes, "\n"), HasSubstr(Iri("R7").lexical));
}

TEST_F(SimulationTest, RobotDrivesToThePlaceAndIsThere) {
  World();
  const auto says = [lead = Term::Iri(OperationIri("lead"))](const std::string& property, Term value) {
    return TermQuad{lead, Iri(property), std::move(value), Iri("R1")};
  };
  Turn(test::Tell({says("docent:occupies", Term::Literal("base")),
                   says("docent:input", Term::Literal("booth")),
                   says("docent:inputsKnown", Term::Boolean(true)),
                   Fact("R1", "docent:x", Term::Literal("1.0", std::string(kXsdDecimal))),
                   Fact("R1", "docent:y", Term::Literal("2.0", std::string(kXsdDecimal))),
                   TermQuad{Iri("B03"), Iri("docent:servicePoint"), Term::Blank("p"), Term()},
                   TermQuad{Term::Blank("p"), Term::Iri("http://www.opengis.net/ont/geosparql#asWKT"),
                            Term::Literal("POINT(7 2)"), Term()},
                   Fact("John", "docent:chose", "Guide"), Fact("John", "docent:selected", "B03")}));
  SimulationRequest request = Request();
  request.arguments = {{"user", Iri("John")}};
  const auto simulation = Simulate(request);
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  // 6 m at 0.6 m/s
  ASSERT_EQ(simulation->play.poses.size(), 10u) << absl::StrJoin(Steps(simulation), "\n");
  EXPECT_DOUBLE_EQ(simulation->play.poses.front().x_m, 1.6);
  EXPECT_DOUBLE_EQ(simulation->play.poses.back().x_m, 7);
  EXPECT_EQ(simulation->play.poses.back().place, Iri("B03").lexical);
  EXPECT_EQ(simulation->play.poses.back().time_us - simulation->play.poses.front().time_us, 9 * kSecond);
}

TEST_F(SimulationTest, WhatCannotBeSimulatedIsSaid) {
  World();
  EXPECT_THAT(Simulate(Request("<CAWL")).status().ToString(), HasSubstr("INVALID_ARGUMENT"));
  SimulationRequest no_flow = Request();
  no_flow.flow = "Guid";
  EXPECT_THAT(Simulate(no_flow).status().ToString(), HasSubstr("is it now Guide?"));
  SimulationRequest future = Request();
  future.turn = head_ + 1;
  EXPECT_THAT(Simulate(future).status().ToString(), HasSubstr("has not come yet"));
}

TEST_F(SimulationTest, PastTurnIsTheWorldOfThen) {
  World();
  Tell("John", "docent:chose", "Guide");
  const uint64_t then = head_;
  Turn(test::Tell({Fact("John", "docent:isAt", "Outside")}));
  Turn([] {
    WriteBatch batch;
    batch.operations.push_back({QuadOperation::Kind::kRemove, Fact("John", "docent:chose", "Guide")});
    return batch;
  }());
  SimulationRequest request = Request();
  request.turn = then;
  const auto simulation = Simulate(request);
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_EQ(simulation->world.last_turn, then);
  EXPECT_EQ(simulation->play.course.variables.at("user").lexical, Iri("John").lexical);
}

}  // namespace
}  // namespace docent::server::test
