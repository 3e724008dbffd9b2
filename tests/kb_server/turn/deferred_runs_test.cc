// Runs that have more to do than a turn allows go on in the next turns; and a server that is started again after each turn
// decides the same.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "graph/base/run_limits.h"
#include "graph/base/workflow_limits.h"
#include "graph/log/turn_record.h"
#include "kb_server/door/workflow_removal.h"
#include "kb_server/turn/turn.h"
#include "kb_server/writer/server_state.h"
#include "tests/kb_server/test_world.h"
#include "workflow/engine/engine_state.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using ::testing::HasSubstr;
using ::testing::Le;

struct World {
  Dictionary dictionary;
  sparql::FunctionRegistry functions;
  std::unique_ptr<Stages> stages = std::make_unique<Stages>(&dictionary, &functions, Limits());

  void Restart(uint64_t head, TimeMicros now_us) {
    auto bytes = EncodeState(
        TakeState(*stages, RequestMemory(10), stages->writer.Freeze(Revision(head)), now_us), dictionary);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    auto state = DecodeState(*bytes, &dictionary, &functions, Limits());
    ASSERT_TRUE(state.ok()) << state.status();
    stages = std::move(state->stages);
  }
};

class DeferredRunsTest : public ::testing::Test {
 protected:
  // In both worlds. What the turn decided.
  log::TurnRecord Turn(WriteBatch batch) {
    batch.time_us = now_us_ += 1000;
    auto result = RunTurn(lives_.stages.get(), batch, head_ + 1);
    auto again = RunTurn(restarts_.stages.get(), std::move(batch), head_ + 1);
    EXPECT_TRUE(result.ok()) << result.status();
    EXPECT_EQ(result.status(), again.status());
    if (!result.ok() || !again.ok()) return {};
    ++head_;
    EXPECT_EQ(log::DecisionDifference(result->record, again->record).value_or(""), "");
    restarts_.Restart(head_, now_us_);
    most_ = std::max(most_, result->record.transitions.size());
    return std::move(result->record);
  }
  bool IsDue() const {
    const auto next = lives_.stages->NextDeadline();
    EXPECT_EQ(next, restarts_.stages->NextDeadline());
    return next && *next <= now_us_;
  }
  // The clock's turns, as long as one is due. How many.
  int Settle(int most = 100) {
    int turns = 0;
    for (; turns < most && IsDue(); ++turns) {
      WriteBatch tick;
      tick.clock_tick = true;
      Turn(std::move(tick));
    }
    EXPECT_FALSE(IsDue());
    return turns;
  }
  size_t live_runs() const { return lives_.stages->engine.live_runs(); }
  size_t Count(const std::string& predicate, const Term& object) const {
    const auto p = lives_.dictionary.FindIri(test::Name(predicate));
    const auto o = lives_.dictionary.Find(object);
    return p && o ? lives_.stages->writer.current().Count({{}, *p, *o, {}}) : 0;
  }
  static WriteBatch Facts(int first, int count, const std::string& predicate, bool adds = true) {
    WriteBatch batch;
    for (int i = first; i < first + count; ++i) {
      batch.operations.push_back({adds ? QuadOperation::Kind::kAdd : QuadOperation::Kind::kRemove,
                                  Fact(absl::StrCat("x", i), predicate, absl::StrCat("y", i))});
    }
    return batch;
  }

  World lives_, restarts_;
  uint64_t head_ = 0;
  TimeMicros now_us_ = 1'700'000'000'000'000;
  size_t most_ = 0;  // transitions of one turn
};

std::string Document(const std::string& name, const std::string& body) {
  return absl::StrCat("<CAWL name=\"", name,
                      "\" xmlns:docent=\"https://w3id.org/docent#\" xmlns:w=\"urn:w:\" "
                      "xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">",
                      body, "</CAWL>");
}

std::string Condition(const std::string& subject, const std::string& verb, const std::string& object) {
  return absl::StrCat("<condition><context name=\"c\"><rule name=\"r\"><constraint name=\"k\"><subject>",
                      subject, "</subject><verb>", verb, "</verb><object>", object,
                      "</object></constraint></rule></context></condition>");
}

