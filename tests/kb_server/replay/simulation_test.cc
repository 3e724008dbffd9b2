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
using ::testing::Not;
using ::testing::UnorderedElementsAre;

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

// A workflow of one flow T, whose nodes follow each other.
std::string Flow(const std::string& nodes_and_links, const std::string& activator = "",
                 const std::string& more = "") {
  return absl::StrCat(
      R"(<CAWL name="T" xmlns:w="urn:w:" xmlns:docent="https://w3id.org/docent#" xmlns:ext="https://w3id.org/docent/cawl-ext#">)",
      activator, R"(<flow name="T"><variable name="a"/><source name="s"/>)", nodes_and_links,
      R"(<sink name="e"/><link from="s" to="N"/><link from="N" to="e"/></flow>)", more, "</CAWL>");
}
std::string IsOpen(const std::string& attributes = "") {
  return absl::StrCat("<context name=\"c\"><rule", attributes, ">", When("?a", "w:is", "w:Open"),
                      "</rule></context>");
}
std::string Waits(const std::string& condition, const std::string& attributes = "") {
  return Flow(absl::StrCat("<node name=\"N\"><condition", attributes, ">", condition, "</condition></node>"));
}
std::string Time(const std::string& words) {
  return absl::StrCat("<context name=\"t\"><ext:time ", words, "/></context>");
}
std::string Starts(const std::string& condition) {
  return absl::StrCat(R"(<activator name="A"><activate flow="T"/><condition>)", condition,
                      "</condition></activator>");
}

WriteBatch TellFor(const std::string& s, const std::string& p, const std::string& o, uint64_t lifetime_ms) {
  WriteBatch batch = test::Tell({Fact(s, p, o)});
  batch.lifetime_ms = lifetime_ms;
  return batch;
}

TEST_F(SimulationTest, LifetimesOfFactsGoOn) {
  Turn(TellFor("Door", "is", "Open", 3000));
  const auto lasting = Simulate(Request(Waits(IsOpen(R"( ext:for="6s")"), R"( ext:timeout="20s")")));
  ASSERT_TRUE(lasting.ok()) << lasting.status();
  EXPECT_EQ(lasting->play.course.state, "failed") << "it ends before it has held for 6 s";
  const auto shorter = Simulate(Request(Waits(IsOpen(R"( ext:for="2s")"), R"( ext:timeout="20s")")));
  ASSERT_TRUE(shorter.ok()) << shorter.status();
  EXPECT_EQ(shorter->play.course.state, "done");
  Turn(test::Tell({Fact("Door", "is", "Open")}));
  const auto renewed = Simulate(Request(Waits(IsOpen(R"( ext:for="6s")"), R"( ext:timeout="20s")")));
  ASSERT_TRUE(renewed.ok()) << renewed.status();
  EXPECT_EQ(renewed->play.course.state, "done") << "told again, it stays";
}

TEST_F(SimulationTest, TheEndOfALifetimeOpensWhatWaitsForIt) {
  Turn(TellFor("Door", "is", "Open", 5000));
  const std::string closed = absl::StrCat("<context name=\"c\"><rule expression=\"not o\">",
                                          "<constraint name=\"o\"><subject>w:Door</subject><verb>w:is</verb>",
                                          "<object>w:Open</object></constraint></rule></context>");
  EXPECT_THAT(Steps(Simulate(Request(Waits(closed)))), ElementsAre("0 N waiting", "5 N running", "5 N done"));
  SimulationRequest shorter = Request(Waits(closed));
  shorter.lasting_us = 2 * kSecond;
  EXPECT_THAT(Simulate(shorter)->play.stopped, HasSubstr("5s after the begin"));
}

TEST_F(SimulationTest, PoseOfASimulatedRobotStays) {
  World();
  WriteBatch pose = test::Tell({TermQuad{Iri("R1"), Iri("docent:isAt"), Iri("Hall"), Iri("R1")}});
  pose.lifetime_ms = 2000;
  Turn(std::move(pose));
  const std::string in_hall =
      absl::StrCat("<context name=\"c\"><rule ext:for=\"6s\">", When("?a", "docent:isAt", "w:Hall"),
                   When("?a", "docent:status", "docent:Standby"), "</rule></context>");
  EXPECT_EQ(Simulate(Request(Waits(in_hall)))->play.course.state, "done");
}

TEST_F(SimulationTest, ATimeThatIsWaitedForIsTold) {
  Turn(test::Tell({Fact("Door", "is", "Open")}));
  const std::string later = "2023-11-15T00:13:21";
  for (const auto& [document, why] :
       {std::pair(Waits(Time(R"(after="2h")")), "may open it from " + later),
        {Waits(IsOpen(R"( ext:for="2h")")), "it opens it at " + later},
        {Waits(Time(R"(at="00:13:21")")), "its time comes at " + later},
        {Waits(Time(R"(between="00:13:21-03:00")")), "its time comes at " + later}}) {
    const auto simulation = Simulate(Request(document));
    ASSERT_TRUE(simulation.ok()) << simulation.status();
    ASSERT_EQ(simulation->play.waits.size(), 1u) << document;
    EXPECT_THAT(simulation->play.waits[0].missing, HasSubstr(why));
    EXPECT_THAT(simulation->play.waits[0].missing, Not(HasSubstr("robot")));
    EXPECT_THAT(simulation->play.stopped, HasSubstr("the simulated time ends after 1h"));
    EXPECT_THAT(simulation->play.stopped, HasSubstr("2h after the begin"));
    SimulationRequest longer = Request(document);
    longer.lasting_us = 3 * 3600 * kSecond;
    EXPECT_EQ(Simulate(longer)->play.course.state, "done");
    EXPECT_THAT(Simulate(longer)->play.stopped, IsEmpty());
  }
  EXPECT_THAT(Simulate(Request(Waits(Time(R"(after="48h")"))))->play.stopped,
              HasSubstr("a simulation lasts 24h at most"));
}

