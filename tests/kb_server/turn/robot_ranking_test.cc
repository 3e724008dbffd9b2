// Which of several free robots gets a command.
#include "kb_server/turn/robot_ranking.h"

#include "absl/strings/str_cat.h"
#include "graph/store/graph_reader.h"
#include "gtest/gtest.h"
#include "kb_server/turn/spatial_functions.h"
#include "kb_server/turn/turn.h"
#include "tests/kb_server/test_world.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;

class RobotRankingTest : public testing::Test {
 protected:
  RobotRankingTest() {
    RegisterSpatialFunctions(&functions_);
    stages_ = std::make_unique<Stages>(&dictionary_, &functions_, Limits());
    std::vector<TermQuad> facts = {Fact("docent:status", "a", "docent:StateProperty"),
                                   Fact("docent:battery", "a", "docent:StateProperty")};
    for (const char* robot : {"R1", "R2", "R3"}) {
      facts.push_back(Fact(robot, "a", "docent:Robot"));
      facts.push_back(Fact(robot, "docent:incarnation", Term::Literal("i1")));
      facts.push_back(Fact(robot, "docent:status", "docent:Standby"));
      facts.push_back(Fact(robot, "docent:offers", "urn:docent:operation:drive"));
    }
    Turn(Tell(facts));
  }

  TurnResult Turn(WriteBatch batch) {
    batch.time_us = ++head_ * 1'000'000;
    auto result = RunTurn(stages_.get(), std::move(batch), head_);
    EXPECT_TRUE(result.ok()) << result.status();
    return result.ok() ? *std::move(result) : TurnResult();
  }
  static Term Number(const char* text) { return Term::Literal(text, std::string(kXsdDecimal)); }
  void Deploy(const std::string& invoke, const std::string& condition = "") {
    Turn(Put(Document::Kind::kCawl, "t.xml",
             "<CAWL name=\"T\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\" xmlns:w=\"urn:w:\"><message "
             "name=\"M\">"
             "<part name=\"place\"/></message><flow name=\"F\"><variable name=\"place\"/><source name=\"s\"/>"
             "<node name=\"N\">" +
                 condition + "<invoke operation=\"drive\" " + invoke +
                 "/></node><sink name=\"e\"/><link from=\"s\" to=\"N\"/><link from=\"N\" "
                 "to=\"e\"/></flow></CAWL>"));
  }
  // A connection; its name.
  std::string Connect(const std::string& from, const std::string& to) {
    const std::string name = absl::StrCat(from, "To", to);
    Turn(Tell({Fact(name, "docent:fromPlace", from), Fact(name, "docent:toPlace", to)}));
    return name;
  }
  // The robot of a new run that goes to `place`; its command ends at once.
  std::string Chosen(const std::string& place = "Nowhere") {
    const TurnResult turn = Turn(test::Start("T/F", {{"place", test::Iri(place)}}));
    if (turn.record.commands.size() != 1) return absl::StrCat(turn.record.commands.size(), " commands");
    Turn(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kSucceeded));
    return turn.record.commands[0].robot.value();
  }

  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  std::unique_ptr<Stages> stages_;
  uint64_t head_ = 0;
};

TEST_F(RobotRankingTest, RobotsThatAreEqualTakeTurns) {
  Deploy("");
  EXPECT_EQ(Chosen(), "urn:w:R1");
  EXPECT_EQ(Chosen(), "urn:w:R2");
  EXPECT_EQ(Chosen(), "urn:w:R3");
  EXPECT_EQ(Chosen(), "urn:w:R1");
}

// ?robot of a condition: what it matches are the candidates.
constexpr char kAnyRobot[] =
    "<condition><context name=\"c\"><rule><constraint><subject>?robot</subject><verb>docent:offers</verb>"
    "<object>&lt;urn:docent:operation:drive&gt;</object></constraint></rule></context></condition>";

TEST_F(RobotRankingTest, OfRobotsThatAConditionMatchesTheOneWithTheMostChargeIsPreferred) {
  Deploy("", kAnyRobot);
  Turn(Tell({Fact("R1", "docent:battery", Number("20")), Fact("R2", "docent:battery", Number("90")),
             Fact("R3", "docent:battery", Number("50"))}));
  EXPECT_EQ(Chosen(), "urn:w:R2");
  EXPECT_EQ(Chosen(), "urn:w:R2") << "the same graph gives the same robot";
}

TEST_F(RobotRankingTest, OfRobotsThatAConditionMatchesTheDocumentsOwnOrderIsTaken) {
  Deploy("ext:choose=\"SELECT ?robot { ?robot docent:battery ?b } ORDER BY ?b\"", kAnyRobot);
  Turn(Tell({Fact("R1", "docent:battery", Number("40")), Fact("R2", "docent:battery", Number("30")),
             Fact("R3", "docent:battery", Number("50"))}));
  EXPECT_EQ(Chosen(), "urn:w:R2");
}

TEST_F(RobotRankingTest, RobotsThatAConditionMatchesTakeTurns) {
  Deploy("", kAnyRobot);
  EXPECT_EQ(Chosen(), "urn:w:R1");
  EXPECT_EQ(Chosen(), "urn:w:R2");
  EXPECT_EQ(Chosen(), "urn:w:R3");
}