std::string Activator(const std::string& flow, const std::string& condition) {
  return absl::StrCat("<activator name=\"A\"><activate flow=\"", flow, "\"/>", condition, "</activator>");
}

std::string Link(const std::string& from, const std::string& to, const std::string& more = "") {
  return absl::StrCat("<link from=\"", from, "\" to=\"", to, "\"", more, "/>");
}

// Nodes n0 … one after the other, each with `inside`.
std::string Chain(const std::string& name, int nodes, const std::string& inside = "") {
  std::string names, links = Link("s", "n0");
  for (int i = 0; i < nodes; ++i) {
    absl::StrAppend(&names, "<node name=\"n", i, "\">", inside, "</node>");
    absl::StrAppend(&links, Link(absl::StrCat("n", i), i + 1 < nodes ? absl::StrCat("n", i + 1) : "t"));
  }
  return absl::StrCat("<flow name=\"", name, "\"><source name=\"s\"/>", names, "<sink name=\"t\"/>", links,
                      "</flow>");
}

// Beside what a run with one node does at once.
constexpr size_t kMost = kRunLimits.node_changes_per_turn + 10000;

TEST_F(DeferredRunsTest, AnActivatorStartsAChainOfFourThousandNodes) {
  Turn(Put(Document::Kind::kCawl, "w.xml",
           Document("W", Activator("F", Condition("?a", "w:in", "?b")) +
                             Chain("F", static_cast<int>(kWorkflowLimits.flow_nodes)))));
  Turn(Facts(0, 1, "in"));
  EXPECT_EQ(Settle(), 0) << "one run is done in its turn";
  EXPECT_EQ(live_runs(), 0u);
  Turn(Facts(1, 10, "in"));
  EXPECT_GT(Settle(), 1);
  EXPECT_EQ(live_runs(), 0u);
  EXPECT_EQ(Count("docent:runState", Term::Literal("done")), 11u);
  EXPECT_THAT(most_, Le(kMost));
}

TEST_F(DeferredRunsTest, ADocumentOfALogIsTakenWhateverItsSize) {
  Turn(Put(Document::Kind::kCawl, "w.xml",
           Document("W", Chain("F", static_cast<int>(kWorkflowLimits.flow_nodes) * 3))));
  Turn(test::Start("W"));
  Settle();
  EXPECT_EQ(live_runs(), 0u);
}

TEST_F(DeferredRunsTest, WhatOthersSendIsDoneBeforeARunHasEnded) {
  Turn(Put(Document::Kind::kCawl, "w.xml",
           Document("W", Activator("F", Condition("?a", "w:in", "?b")) + Chain("F", 3000))));
  Turn(Put(Document::Kind::kCawl, "v.xml",
           Document("V", Activator("F", Condition("?a", "w:out", "?b")) + Chain("F", 1))));
  Turn(Facts(0, 10, "in"));
  ASSERT_TRUE(IsDue());
  const size_t before = Count("docent:nodeState", Term::Literal("done"));
  Turn(Facts(0, 1, "out"));
  EXPECT_GT(live_runs(), 0u);
  EXPECT_EQ(Count("docent:nodeState", Term::Literal("done")), before + 1)
      << "others do not wait for the rest";
  Settle();
  EXPECT_EQ(live_runs(), 0u);
  EXPECT_EQ(Count("docent:workflow", Term::Literal("V")), 1u);
  EXPECT_THAT(most_, Le(kMost));
}

TEST_F(DeferredRunsTest, EventsThatComeWhileARunIsDeferredOpenItsNode) {
  const std::string event = "<condition><case name=\"c\"><event operation=\"bell\"/></case></condition>";
  Turn(Put(Document::Kind::kCawl, "e.xml",
           Document("E", "<flow name=\"F\"><source name=\"s\"/><node name=\"n\">" + event +
                             "</node><sink name=\"t\"/>" + Link("s", "n") + Link("n", "t") + "</flow>")));
  Turn(Put(Document::Kind::kCawl, "w.xml",
           Document("W", Activator("F", Condition("?a", "w:in", "?b")) + Chain("F", 3000))));
  Turn(test::Start("E"));
  WriteBatch batch = Facts(0, 10, "in");
  batch.operations.push_back({QuadOperation::Kind::kAdd, Fact("ring", "a", "docent:Event")});
  batch.operations.push_back(
      {QuadOperation::Kind::kAdd, Fact("ring", "docent:operation", Term::Literal("bell"))});
  Turn(std::move(batch));
  Settle();
  EXPECT_EQ(live_runs(), 0u);
}

