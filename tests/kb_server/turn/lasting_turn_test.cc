// A workflow that waits for a time, turn by turn: it fires once, at the tick; a snapshot and a replay in
// between give the same decisions.
#include "gmock/gmock.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/store/graph_reader.h"
#include "gtest/gtest.h"
#include "kb_server/turn/turn.h"
#include "kb_server/writer/server_state.h"
#include "tests/kb_server/test_world.h"
#include "tests/kb_server/turn/turn_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::kSecond;
using test::Put;
using test::Tell;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// One run for each person not seen for 30 s, while there is a robot.
constexpr char kLost[] = R"(<?xml version="1.0"?>
<CAWL name="Lost" namespace="urn:w:" version="1.0" xmlns:docent="https://w3id.org/docent#"
      xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <activator name="Unseen">
    <activate flow="Search"/>
    <condition><context name="Unseen">
      <rule name="unseen" expression="person and not seen" ext:for="30s">
        <constraint name="person"><subject>?person</subject><verb>a</verb><object>docent:Visitor</object></constraint>
        <constraint name="seen"><subject>?camera</subject><verb>docent:sees</verb><object>?person</object></constraint>
      </rule>
      <rule name="robot"><constraint name="robot">
        <subject>&lt;urn:w:R1&gt;</subject><verb>docent:status</verb><object>docent:Standby</object>
      </constraint></rule>
    </context></condition>
  </activator>
  <flow name="Search">
    <variable name="person"/>
    <source name="start"/>
    <node name="Look"><invoke operation="greet"/></node>
    <sink name="end"/>
    <link from="start" to="Look"/>
    <link from="Look" to="end"/>
  </flow>
</CAWL>
)";

struct Side {
  Dictionary dictionary;
  sparql::FunctionRegistry functions;
  std::unique_ptr<Stages> stages = std::make_unique<Stages>(&dictionary, &functions, Limits());
  RequestMemory requests{10};
  uint64_t head = 0;

  TurnResult Turn(WriteBatch batch, TimeMicros time_us) {
    batch.time_us = time_us;
    auto result = RunTurn(stages.get(), std::move(batch), head + 1);
    EXPECT_TRUE(result.ok()) << result.status();
    if (result.ok()) ++head;
    return result.ok() ? *std::move(result) : TurnResult();
  }
};

WriteBatch Tick() {
  WriteBatch tick;
  tick.clock_tick = true;
  return tick;
}

// A node that opens when a visitor was at the door for 10 s and the door was open for 20 s.
constexpr char kDoor[] = R"(<CAWL name="Door" xmlns:w="urn:w:" xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <flow name="Door">
    <source name="s"/>
    <node name="N"><condition><context>
      <rule ext:for="10s"><constraint><subject>?who</subject><verb>w:at</verb><object>w:Door</object></constraint></rule>
      <rule ext:for="20s"><constraint><subject>w:Door</subject><verb>w:is</verb><object>w:Open</object></constraint></rule>
    </context></condition></node>
    <sink name="e"/>
    <link from="s" to="N"/><link from="N" to="e"/>
  </flow>
</CAWL>
)";

TEST(LastingTurnTest, TheGraphSaysWhenANodeThatWaitsWillOpen) {
  Side side;
  const auto opens = [&side]() -> TimeMicros {
    const GraphReader graph(side.dictionary, side.stages->writer.current());
    const std::string at = graph.Object("urn:docent:run:Door-1/N", DocentIri("opensAt"));
    return at.empty() ? 0 : MicrosOfDateTime(at);
  };
  side.Turn(Put(Document::Kind::kCawl, "door.xml", kDoor), kSecond);
  side.Turn(test::Start("Door"), 2 * kSecond);
  EXPECT_EQ(opens(), 0);
  side.Turn(Tell({Fact("Door", "is", "Open")}), 10 * kSecond);
  EXPECT_EQ(opens(), 0) << "nobody is there";
  side.Turn(Tell({Fact("Ann", "at", "Door")}), 15 * kSecond);
  EXPECT_EQ(opens(), 30 * kSecond) << "both have to have held";
  side.Turn(Tell({Fact("Bob", "at", "Door")}, {Fact("Ann", "at", "Door")}), 25 * kSecond);
  EXPECT_EQ(opens(), 35 * kSecond);
  side.Turn(Tell({}, {Fact("Door", "is", "Open")}), 26 * kSecond);
  EXPECT_EQ(opens(), 0);
  side.Turn(Tell({Fact("Door", "is", "Open")}), 30 * kSecond);
  EXPECT_EQ(opens(), 50 * kSecond);
  EXPECT_THAT(side.Turn(Tick(), 50 * kSecond).record.transitions, ::testing::Not(IsEmpty()));
  EXPECT_EQ(opens(), 0);
}

