// A server's turns and its log, without threads: a visitor who chooses a guide, a robot that comes and leads, and what a replay of
// the run does.
#ifndef DOCENT_TESTS_KB_SERVER_REPLAY_REPLAY_FIXTURE_H_
#define DOCENT_TESTS_KB_SERVER_REPLAY_REPLAY_FIXTURE_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "kb_server/replay/case_file.h"
#include "kb_server/replay/run_replays.h"
#include "kb_server/turn/turn.h"
#include "tests/kb_server/test_world.h"
#include "tests/kb_server/writer_node.h"

namespace docent::server::test {

inline std::string When(const std::string& s, const std::string& v, const std::string& o) {
  return absl::StrCat("<constraint><subject>", s, "</subject><verb>", v, "</verb><object>", o,
                      "</object></constraint>");
}

inline constexpr char kGuide[] = R"(<?xml version="1.0"?>
<CAWL name="Guide" version="1.0" xmlns:w="urn:w:" xmlns:docent="https://w3id.org/docent#" xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <activator name="OnChoice"><activate flow="Guide"/><condition><context name="c"><rule>
    <constraint><subject>?user</subject><verb>docent:chose</verb><object>w:Guide</object></constraint>
  </rule></context></condition></activator>
  <flow name="Guide">
    <variable name="user"/><variable name="robot"/><variable name="booth"/>
    <source name="s"/>
    <node name="Come"><condition><context name="c"><rule>
      <constraint><subject>?robot</subject><verb>docent:status</verb><object>docent:Standby</object></constraint>
      <constraint><subject>$user</subject><verb>docent:isAt</verb><object>?place</object></constraint>
    </rule></context></condition><invoke operation="come"/></node>
    <node name="Lead"><condition ext:timeout="60s"><context name="c"><rule>
      <constraint><subject>$user</subject><verb>docent:selected</verb><object>?booth</object></constraint>
    </rule></context></condition><invoke operation="lead"/><ext:tell at="done">$user w:saw $booth</ext:tell></node>
    <node name="Bye"><condition><context name="c"><rule>
      <constraint><subject>$user</subject><verb>w:saw</verb><object>?what</object></constraint>
    </rule></context></condition><invoke operation="bye"/></node>
    <sink name="e"/>
    <link from="s" to="Come"/><link from="Come" to="Lead"/><link from="Lead" to="Bye"/><link from="Bye" to="e"/>
  </flow>
</CAWL>
)";

class ReplayTest : public ::testing::Test {
 protected:
  using Outcome = CommandReport::Outcome;
  static constexpr TimeMicros kSecond = 1'000'000;

  TurnResult Turn(WriteBatch batch) {
    batch.time_us = now_us_ += kSecond;
    std::string bytes;
    auto result = RunTurn(&stages_, std::move(batch), head_ + 1, &bytes);
    EXPECT_TRUE(result.ok()) << result.status();
    if (!result.ok()) return {};
    EXPECT_TRUE(log_.Append({bytes}, 1, head_).ok());
    ++head_;
    queries_.Publish(result->version);
    for (const RobotCommand& command : result->record.commands) open_[command.operation] = command.id;
    return *std::move(result);
  }
  TurnResult Tell(const std::string& s, const std::string& p, const std::string& o) {
    return Turn(test::Tell({Fact(s, p, o)}));
  }
  TurnResult Answer(const std::string& operation, Outcome outcome = Outcome::kSucceeded) {
    return Turn(Report(open_[operation], outcome));
  }
  TurnResult Tick(TimeMicros after_us = 0) {
    now_us_ += after_us;
    WriteBatch tick;
    tick.clock_tick = true;
    return Turn(std::move(tick));
  }
  void Robot(const std::string& name) {
    std::vector<TermQuad> facts = {Fact(name, "a", "docent:Robot"),
                                   Fact(name, "docent:status", "docent:Standby"),
                                   Fact(name, "docent:incarnation", Term::Literal("i1"))};
    for (const char* operation : {"come", "lead", "bye"})
      facts.push_back(Fact(name, "docent:offers", absl::StrCat("urn:docent:operation:", operation)));
    Turn(test::Tell(facts));
  }
  void Deploy(const std::string& text = kGuide) { Turn(Put(Document::Kind::kCawl, "guide.cawl.xml", text)); }
  void World() {
    Turn(test::Tell({Fact("docent:isAt", "a", "docent:StateProperty"),
                     Fact("docent:selected", "a", "docent:StateProperty"),
                     Fact("docent:status", "a", "docent:StateProperty"),
                     Fact("John", "docent:isAt", "Hall")}));
    Robot("R1");
    Deploy();
  }
  // From the choice to the end.
  void Visit() {
    Tell("John", "docent:chose", "Guide");
    Answer("come");
    Tell("John", "docent:selected", "B03");
    Answer("lead");
    Answer("bye");
  }

  RunReplays::Ports Ports() {
    return {&log_, &queries_, &dictionary_, &functions_, Limits(), ReplayLimits()};
  }
  absl::StatusOr<Replayed> Replay(const std::string& text = "", bool assume_done = false,
                                  const std::string& run = "Guide-1") {
    RunReplays replays(Ports());
    Cancellation cancellation;
    return replays.Replay(RunId(run), text, "edited.cawl.xml", assume_done, &cancellation);
  }
  absl::StatusOr<Trial> TryNode(const std::string& node, std::optional<uint64_t> turn = std::nullopt,
                                const std::string& text = "", const std::string& run = "Guide-1") {
    RunReplays replays(Ports());
    Cancellation cancellation;
    return replays.TryNode(RunId(run), node, turn, text, "edited.cawl.xml", &cancellation);
  }
  // "NODE KIND TURN: RECORDED | REPLAYED" of each difference, in order.
  static std::vector<std::string> Differences(const absl::StatusOr<Replayed>& replayed) {
    EXPECT_TRUE(replayed.ok()) << replayed.status();
    std::vector<std::string> all;
    if (!replayed.ok()) return all;
    for (const NodeComparison& node : replayed->nodes) {
      for (const Difference& d : node.differences)
        all.push_back(absl::StrCat(node.node, " ", d.kind, " ", d.turn, ": ", d.recorded, " | ", d.replayed));
    }
    return all;
  }
  static std::string Edited(const std::string& from, const std::string& to) {
    std::string text = kGuide;
    EXPECT_NE(text.find(from), std::string::npos) << from;
    return absl::StrReplaceAll(text, {{from, to}});
  }

  FakeLog log_;
  QueryPort queries_;
  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  Stages stages_{&dictionary_, &functions_, Limits{}};
  std::map<std::string, CommandId> open_;  // by operation
  uint64_t head_ = 0;
  TimeMicros now_us_ = 1'700'000'000'000'000;
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_REPLAY_REPLAY_FIXTURE_H_
