// What one turn does for runs is bounded, and costs about as much as the run has nodes.
#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "graph/base/run_limits.h"
#include "tests/workflow/engine/engine_fixture.h"
#include "workflow/engine/engine_state.h"

namespace docent::engine {
namespace {

using ::testing::AllOf;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::Lt;

class EngineBoundsTest : public EngineTest {
 protected:
  // Nodes n0 … one after the other. `backwards`: the last stands first in the document.
  static std::string Chain(int nodes, bool backwards = false) {
    std::string names, links;
    for (int i = 0; i < nodes; ++i) {
      const int n = backwards ? nodes - 1 - i : i;
      absl::StrAppend(&names, "<node name=\"n", n, "\"/>");
      if (i + 1 < nodes) absl::StrAppend(&links, Link(absl::StrCat("n", i), absl::StrCat("n", i + 1)));
    }
    return Flow(absl::StrCat(names, "<sink name=\"t\"/>", Link("s", "n0"), links,
                             Link(absl::StrCat("n", nodes - 1), "t")));
  }
  // So many nodes beside each other between a first and a last one.
  static std::string Fan(int nodes) {
    std::string names = "<node name=\"a\"/>", links = Link("s", "a");
    for (int i = 0; i < nodes; ++i) {
      absl::StrAppend(&names, "<node name=\"n", i, "\"/>");
      absl::StrAppend(&links, Link("a", absl::StrCat("n", i)), Link(absl::StrCat("n", i), "z"));
    }
    return Flow(absl::StrCat(names, "<node name=\"z\"/><sink name=\"t\"/>", links, Link("z", "t")));
  }
  size_t Ended() const {
    size_t ended = 0;
    for (const std::string& transition : transitions_) ended += transition.ends_with(" running>done");
    return ended;
  }
};

TEST_F(EngineBoundsTest, FlowsOfManyNodesEndInOneTurn) {
  for (const std::string& body : {Chain(3990), Chain(3990, true), Fan(3990)}) {
    Deploy(body);
    Start();
    EXPECT_EQ(engine_.live_runs(), 0u);
    EXPECT_GT(Ended(), 3990u);
  }
}

TEST_F(EngineBoundsTest, ARunWithMoreToDoThanATurnAllowsGoesOnInTheNext) {
  Deploy(Chain(3990));
  const RunRequest start{RunRequest::Kind::kStart, "W/F", {}};
  Turn({}, std::vector<RunRequest>(8, start));  // each node changes twice
  EXPECT_GT(engine_.live_runs(), 0u);
  EXPECT_THAT(transitions_.size(), Lt(kRunLimits.node_changes_per_turn + 10000));
  int turns = 1;
  for (; engine_.live_runs() > 0 && turns < 10; ++turns) {
    ASSERT_TRUE(engine_.NextDeadline().has_value());
    EXPECT_LE(*engine_.NextDeadline(), now_us_) << "at once";
    now_us_ += 1000;
    Turn();
  }
  EXPECT_EQ(engine_.live_runs(), 0u);
  EXPECT_THAT(turns, AllOf(Gt(1), Lt(5)));
  EXPECT_FALSE(engine_.NextDeadline().has_value());
}

TEST_F(EngineBoundsTest, ARunThatGoesOnLaterIsInASavedState) {
  Deploy(Chain(3990));
  const RunRequest start{RunRequest::Kind::kStart, "W/F", {}};
  Turn({}, std::vector<RunRequest>(8, start));
  Engine other(&dictionary_, Limits{});
  other.Restore(engine_.Save());
  EXPECT_EQ(other.NextDeadline(), engine_.NextDeadline());
}

TEST_F(EngineBoundsTest, LiveRunsHaveSoManyNodes) {
  std::string body = Chain(3999);
  body.replace(body.find("<node name=\"n0\"/>"), 17, Node("n0", "never", ""));
  Deploy(body);
  const RunRequest start{RunRequest::Kind::kStart, "W/F", {}};
  Turn({}, std::vector<RunRequest>(kRunLimits.nodes_live / 3999, start));
  EXPECT_EQ(engine_.live_runs(), kRunLimits.nodes_live / 3999);
  const absl::Status full = engine_.CheckRequest(start);
  EXPECT_TRUE(absl::IsResourceExhausted(full));
  EXPECT_THAT(std::string(full.message()), HasSubstr("nodes_live"));
  Turn({}, {{RunRequest::Kind::kCancel, "F-1", {}}});
  EXPECT_TRUE(engine_.CheckRequest(start).ok());
}

}  // namespace
}  // namespace docent::engine