TEST(LastingTurnTest, WhoWasNotSeenForTheTimeStartsOneRunAtTheTick) {
  Side side;
  side.Turn(test::WorldFacts(), kSecond);
  side.Turn(Put(Document::Kind::kCawl, "lost.xml", kLost), 2 * kSecond);
  EXPECT_EQ(side.stages->NextDeadline(), std::nullopt);
  side.Turn(Tell({Fact("Ann", "a", "docent:Visitor"), Fact("Bob", "a", "docent:Visitor")}), 10 * kSecond);
  EXPECT_EQ(side.stages->NextDeadline(), 40 * kSecond);
  side.Turn(Tell({Fact("C1", "docent:sees", "Bob")}), 20 * kSecond);
  EXPECT_THAT(side.Turn(Tick(), 39 * kSecond).record.commands, IsEmpty());
  const TurnResult ann = side.Turn(Tick(), 40 * kSecond);
  ASSERT_EQ(ann.record.commands.size(), 1u);
  EXPECT_THAT(ann.record.commands[0].id.value(), ::testing::HasSubstr("Search-1"));
  EXPECT_EQ(side.stages->NextDeadline(), 340 * kSecond) << "Bob is seen: only the command has a deadline";
  EXPECT_THAT(side.Turn(Tick(), 100 * kSecond).record.commands, IsEmpty()) << "once";

  side.Turn(Tell({}, {Fact("C1", "docent:sees", "Bob")}), 110 * kSecond);
  side.Turn(Tell({Fact("C2", "docent:sees", "Bob")}), 139 * kSecond);
  side.Turn(Tell({}, {Fact("C2", "docent:sees", "Bob")}), 141 * kSecond);
  EXPECT_THAT(side.Turn(Tick(), 170 * kSecond).record.transitions, IsEmpty()) << "seen 29 s ago";
  EXPECT_EQ(side.stages->NextDeadline(), 171 * kSecond);
  EXPECT_THAT(side.Turn(Tick(), 171 * kSecond).record.transitions, ::testing::Not(IsEmpty()));
}

TEST(LastingTurnTest, ASnapshotInBetweenKeepsTheTime) {
  Side side, other;
  side.Turn(test::WorldFacts(), kSecond);
  side.Turn(Put(Document::Kind::kCawl, "lost.xml", kLost), 2 * kSecond);
  side.Turn(Tell({Fact("Ann", "a", "docent:Visitor")}), 10 * kSecond);
  const auto bytes = EncodeState(
      TakeState(*side.stages, side.requests, side.stages->writer.Freeze(Revision(side.head)), 10 * kSecond),
      side.dictionary);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  auto restored = DecodeState(*bytes, &other.dictionary, &other.functions, Limits());
  ASSERT_TRUE(restored.ok()) << restored.status();
  other.stages = std::move(restored->stages);
  other.head = restored->offset;
  EXPECT_EQ(other.stages->NextDeadline(), 40 * kSecond);
  for (const TimeMicros time_us : {25 * kSecond, 39 * kSecond, 40 * kSecond, 41 * kSecond}) {
    EXPECT_EQ(side.Turn(Tick(), time_us).record, other.Turn(Tick(), time_us).record) << time_us;
  }
  EXPECT_EQ(other.stages->engine.live_runs(), 1u);
}

}  // namespace
}  // namespace docent::server
