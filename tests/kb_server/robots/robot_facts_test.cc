#include "kb_server/robots/robot_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/batch_applier.h"
#include "graph/store/graph_writer.h"
#include "kb_server/robots/robot_directory.h"
#include "kb_server/robots/robot_records.h"

namespace docent::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

RobotDescription Guide() {
  RobotDescription guide;
  guide.robot = "urn:r1";
  guide.label = "Guide";
  guide.incarnation = "i1";
  guide.address = "127.0.0.1:9";
  guide.operations = {{"drive", {"goal"}, {}, true}, {"speak", {"text"}, {}, false}};
  return guide;
}

// What is told of robots, and how it is read back.
class RobotFactsTest : public ::testing::Test {
 protected:
  Delta Apply(WriteBatch batch) {
    absl::StatusOr<Delta> delta = applier_.Apply(batch, writer_, {});
    EXPECT_TRUE(delta.ok()) << delta.status();
    return delta.ok() ? *delta : Delta();
  }
  Delta Join(const RobotDescription& description) {
    return Apply(FactsOfJoin(description, dictionary_, writer_.current()));
  }
  Delta Lose(const std::string& robot, TimeMicros seen_us) {
    return Apply(FactsOfLoss(robot, seen_us, dictionary_, writer_.current()));
  }
  std::vector<RobotRecord> Robots() const { return ReadRobots(dictionary_, writer_.current()); }

  Dictionary dictionary_;
  GraphWriter writer_{nullptr};
  BatchApplier applier_{dictionary_, Limits{}};
};

// It was docent:Busy for ever after its first command, and kept its states when it was lost.
TEST_F(RobotFactsTest, ARobotThatIsDoneIsFreeThoughNoOntologyIsLoaded) {
  Join(Guide());
  const auto tell = [&](const char* property, Term value) {
    WriteBatch batch;
    batch.source = "urn:r1";
    batch.operations.push_back(
        {QuadOperation::Kind::kAdd,
         {Term::Iri("urn:r1"), Term::Iri(DocentIri(property)), std::move(value), Term()}});
    Apply(batch);
  };
  for (int i = 0; i < 2; ++i) {
    tell("status", Term::Iri(DocentIri("Busy")));
    EXPECT_EQ(Robots()[0].state, RobotRecord::State::kBusy);
    tell("status", Term::Iri(DocentIri("Standby")));
    EXPECT_EQ(Robots()[0].state, RobotRecord::State::kStandby);
    GraphRobotDirectory directory(&dictionary_);
    directory.Refresh(writer_.current(), Delta());
    ASSERT_EQ(directory.Offers("drive").size(), 1u);
    EXPECT_FALSE(directory.Offers("drive")[0].busy);
  }
  tell("currentCommand", Term::Literal("c1"));
  tell("x", Term::Integer(3));
  Lose("urn:r1", 5'000'000);
  EXPECT_EQ(Robots()[0].state, RobotRecord::State::kOffline);
  EXPECT_EQ(Robots()[0].x_m, 3);
  EXPECT_EQ(writer_.current().Count({{}, *dictionary_.FindIri(DocentIri("currentCommand")), {}, {}}), 0u);
}

// An operation of that name is another robot's affair: what is unknown there was repeated because this one may be.
TEST_F(RobotFactsTest, WhetherAnOperationMayBeRepeatedIsSaidByEachRobot) {
  Join(Guide());
  RobotDescription other = Guide();
  other.robot = "urn:r2", other.incarnation = "i2", other.address = "127.0.0.1:10";
  other.operations[0].idempotent = false;
  Join(other);
  WriteBatch batch;  // anybody may tell it, too
  batch.source = "urn:client";
  batch.operations.push_back(
      {QuadOperation::Kind::kAdd,
       {Term::Iri(OperationIri("speak")), Term::Iri(DocentIri("idempotent")), Term::Boolean(true), Term()}});
  Apply(batch);
  GraphRobotDirectory directory(&dictionary_);
  directory.Refresh(writer_.current(), Delta());
  const std::vector<engine::RobotOffer> drive = directory.Offers("drive"), speak = directory.Offers("speak");
  ASSERT_EQ(drive.size(), 2u);
  EXPECT_TRUE(drive[0].idempotent);
  EXPECT_FALSE(drive[1].idempotent);
  ASSERT_EQ(speak.size(), 2u);
  EXPECT_FALSE(speak[0].idempotent);
  EXPECT_FALSE(speak[1].idempotent);
}

TEST_F(RobotFactsTest, AJoinIsReadBack) {
  Join(Guide());
  const std::vector<RobotRecord> robots = Robots();
  ASSERT_EQ(robots.size(), 1u);
  EXPECT_EQ(robots[0].robot, "urn:r1");
  EXPECT_EQ(robots[0].label, "Guide");
  EXPECT_EQ(robots[0].incarnation, "i1");
  EXPECT_EQ(robots[0].address, "127.0.0.1:9");
  EXPECT_EQ(robots[0].state, RobotRecord::State::kStandby);
  EXPECT_THAT(robots[0].operations, ElementsAre("drive", "speak"));
  EXPECT_THAT(RobotsOnline(dictionary_, writer_.current()), ElementsAre("urn:r1"));

  const auto offered = OfferedOperations(dictionary_, writer_.current());
  ASSERT_EQ(offered.size(), 2u);
  for (const rsel::OfferedOperation& operation : offered) {
    EXPECT_EQ(operation.robot, RobotId("urn:r1"));
    EXPECT_TRUE(operation.inputs_known);
    EXPECT_THAT(operation.inputs, ElementsAre(operation.name == "drive" ? "goal" : "text"));
  }
}

