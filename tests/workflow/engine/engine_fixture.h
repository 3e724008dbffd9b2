// Drives an engine as a turn does, with conditions and robots defined by the test.
#ifndef DOCENT_TESTS_WORKFLOW_ENGINE_ENGINE_FIXTURE_H_
#define DOCENT_TESTS_WORKFLOW_ENGINE_ENGINE_FIXTURE_H_

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "tests/workflow/engine/fake_conditions.h"
#include "workflow/cawl/parser.h"
#include "workflow/engine/engine.h"
#include "workflow/engine/engine_state.h"

namespace docent::engine {

// Step until quiet, then Commit.
class EngineTest : public ::testing::Test {
 protected:
  EngineTest() : engine_(&dictionary_, Limits{}) {
    robots_.offers = {{RobotId("urn:r1"), "i1", false, false}};
  }

  void Deploy(const std::string& body) {
    std::string text =
        "<CAWL name=\"W\" namespace=\"urn:w\" version=\"1\" "
        "xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">" +
        body + "</CAWL>";
    cawl::ParsedCawl parsed = cawl::ParseCawl(text, "w.xml");
    ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
    const absl::Status deployed = engine_.Deploy(parsed.document);
    ASSERT_TRUE(deployed.ok()) << deployed;
  }
  static std::string Condition(const std::string& word) {
    return "<condition><context name=\"" + word +
           "\"><rule name=\"r\"><constraint name=\"c\"><subject>?s</subject><verb>&lt;urn:" + word +
           "&gt;</verb><object>?o</object></constraint></rule></context></condition>";
  }
  static std::string Node(const std::string& name, const std::string& condition, const std::string& rest) {
    return "<node name=\"" + name + "\">" + (condition.empty() ? "" : Condition(condition)) + rest +
           "</node>";
  }
  static std::string Link(const std::string& from, const std::string& to, const std::string& more = "") {
    return "<link from=\"" + from + "\" to=\"" + to + "\" " + more + "/>";
  }
  static std::string Flow(const std::string& body) {
    return "<flow name=\"F\"><source name=\"s\"/>" + body + "</flow>";
  }

  // One turn. Its decisions are in transitions_ ("subject from>to"), commands_ and cancels_.
  void Turn(std::vector<CommandReport> reports = {}, std::vector<RunRequest> requests = {}) {
    robots_.asked = 0;
    transitions_.clear();
    commands_.clear();
    cancels_.clear();
    recalls_.clear();
    for (int round = 0; round < Limits{}.engine_rounds_per_turn; ++round) {
      EngineInput input;
      input.now_us = now_us_;
      input.revision = Revision(++revision_);
      input.clock_tick = reports.empty() && requests.empty();
      input.reports = round == 0 ? &reports : nullptr;
      input.requests = round == 0 ? &requests : nullptr;
      input.conditions = &conditions_;
      input.robots = &robots_;
      EngineOutput output = engine_.Step(input);
      conditions_.Take(output);
      for (const auto& t : output.transitions) transitions_.push_back(t.subject + " " + t.from + ">" + t.to);
      commands_.insert(commands_.end(), output.commands.begin(), output.commands.end());
      cancels_.insert(cancels_.end(), output.cancels.begin(), output.cancels.end());
      recalls_.insert(recalls_.end(), output.recalls.begin(), output.recalls.end());
      const std::set<Quad> removed(output.remove.begin(), output.remove.end());
      std::erase_if(facts_, [&removed](const Quad& quad) { return removed.contains(quad); });
      facts_.insert(facts_.end(), output.add.begin(), output.add.end());
      if (output.quiet()) {
        engine_.Commit();
        return;
      }
    }
    FAIL() << "the engine is never quiet";
  }
  void Start() { Turn({}, {{RunRequest::Kind::kStart, "W/F", {}}}); }
  // As a server that starts again from a snapshot; what is saved then is the same.
  void Restart() {
    const auto bytes = EncodeEngineState(engine_.Save());
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    auto state =
        DecodeEngineState(*bytes, Limits{}, &dictionary_, [](const RunId&) { return std::vector<Quad>(); });
    ASSERT_TRUE(state.ok()) << state.status();
    engine_.Restore(*std::move(state));
    EXPECT_EQ(*EncodeEngineState(engine_.Save()), *bytes);
  }
  static CommandReport Done(const CommandId& id) {
    return {id, CommandReport::Outcome::kSucceeded, "", 1, "i1", {}};
  }
  static CommandReport Failed(const CommandId& id, const std::string& why) {
    return {id, CommandReport::Outcome::kFailed, why, 0, "i1", {}};
  }
  bool Says(const std::string& transition) const {
    return std::find(transitions_.begin(), transitions_.end(), transition) != transitions_.end();
  }
  std::string Fact(const std::string& subject, const std::string& predicate) const {
    const auto s = dictionary_.FindIri(subject);
    const auto p = dictionary_.FindIri("https://w3id.org/docent#" + predicate);
    for (const Quad& quad : facts_) {
      if (quad.subject == s && quad.predicate == p) return dictionary_.Decode(quad.object).lexical;
    }
    return "";
  }

  Dictionary dictionary_;
  Engine engine_;
  FakeConditions conditions_;
  FakeRobots robots_;
  TimeMicros now_us_ = 1000000;
  uint64_t revision_ = 0;
  std::vector<std::string> transitions_;
  std::vector<RobotCommand> commands_;
  std::vector<CommandId> cancels_, recalls_;
  std::vector<Quad> facts_;
};

}  // namespace docent::engine

#endif  // DOCENT_TESTS_WORKFLOW_ENGINE_ENGINE_FIXTURE_H_
