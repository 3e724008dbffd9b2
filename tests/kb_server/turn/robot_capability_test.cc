// Which robots serve an invoke that asks for a class of operations.
#include <algorithm>
#include <memory>

#include "absl/strings/str_cat.h"
#include "graph/store/graph_reader.h"
#include "gtest/gtest.h"
#include "kb_server/turn/turn.h"
#include "tests/kb_server/test_world.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;

class RobotCapabilityTest : public testing::Test {
 protected:
  RobotCapabilityTest() {
    stages_ = std::make_unique<Stages>(&dictionary_, &functions_, Limits());
    Turn(Tell({Fact("docent:status", "a", "docent:StateProperty"),
               Fact("docent:SpeechWithGesture", "http://www.w3.org/2000/01/rdf-schema#subClassOf",
                    "docent:SpeechSynthesis")}));
  }

  TurnResult Turn(WriteBatch batch) {
    batch.time_us = ++head_ * 1'000'000;
    auto result = RunTurn(stages_.get(), std::move(batch), head_);
    EXPECT_TRUE(result.ok()) << result.status();
    return result.ok() ? *std::move(result) : TurnResult();
  }
  // The robot joins, or says something else of an operation: that it is of `classes` and takes `inputs`.
  TurnResult Offers(const std::string& robot, const std::string& operation, std::vector<std::string> classes,
                    std::vector<std::string> inputs = {}) {
    const std::string iri = "urn:docent:operation:" + operation;
    WriteBatch batch =
        Tell({Fact(robot, "a", "docent:Robot"), Fact(robot, "docent:incarnation", Term::Literal("i1")),
              Fact(robot, "docent:status", "docent:Standby"), Fact(robot, "docent:offers", iri),
              Fact(iri, "docent:inputsKnown", Term::Boolean(true))});
    for (const std::string& name : classes) {
      batch.operations.push_back({QuadOperation::Kind::kAdd, Fact(iri, "docent:capability", name)});
      batch.operations.push_back({QuadOperation::Kind::kAdd, Fact(robot, "docent:hasCapability", name)});
    }
    for (const std::string& input : inputs)
      batch.operations.push_back(
          {QuadOperation::Kind::kAdd, Fact(iri, "docent:input", Term::Literal(input))});
    batch.source = test::Name(robot);
    return Turn(std::move(batch));
  }
  void Deploy(const std::string& capability = "docent:SpeechSynthesis") {
    Turn(Put(Document::Kind::kCawl, "t.xml",
             "<CAWL name=\"T\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\" xmlns:w=\"urn:w:\"><flow "
             "name=\"F\">"
             "<variable name=\"text\"/><source name=\"s\"/><node name=\"N\"><invoke ext:capability=\"" +
                 capability +
                 "\"/></node><sink name=\"e\"/><link from=\"s\" to=\"N\"/><link from=\"N\" "
                 "to=\"e\"/></flow></CAWL>"));
  }
  TurnResult Start(std::vector<std::pair<std::string, Term>> arguments = {}) {
    return Turn(test::Start("T", std::move(arguments)));
  }
  // "OPERATION on ROBOT" of each command.
  static std::string Commands(const TurnResult& turn) {
    std::string text;
    for (const RobotCommand& command : turn.record.commands)
      absl::StrAppend(&text, text.empty() ? "" : ", ", command.operation, " on ", command.robot.value());
    return text;
  }
  std::string Told(const std::string& local) {
    const GraphVersionPtr version = stages_->writer.Freeze(Revision(head_));
    return GraphReader(dictionary_, *version).Object("urn:docent:run:F-1/N/0", DocentIri(local));
  }

  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  std::unique_ptr<Stages> stages_;
  uint64_t head_ = 0;
};

TEST_F(RobotCapabilityTest, AnOperationOfTheClassServesWhateverItsNameIs) {
  Offers("R1", "drive", {"docent:Navigation"});
  Offers("R2", "talk", {"docent:SpeechSynthesis"});
  Deploy();
  EXPECT_EQ(Commands(Start()), "talk on urn:w:R2");
  EXPECT_EQ(Told("operation"), "talk");
  EXPECT_EQ(Told("wantedCapability"), DocentIri("SpeechSynthesis"));
}

TEST_F(RobotCapabilityTest, AnOperationOfAClassBelowServes) {
  Offers("R1", "talkAndWave", {"docent:SpeechWithGesture"});
  Deploy();
  EXPECT_EQ(Commands(Start()), "talkAndWave on urn:w:R1");
}