// Its lease is waited for after a restart whatever others say: its own word alone ends with it.
TEST_F(RobotFactsTest, WhatOthersTellOfARobotNeitherTakesItOffTheLeasesNorDoublesItsOperations) {
  Join(Guide());
  WriteBatch batch;
  batch.source = "urn:client";
  for (const auto& [predicate, object] :
       {std::pair("status", DocentIri("Offline")), std::pair("offers", OperationIri("drive"))}) {
    batch.operations.push_back(
        {QuadOperation::Kind::kAdd,
         {Term::Iri("urn:r1"), Term::Iri(DocentIri(predicate)), Term::Iri(object), Term()}});
  }
  Apply(batch);
  EXPECT_THAT(RobotsOnline(dictionary_, writer_.current()), ElementsAre("urn:r1"));
  EXPECT_EQ(OfferedOperations(dictionary_, writer_.current()).size(), 2u);
}

TEST_F(RobotFactsTest, AnotherJoinReplacesWhatTheFirstTold) {
  Join(Guide());
  RobotDescription guide = Guide();
  guide.address = "127.0.0.1:10";
  guide.operations.pop_back();
  Join(guide);
  ASSERT_EQ(Robots().size(), 1u);
  EXPECT_EQ(Robots()[0].address, "127.0.0.1:10");
  EXPECT_THAT(Robots()[0].operations, ElementsAre("drive"));
}

TEST_F(RobotFactsTest, ALostRobotIsOfflineUntilItJoinsAgain) {
  Join(Guide());
  Lose("urn:r1", 1'700'000'000'000'000);
  EXPECT_EQ(Robots()[0].state, RobotRecord::State::kOffline);
  EXPECT_EQ(Robots()[0].last_seen_us, 1'700'000'000'000'000);
  EXPECT_EQ(Robots()[0].address, "127.0.0.1:9");
  EXPECT_THAT(RobotsOnline(dictionary_, writer_.current()), IsEmpty());
  Join(Guide());
  EXPECT_EQ(Robots()[0].state, RobotRecord::State::kStandby);
  EXPECT_EQ(Robots()[0].last_seen_us, 0);
}

TEST_F(RobotFactsTest, WhatCannotBeTakenIsLeftOutWithAWarning) {
  RobotDescription guide = Guide();
  guide.type = "no IRI";
  guide.operations.push_back({"drive", {}, {}, false});
  guide.operations.push_back({" ", {}, {}, false});
  guide.operations[0].inputs = {"goal", "goal"};
  std::vector<std::string> warnings;
  const RobotDescription accepted = AcceptedDescription(guide, &warnings);
  EXPECT_EQ(accepted.type, "");
  ASSERT_EQ(accepted.operations.size(), 2u);
  EXPECT_THAT(accepted.operations[0].inputs, ElementsAre("goal"));
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("input \"goal\" of operation drive stands twice"),
                                    HasSubstr("operation \"drive\" stands twice"), HasSubstr("is empty"),
                                    HasSubstr("the type \"no IRI\" is not an absolute IRI")));
}

TEST_F(RobotFactsTest, TypesOfPartsAreReadBackAndReplaced) {
  RobotDescription guide = Guide();
  guide.operations[0].input_types = {{"goal", "docent:Region"}, {"nothing", "xsd:string"}};
  guide.operations[1].outputs = {"file"};
  guide.operations[1].output_types = {{"file", "not an IRI"}};
  guide.operations[1].description = "Speaks";
  std::vector<std::string> warnings;
  Join(AcceptedDescription(guide, &warnings));
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("the type \"not an IRI\" of part file of operation speak")));
  const auto operation = [this](const std::string& name) {
    rsel::OfferedOperation found;
    for (const rsel::OfferedOperation& o : OfferedOperations(dictionary_, writer_.current())) {
      if (o.name == name) found = o;
    }
    return found;
  };
  EXPECT_EQ(operation("drive").input_types, (rsel::PartTypes{{"goal", DocentIri("Region")}}));
  EXPECT_THAT(operation("speak").outputs, ElementsAre("file"));
  EXPECT_THAT(operation("speak").output_types, IsEmpty());
  EXPECT_EQ(operation("speak").description, "Speaks");
  guide.operations[0].input_types = {{"goal", "https://example.org/Goal"}};
  Join(AcceptedDescription(guide, &warnings));
  EXPECT_EQ(operation("drive").input_types, (rsel::PartTypes{{"goal", "https://example.org/Goal"}}));
  Join(Guide());
  EXPECT_THAT(operation("drive").input_types, IsEmpty());
  EXPECT_EQ(dictionary_.FindIri(DocentIri("partType"))
                ? writer_.current().Count({{}, *dictionary_.FindIri(DocentIri("partType")), {}, {}})
                : 0,
            0u)
      << "nothing of a part that has no type any more";
}