TEST_F(RobotRankingTest, AValueThatEachRobotsMatchHasForItselfIsNoGoal) {
  std::string condition = kAnyRobot;
  condition.replace(condition.find("docent:offers"), 13, "w:stands");
  condition.replace(condition.find("&lt;urn:docent:operation:drive&gt;"), 34, "?place");
  Deploy("", condition);
  Turn(Tell({Fact("R1", "stands", "A"), Fact("R2", "stands", "B"), Fact("A", "docent:x", Number("0")),
             Fact("A", "docent:y", Number("0")), Fact("R1", "docent:x", Number("0")),
             Fact("R1", "docent:y", Number("0")), Fact("R2", "docent:x", Number("9")),
             Fact("R2", "docent:y", Number("0")), Fact("R2", "docent:battery", Number("90")),
             Fact("R1", "docent:battery", Number("20"))}));
  const TurnResult turn = Turn(test::Start("T/F"));
  ASSERT_EQ(turn.record.commands.size(), 1u);
  EXPECT_EQ(turn.record.commands[0].robot.value(), "urn:w:R2") << "and not the one that stands at A";
}

TEST_F(RobotRankingTest, OneThatDoesNotOfferTheOperationIsPassedOver) {
  std::string condition = kAnyRobot;
  condition.replace(condition.find("docent:offers"), 13, "a");
  condition.replace(condition.find("&lt;urn:docent:operation:drive&gt;"), 34, "docent:Robot");
  Deploy("", condition);
  Turn(Tell({Fact("A", "a", "docent:Robot"), Fact("A", "docent:status", "docent:Standby")}));
  EXPECT_EQ(Chosen(), "urn:w:R1");
}

TEST_F(RobotRankingTest, TheOneWithTheMostChargeIsPreferred) {
  Deploy("");
  Turn(Tell({Fact("R1", "docent:battery", Number("20")), Fact("R2", "docent:battery", Number("90")),
             Fact("R3", "docent:battery", Number("50"))}));
  EXPECT_EQ(Chosen(), "urn:w:R2");
  EXPECT_EQ(Chosen(), "urn:w:R2");
}

TEST_F(RobotRankingTest, TheNearestToTheGoalIsPreferredToTheOneWithTheMostCharge) {
  Deploy("");
  Turn(Tell({Fact("R1", "docent:x", Number("0")), Fact("R1", "docent:y", Number("0")),
             Fact("R2", "docent:x", Number("10")), Fact("R2", "docent:y", Number("0")),
             Fact("R1", "docent:battery", Number("90")), Fact("B01", "docent:servicePoint", "P"),
             Fact("P", "docent:x", Number("9")), Fact("P", "docent:y", Number("1"))}));
  EXPECT_EQ(Chosen("B01"), "urn:w:R2");
  EXPECT_EQ(Chosen("B02"), "urn:w:R1") << "where that is, nobody knows";
}

TEST_F(RobotRankingTest, TheNearestIsThatWithTheShortestRouteAlongTheRoadmap) {
  Deploy("");
  const auto at = [](const char* name, const char* x, const char* y) {
    return std::vector<TermQuad>{Fact(name, "docent:x", Number(x)), Fact(name, "docent:y", Number(y))};
  };
  // R1 and the goal are on the two sides of a wall, the door of which is far away. R2 is in the room of the goal.
  for (const auto& facts : {at("R1", "0", "10"), at("R2", "20", "10.5"), at("B01", "0", "11"),
                            at("Near", "0", "9"), at("Far", "0", "12"), at("Door", "30", "10.5")})
    Turn(Tell(facts));
  EXPECT_EQ(Chosen("B01"), "urn:w:R1") << "along the straight line";
  for (const char* name : {"Near", "Far"}) {
    Connect(name, "Door");
    Connect("Door", name);
  }
  EXPECT_EQ(Chosen("B01"), "urn:w:R1") << "nearer to each other than to the roadmap";
  for (const auto& facts : {at("R1", "0", "9.2"), at("B01", "0", "11.8")}) Turn(Tell(facts));
  Turn(Tell({}, {Fact("R1", "docent:y", Number("10")), Fact("B01", "docent:y", Number("11"))}));
  EXPECT_EQ(Chosen("B01"), "urn:w:R2");
}