TEST_F(DeferredRunsTest, LoopsOverManyNodesComeToAnEnd) {
  // The loop goes on as long as a fact is there, and nothing takes it away.
  Turn(Facts(0, 1, "on"));
  std::string flow = Chain("F", 500);
  const std::string last = Link("n499", "t");
  flow.replace(flow.find(last), last.size(), last + Link("n499", "n0", " ext:while=\"w:x0 w:on ?y\""));
  Turn(Put(Document::Kind::kCawl, "w.xml", Document("W", flow)));
  for (int i = 0; i < 5; ++i) Turn(test::Start("W"));
  WriteBatch five;
  for (int i = 0; i < 5; ++i) five.run_requests.push_back({RunRequest::Kind::kStart, "W", {}});
  Turn(std::move(five));
  Turn(Facts(0, 1, "on", false));
  Settle();
  EXPECT_EQ(live_runs(), 0u);
  EXPECT_THAT(most_, Le(kMost));
}

TEST_F(DeferredRunsTest, SubflowsInsideEachOtherAreStartedOverTurns) {
  // each node starts two of the next level: 2^12 runs of the last
  std::string flows;
  for (int level = 0; level < 13; ++level) {
    const std::string invoke = absl::StrCat("<invoke subflow=\"F", level + 1, "\"/>");
    absl::StrAppend(&flows, Chain(absl::StrCat("F", level), 1, level < 12 ? invoke + invoke : ""));
  }
  Turn(Put(Document::Kind::kCawl, "w.xml", Document("W", flows)));
  Turn(test::Start("W/F0"));
  Settle();
  EXPECT_EQ(live_runs(), 0u);
  EXPECT_THAT(most_, Le(kMost));
}

TEST_F(DeferredRunsTest, SubflowsOfManyNodesAreStartedOverTurns) {
  const std::string invoke = "<invoke subflow=\"G\"/>";
  std::string all;
  for (int i = 0; i < 20; ++i) all += invoke;
  Turn(Put(Document::Kind::kCawl, "w.xml", Document("W", Chain("F", 1, all) + Chain("G", 2000))));
  Turn(test::Start("W/F"));
  EXPECT_GT(Settle(), 1);
  EXPECT_EQ(live_runs(), 0u);
  EXPECT_EQ(Count("docent:runState", Term::Literal("done")), 21u);
  EXPECT_THAT(most_, Le(kMost));
}

TEST_F(DeferredRunsTest, ManyConditionsAreArmedOverTurns) {
  // 600 nodes beside each other, each with a condition of 16 alternatives
  std::string contexts;
  for (int i = 0; i < 16; ++i) {
    absl::StrAppend(&contexts, "<context name=\"c", i,
                    "\"><rule name=\"r\"><constraint name=\"k\"><subject>?a</subject><verb>w:v", i,
                    "</verb><object>$run</object></constraint></rule></context>");
  }
  std::string nodes, links;
  for (int i = 0; i < 600; ++i) {
    absl::StrAppend(&nodes, "<node name=\"n", i, "\"><condition>", contexts, "</condition></node>");
    absl::StrAppend(&links, Link("s", absl::StrCat("n", i)), Link(absl::StrCat("n", i), "t"));
  }
  Turn(Put(
      Document::Kind::kCawl, "w.xml",
      Document("W",
               absl::StrCat(
                   "<flow name=\"F\"><variable name=\"run\"><initialize><from expression=\"1\"/></initialize>"
                   "</variable><source name=\"s\"/>",
                   nodes, "<sink name=\"t\"/>", links, "</flow>"))));
  Turn(test::Start("W"));
  ASSERT_TRUE(IsDue());
  const size_t at_once = lives_.stages->engine.Save().next_handle;
  EXPECT_THAT(at_once, Le(kRunLimits.node_changes_per_turn / 8));
  Settle();
  EXPECT_EQ(lives_.stages->engine.Save().next_handle, 9601u);
  WriteBatch batch;
  batch.operations.push_back({QuadOperation::Kind::kAdd, Fact("x", "v7", Term::Integer(1))});
  Turn(std::move(batch));
  Settle();
  EXPECT_EQ(live_runs(), 0u);
}