constexpr char kTriedAgain[] =
    R"(<node name="N"><invoke subflow="Q" ext:retry="1" ext:retry-delay="2h"/></node>)";
constexpr char kFails[] =
    R"(<flow name="Q"><source name="b"/><node name="W"><ext:fail reason="x"/></node><sink name="f"/><link from="b" to="W"/><link from="W" to="f"/></flow>)";

TEST_F(SimulationTest, ADelayOfARetryIsTold) {
  Turn(test::Tell({Fact("Door", "is", "Open")}));
  const auto simulation = Simulate(Request(Flow(kTriedAgain, "", kFails)));
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_THAT(simulation->play.pending, HasSubstr("its next attempt begins at 2023-11-15T00:13:21"));
  EXPECT_THAT(simulation->play.stopped, HasSubstr("2h after the begin"));
}

TEST_F(SimulationTest, ASubFlowThatIsTriedAgainIsOfItsNode) {
  Turn(test::Tell({Fact("Door", "is", "Open")}));
  SimulationRequest request = Request(Flow(kTriedAgain, "", kFails));
  request.lasting_us = 3 * 3600 * kSecond;
  EXPECT_THAT(Steps(Simulate(request)),
              ElementsAre("0 N running", "0 N running", "0 N/W running", "0 N/W failed", "0 N failed",
                          "7200 N#2 running", "7200 N#2/W running", "7200 N#2/W failed", "7200 N#2 failed",
                          "7200 N failed"));
}

TEST_F(SimulationTest, WhatUnrelatedFactsDoLaterIsNoReasonToGoOn) {
  Turn(TellFor("Lamp", "shines", "Red", 5 * 3600 * 1000));
  const auto simulation = Simulate(Request(Waits(IsOpen())));
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_EQ(simulation->play.course.state, "running");
  EXPECT_THAT(simulation->play.stopped, IsEmpty());
}

TEST_F(SimulationTest, EachAlternativeIsToldOfWithWhatItLacks) {
  Turn(test::Tell({Fact("Door", "is", "Shut")}));
  const auto simulation = Simulate(Request(Waits(absl::StrCat(IsOpen(), Time(R"(after="2h")")))));
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  std::vector<std::string> missing;
  for (const PlayedWait& wait : simulation->play.waits) missing.push_back(wait.missing);
  EXPECT_THAT(missing, UnorderedElementsAre(HasSubstr("urn:w:Open"), HasSubstr("may open it from")));
}

constexpr char kNotFired[] = "activator A does not fire on these facts; the run is started all the same";

TEST_F(SimulationTest, AnActivatorWhoseTimeIsNotOverDoesNotFire) {
  Turn(test::Tell({Fact("Door", "is", "Open")}));
  const std::string document = Flow("<node name=\"N\"/>", Starts(IsOpen(R"( ext:for="1h")")));
  const auto simulation = Simulate(Request(document));
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_EQ(simulation->play.course.state, "done");
  EXPECT_EQ(simulation->play.course.variables.at("a"), Iri("Door")) << "the values with which it will fire";
  ASSERT_EQ(simulation->play.notes.size(), 1u);
  EXPECT_THAT(simulation->play.notes[0], HasSubstr(kNotFired));
  EXPECT_THAT(simulation->play.notes[0], HasSubstr("if they stay so, it fires at 2023-11-14T23:13:21"));
  EXPECT_THAT(simulation->play.waits.at(0).missing, HasSubstr("not yet for the 1h that it has to hold"));

  Turn(Put(Document::Kind::kCawl, "t.cawl.xml", document));  // from now on its time runs
  const TimeMicros deployed_us = now_us_;
  SimulationRequest later = Request(document);
  later.now_us = deployed_us + 1800 * kSecond;
  EXPECT_THAT(Simulate(later)->play.notes.at(0), HasSubstr("it fires at 2023-11-14T23:13:22"));
  later.now_us = deployed_us + 3601 * kSecond;
  EXPECT_THAT(Simulate(later)->play.notes, IsEmpty()) << "it has held for an hour";
}

TEST_F(SimulationTest, WhenTheTimeOfAnActivatorComesIsTold) {
  Turn(test::Tell({Fact("Door", "is", "Open")}));
  for (const char* words : {R"(at="00:00")", R"(between="00:00-03:00")", R"(every="1h" aligned="true")"}) {
    const auto simulation = Simulate(Request(Flow("<node name=\"N\"/>", Starts(Time(words)))));
    ASSERT_TRUE(simulation.ok()) << simulation.status();
    ASSERT_EQ(simulation->play.notes.size(), 1u) << words;
    EXPECT_THAT(simulation->play.notes[0], HasSubstr(kNotFired));
    EXPECT_THAT(simulation->play.notes[0], HasSubstr("its time comes at 2023-11-1"));
  }
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