TEST_F(RobotFactsTest, ClassesOfOperationsAreReadBackAndReplaced) {
  RobotDescription guide = Guide();
  guide.operations[0].capabilities = {"docent:Navigation", "https://example.org/Tour", "docent:Navigation"};
  guide.operations[1].capabilities = {"no IRI"};
  std::vector<std::string> warnings;
  Join(AcceptedDescription(guide, &warnings));
  EXPECT_THAT(warnings,
              ElementsAre(HasSubstr("capability \"no IRI\" of operation speak is not an absolute IRI")));
  const auto capabilities = [this] { return ReadRobots(dictionary_, writer_.current()).at(0).capabilities; };
  EXPECT_THAT(capabilities(), ElementsAre("https://example.org/Tour", DocentIri("Navigation")));
  EXPECT_THAT(OfferedOperations(dictionary_, writer_.current()).at(0).capabilities,
              testing::UnorderedElementsAre("https://example.org/Tour", DocentIri("Navigation")));
  Join(Guide());
  EXPECT_THAT(capabilities(), IsEmpty());
  EXPECT_THAT(OfferedOperations(dictionary_, writer_.current()).at(0).capabilities, IsEmpty());
}

TEST_F(RobotFactsTest, WhetherTheGraphStillHasWhatARobotSaidIsKnown) {
  const auto has = [this] {
    return HasFacts(FactsOfJoin(Guide(), dictionary_, writer_.current()), dictionary_, writer_.current());
  };
  EXPECT_FALSE(has());
  Join(Guide());
  EXPECT_TRUE(has());
  WriteBatch clear;
  clear.source = "urn:somebody";
  clear.operations = {{QuadOperation::Kind::kRemove,
                       {Term::Iri("urn:r1"), Term::Iri(DocentIri("adapterAddress")),
                        Term::Literal("127.0.0.1:9"), Term::Iri("urn:r1")}}};
  Apply(clear);
  EXPECT_FALSE(has());
  Join(Guide());
  EXPECT_TRUE(has());
}

// Commands would go where somebody else says.
TEST_F(RobotFactsTest, WhereTheAdapterIsTheRobotItselfSays) {
  GraphRobotDirectory directory(&dictionary_);
  Join(Guide());
  WriteBatch lie;
  lie.source = "urn:liar";
  for (const auto& [local, value] : {std::pair("adapterAddress", "127.0.0.1:1"),
                                     std::pair("incarnation", "a"), std::pair("heldBy", "x")}) {
    const bool held = std::string(local) == "heldBy";
    lie.operations.push_back({QuadOperation::Kind::kAdd,
                              {Term::Iri("urn:r1"), Term::Iri(DocentIri(local)),
                               held ? Term::Iri("urn:docent:run:Fake-1") : Term::Literal(value), Term()}});
  }
  const Delta lied = Apply(lie);
  for (const std::vector<AdapterAddress>& found :
       {directory.AddressesIn(lied, writer_.current()), AdapterAddresses(dictionary_, writer_.current())}) {
    ASSERT_THAT(found, testing::Not(IsEmpty()));
    for (const AdapterAddress& adapter : found) {
      EXPECT_EQ(adapter.address, "127.0.0.1:9");
      EXPECT_EQ(adapter.incarnation, "i1");
    }
  }
  const RobotRecord robot = Robots().at(0);
  EXPECT_EQ(robot.address, "127.0.0.1:9");
  EXPECT_EQ(robot.incarnation, "i1");
  EXPECT_EQ(robot.held_by, RunId());
}

TEST_F(RobotFactsTest, TheDirectorySaysWhichAddressesATurnBrought) {
  GraphRobotDirectory directory(&dictionary_);
  EXPECT_THAT(directory.AddressesIn(Delta(), writer_.current()), IsEmpty());
  const Delta joined = Join(Guide());
  const std::vector<AdapterAddress> first = directory.AddressesIn(joined, writer_.current());
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].robot, RobotId("urn:r1"));
  EXPECT_EQ(first[0].address, "127.0.0.1:9");
  EXPECT_EQ(first[0].incarnation, "i1");
  EXPECT_THAT(directory.AddressesIn(Join(Guide()), writer_.current()), IsEmpty()) << "nothing is new";
  RobotDescription reborn = Guide();
  reborn.incarnation = "i2";
  const Delta again = Join(reborn);
  const std::vector<AdapterAddress> second = directory.AddressesIn(again, writer_.current());
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(second[0].address, "127.0.0.1:9");
  EXPECT_EQ(second[0].incarnation, "i2");
  const Delta lost = Lose("urn:r1", 0);
  EXPECT_THAT(directory.AddressesIn(lost, writer_.current()), IsEmpty());
  EXPECT_EQ(AdapterAddresses(dictionary_, writer_.current()).size(), 1u);
}

}  // namespace
}  // namespace docent::server