TEST_F(RobotCapabilityTest, AnOperationOfAClassAboveDoesNot) {
  Offers("R1", "talk", {"docent:SpeechSynthesis"});
  Deploy("docent:SpeechWithGesture");
  EXPECT_EQ(Commands(Start()), "");
  EXPECT_EQ(
      Told("reason"),
      "no robot that is online offers an operation of class <https://w3id.org/docent#SpeechWithGesture>");
}

TEST_F(RobotCapabilityTest, AnEquivalentClassIsTheClass) {
  Turn(Tell({Fact("Speech", "http://www.w3.org/2002/07/owl#equivalentClass", "docent:SpeechSynthesis")}));
  Offers("R1", "talk", {"Speech"});
  Deploy();
  EXPECT_EQ(Commands(Start()), "talk on urn:w:R1");
  Offers("R2", "speak", {"docent:SpeechSynthesis"});
  Deploy("w:Speech");
  EXPECT_EQ(Commands(Start()), "speak on urn:w:R2");
}

TEST_F(RobotCapabilityTest, ClassesInACircleAreOneClass) {
  Turn(Tell({Fact("A", "http://www.w3.org/2000/01/rdf-schema#subClassOf", "B"),
             Fact("B", "http://www.w3.org/2000/01/rdf-schema#subClassOf", "A")}));
  Offers("R1", "talk", {"A"});
  Deploy("w:B");
  EXPECT_EQ(Commands(Start()), "talk on urn:w:R1");
}

TEST_F(RobotCapabilityTest, TheMostGeneralOfARobotsOperationsIsTaken) {
  Offers("R1", "aTalkAndWave", {"docent:SpeechWithGesture"});
  Offers("R1", "talk", {"docent:SpeechSynthesis"});
  Deploy();
  EXPECT_EQ(Commands(Start()), "talk on urn:w:R1");
}

TEST_F(RobotCapabilityTest, AnOperationThatTakesWhatTheRunDoesNotHaveIsPassedOver) {
  Offers("R1", "aTalkIn", {"docent:SpeechSynthesis"}, {"language"});
  Offers("R1", "talk", {"docent:SpeechWithGesture"}, {"text"});
  Deploy();
  const TurnResult turn = Start({{"text", Term::Literal("Welcome")}});
  EXPECT_EQ(Commands(turn), "talk on urn:w:R1");
  ASSERT_EQ(turn.record.commands.size(), 1u);
  ASSERT_EQ(turn.record.commands[0].arguments.size(), 1u);
  EXPECT_EQ(turn.record.commands[0].arguments.begin()->second, Term::Literal("Welcome"));
}

TEST_F(RobotCapabilityTest, ARunThatNoOperationSuitsSaysWhatIsMissing) {
  Offers("R1", "talk", {"docent:SpeechSynthesis"}, {"language"});
  Deploy();
  EXPECT_EQ(Commands(Start()), "");
  EXPECT_EQ(Told("reason"), "<urn:w:R1> would do talk, which takes language, and language has no value");
}

TEST_F(RobotCapabilityTest, WhatOneRobotSaysOfAnOperationIsNotSaidOfAnother) {
  Offers("R1", "talk", {});
  Offers("R2", "talk", {"docent:SpeechSynthesis"});
  Deploy();
  EXPECT_EQ(Commands(Start()), "talk on urn:w:R2");
}

TEST_F(RobotCapabilityTest, ARunThatWaitsGoesOnWhenTheOntologyPutsAClassBelow) {
  Offers("R1", "talk", {"Chatter"});
  Deploy();
  EXPECT_EQ(Commands(Start()), "");
  const TurnResult turn = Turn(
      Tell({Fact("Chatter", "http://www.w3.org/2000/01/rdf-schema#subClassOf", "docent:SpeechSynthesis")}));
  EXPECT_EQ(Commands(turn), "talk on urn:w:R1");
}

TEST_F(RobotCapabilityTest, ARobotThatIsAskedForHasToBeOfTheClass) {
  Offers("R1", "drive", {"docent:Navigation"});
  Offers("R2", "talk", {"docent:SpeechSynthesis"});
  Deploy();
  EXPECT_EQ(Commands(Start({{"robot", test::Iri("R1")}})), "");
  EXPECT_EQ(Told("reason"),
            "<urn:w:R1> is offline or does not offer an operation of class "
            "<https://w3id.org/docent#SpeechSynthesis>");
}

}  // namespace
}  // namespace docent::server