TEST_F(DeferredRunsTest, NodesWithoutConditionsBesideEachOtherOpenOverTurns) {
  std::string nodes, links, invokes;
  for (int i = 0; i < 100; ++i) invokes += "<invoke operation=\"greet\"/>";
  for (int i = 0; i < 600; ++i) {
    absl::StrAppend(&nodes, "<node name=\"n", i, "\">", invokes, "</node>");
    absl::StrAppend(&links, Link("s", absl::StrCat("n", i)), Link(absl::StrCat("n", i), "t"));
  }
  Turn(Put(Document::Kind::kCawl, "w.xml",
           Document("W", absl::StrCat("<flow name=\"F\"><source name=\"s\"/>", nodes, "<sink name=\"t\"/>",
                                      links, "</flow>"))));
  Turn(test::Start("W"));
  ASSERT_TRUE(IsDue());
  Settle();
  EXPECT_EQ(Count("docent:invocationState", Term::Literal("pending")), 60000u);
}

TEST_F(DeferredRunsTest, ANodeHasSoManyInvocations) {
  Turn(Facts(0, 1500, "in"));
  const auto each = [](int invokes) {
    std::string all;
    for (int i = 0; i < invokes; ++i) all += "<invoke operation=\"greet\"/>";
    return Document(
        "W", absl::StrCat("<flow name=\"F\"><source name=\"s\"/><node name=\"n\" ext:forEach=\"?a\">",
                          Condition("?a", "w:in", "?b"), all, "</node><sink name=\"t\"/>", Link("s", "n"),
                          Link("n", "t"), "</flow>"));
  };
  Turn(Put(Document::Kind::kCawl, "w.xml", each(2)));
  Turn(test::Start("W"));
  EXPECT_EQ(Count("docent:invocationState", Term::Literal("pending")), 3000u);
  const auto why_failed = [&](int invokes) {
    Turn(Put(Document::Kind::kCawl, "w.xml", each(invokes)));
    const log::TurnRecord record = Turn(test::Start("W"));
    const auto failed = std::find_if(record.transitions.begin(), record.transitions.end(),
                                     [](const Transition& t) { return t.to == "failed"; });
    return failed == record.transitions.end() ? "" : failed->cause;
  };
  EXPECT_THAT(why_failed(7), HasSubstr("it would have 10500 invocations: 7 for each of 1500 bindings"));
  Turn(Facts(1500, 10001, "in"));
  EXPECT_THAT(why_failed(1),
              HasSubstr("ext:forEach has more than 10000 matches; the limit node_invocations"));
}

TEST_F(DeferredRunsTest, AConditionKeepsTheMatchesOfAGraphThatWasLarger) {
  // Matches are pairs of facts: 350 * 350, more than condition_matches and fewer than the graph has facts.
  const std::string pairs =
      "<condition><context name=\"c\"><rule name=\"r\"><constraint "
      "name=\"k\"><subject>?a</subject><verb>w:in</verb>"
      "<object>?b</object></constraint><constraint "
      "name=\"l\"><subject>?c</subject><verb>w:in</verb><object>?d</object>"
      "</constraint></rule></context></condition>";
  Turn(Put(Document::Kind::kCawl, "w.xml", Document("W", Activator("F", pairs) + Chain("F", 1))));
  WriteBatch disabled;
  disabled.documents.push_back(
      {Document::Kind::kCawl, Document::Action::kRemove, "W", std::string(kRemovesStarts)});
  Turn(std::move(disabled));
  Turn(Facts(0, 130000, "other"));
  Turn(Facts(0, 350, "in"));
  EXPECT_EQ(lives_.stages->standing_conditions.size(), 1u);
  Turn(Facts(0, 130000, "other", false));
  Turn(Facts(0, 10, "out"));
  EXPECT_EQ(lives_.stages->standing_conditions.size(), 1u) << "none came since";
  Turn(Facts(350, 1, "in"));
  EXPECT_EQ(lives_.stages->standing_conditions.size(), 0u);
}

}  // namespace
}  // namespace docent::server