TEST_F(RobotRankingTest, ARouteLeadsAlongNoConnectionThatIsClosed) {
  Deploy("");
  const auto at = [](const char* name, const char* x) {
    return std::vector<TermQuad>{Fact(name, "docent:x", Number(x)), Fact(name, "docent:y", Number("0"))};
  };
  for (const auto& facts : {at("R1", "0"), at("R2", "50"), at("Goal", "20"), at("A", "0"), at("B", "10"),
                            at("C", "20"), at("D", "50")})
    Turn(Tell(facts));
  Turn(Tell({Fact("docent:closed", "a", "docent:StateProperty"),
             Fact("docent:length", "a", "docent:StateProperty")}));
  Connect("A", "B");
  Connect("D", "C");
  const std::string lift = Connect("B", "C");
  EXPECT_EQ(Chosen("Goal"), "urn:w:R1");
  Turn(Tell({Fact(lift, "docent:length", Number("40"))}));
  EXPECT_EQ(Chosen("Goal"), "urn:w:R2") << "50 m against 30 m";
  Turn(Tell({Fact(lift, "docent:length", Number("12"))}));
  EXPECT_EQ(Chosen("Goal"), "urn:w:R1");
  Turn(Tell({Fact(lift, "docent:closed", Term::Boolean(true))}));
  EXPECT_EQ(Chosen("Goal"), "urn:w:R2") << "no way leads from R1";
  Turn(Tell({Fact(lift, "docent:closed", Term::Boolean(false))}));
  EXPECT_EQ(Chosen("Goal"), "urn:w:R1");
}

TEST_F(RobotRankingTest, WithoutAGoalNoDistanceCounts) {
  Deploy("");
  Turn(Tell({Fact("R1", "docent:x", Number("0")), Fact("R1", "docent:y", Number("0")),
             Fact("R1", "docent:battery", Number("10")), Fact("R2", "docent:battery", Number("90"))}));
  const TurnResult turn = Turn(test::Start("T/F"));
  ASSERT_EQ(turn.record.commands.size(), 1u);
  EXPECT_EQ(turn.record.commands[0].robot.value(), "urn:w:R2");
  Turn(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kSucceeded));
  EXPECT_EQ(Chosen("AlsoNowhere"), "urn:w:R2") << "a place of which the graph says nothing";
}

TEST_F(RobotRankingTest, AServicePointMayHaveItsPlaceAsWkt) {
  Deploy("");
  const std::string wkt = "http://www.opengis.net/ont/geosparql#asWKT";
  const auto point = [](const char* text) {
    return Term::Literal(text, "http://www.opengis.net/ont/geosparql#wktLiteral");
  };
  Turn(Tell({Fact("R1", "docent:x", Number("0")), Fact("R1", "docent:y", Number("0")),
             Fact("R2", "docent:x", Number("9")), Fact("R2", "docent:y", Number("0")),
             Fact("B01", "docent:servicePoint", "P1"), Fact("P1", wkt, point("POINT(6 0)")),
             Fact("B02", "docent:servicePoint", "P2"), Fact("P2", wkt, point("POINT(0 0)"))}));
  EXPECT_EQ(Chosen("B01"), "urn:w:R2") << "as halls describe it";
  EXPECT_EQ(Chosen("B02"), "urn:w:R1");
}

TEST_F(RobotRankingTest, ARunsVariablesAreNotThoseOfTheDefaultQuery) {
  Deploy("");
  Turn(Tell({Fact("R3", "docent:battery", Number("90"))}));
  const TurnResult turn = Turn(test::Start(
      "T/F",
      {{"place", test::Iri("Nowhere")}, {"charge", Number("1")}, {"used", Number("1")}, {"x", Number("1")}}));
  ASSERT_EQ(turn.record.commands.size(), 1u);
  EXPECT_EQ(turn.record.commands[0].robot.value(), "urn:w:R3");
}

TEST_F(RobotRankingTest, TheLoadOfARobotIsWhatItWorksForAndWhatWaitsForItByName) {
  Deploy("");
  Turn(Tell({Fact("R1", "docent:outOfService", Term::Literal("a wheel"))}));
  const TurnResult waits = Turn(test::Start("T/F", {{"robot", test::Iri("R1")}}));
  EXPECT_TRUE(waits.record.commands.empty());
  const GraphVersionPtr version = stages_->writer.Freeze(Revision(head_));
  EXPECT_EQ(GraphReader(dictionary_, *version).Object(test::Name("R1"), DocentIri("load")), "1");
  EXPECT_EQ(GraphReader(dictionary_, *version).Object(test::Name("R2"), DocentIri("load")), "");
}

TEST_F(RobotRankingTest, ADocumentHasAnOrderOfItsOwn) {
  Deploy("ext:choose=\"SELECT ?robot { ?robot w:noise ?n } ORDER BY ?n\"");
  Turn(Tell({Fact("R3", "noise", Number("1")), Fact("R2", "noise", Number("5"))}));
  EXPECT_EQ(Chosen(), "urn:w:R3");
  Turn(Tell({Fact("R3", "docent:status", "docent:Charging")}));
  EXPECT_EQ(Chosen(), "urn:w:R2");
  Turn(Tell({Fact("R2", "docent:status", "docent:Charging")}));
  EXPECT_EQ(Chosen(), "urn:w:R1") << "it is not in the answer, and free";
}

TEST_F(RobotRankingTest, TheRunsValuesAreThoseOfTheQuery) {
  Deploy("ext:choose=\"SELECT ?robot { ?robot w:knows ?place } ORDER BY DESC(?robot)\"");
  Turn(Tell({Fact("R2", "knows", "Hall"), Fact("R3", "knows", "Cellar")}));
  EXPECT_EQ(Chosen("Hall"), "urn:w:R2");
  EXPECT_EQ(Chosen("Cellar"), "urn:w:R3");
}

}  // namespace
}  // namespace docent::server
