// Records random stages (recorded_stage.h) and replays their runs, with the document that ran: as it is, with a remark that changes
// nothing, and from a file. Never a difference.
// DOCENT_SIMULATION_SEEDS=2000 plays more seeds, from DOCENT_SIMULATION_FIRST on; DOCENT_SIMULATION_SEED=17 plays one, and tells its
// course. simulation_dice.h says how to leave parts of it out; `scripts/soak replays` does that to a failing one.
#include <algorithm>

#include "absl/strings/str_join.h"
#include "gmock/gmock.h"
#include "kb_server/replay/case_file.h"
#include "kb_server/replay/run_replays.h"
#include "tests/kb_server/replay/recorded_stage.h"

namespace docent::server::test {
namespace {

using ::testing::IsEmpty;

constexpr size_t kRunsOfStage = 2;  // that are replayed, of each stage

std::string ShowDecision(const Decision& decision) {
  return absl::StrCat(decision.turn, " ", decision.time_us, " ", decision.node, ": ", decision.from, " → ",
                      decision.to, " ", decision.cause, decision.command.value(), " ", decision.operation,
                      " ", decision.robot.value());
}

std::vector<std::string> Show(const Course& course) {
  std::vector<std::string> lines;
  for (const Decision& decision : course.decisions) lines.push_back(ShowDecision(decision));
  lines.push_back(absl::StrCat(course.state, ": ", course.reason));
  for (const auto& [name, value] : course.variables)
    lines.push_back(absl::StrCat(name, " = ", ToNTriples(value)));
  for (const auto& [name, value] : course.results)
    lines.push_back(absl::StrCat(name, " → ", ToNTriples(value)));
  return lines;
}

class Replayer {
 public:
  explicit Replayer(RecordedStage* stage) : stage_(*stage) { queries_.Publish(stage->Newest()); }

  void Check(const RunId& run) {
    SCOPED_TRACE(run.value());
    RunReplays replays(
        {stage_.log(), &queries_, &stage_.dictionary(), &stage_.functions(), Limits(), ReplayLimits()});
    const auto plain = replays.Replay(run, "", "", false, &cancellation_);
    ASSERT_TRUE(plain.ok()) << plain.status();
    Expect(*plain, "as it is");
    const RunCase& recorded = plain->recorded;
    const auto remark = replays.Replay(run, recorded.document.text + "<!-- the same -->", "remark.cawl.xml",
                                       false, &cancellation_);
    ASSERT_TRUE(remark.ok()) << remark.status();
    Expect(*remark, "with a remark");
    const std::string text = EncodeCase(recorded);
    auto read = DecodeCase(text, "a.run.json");
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_TRUE(*read == recorded) << "the file says other things";
    EXPECT_EQ(EncodeCase(*read), text);
    PlayOptions options;
    options.functions = &stage_.functions();
    options.cancellation = &cancellation_;
    const auto tested = ReplayCase(*std::move(read), "", "", options);
    ASSERT_TRUE(tested.ok()) << tested.status();
    Expect(*tested, "from a file");
    decisions_ += recorded.course.decisions.size();
  }
  size_t decisions() const { return decisions_; }

 private:
  static void Expect(const Replayed& replayed, const char* how) {
    EXPECT_TRUE(IsSame(replayed.nodes)) << how;
    EXPECT_THAT(replayed.play.notes, IsEmpty()) << how;
    EXPECT_EQ(replayed.play.stopped, "") << how;
    EXPECT_EQ(absl::StrJoin(Show(replayed.play.course), "\n"),
              absl::StrJoin(Show(replayed.recorded.course), "\n"))
        << how;
  }

  RecordedStage& stage_;
  QueryPort queries_;
  Cancellation cancellation_;
  size_t decisions_ = 0;
};

TEST(ReplaysNeverDifferTest, TheDocumentThatRanDoesTheSame) {
  const int only = NumberFromEnvironment("DOCENT_SIMULATION_SEED", -1);
  const int seeds = only < 0 ? NumberFromEnvironment("DOCENT_SIMULATION_SEEDS", 30) : 1;
  const int first = only < 0 ? NumberFromEnvironment("DOCENT_SIMULATION_FIRST", 0) : only;
  size_t decisions = 0;
  for (int seed = first; seed < first + seeds && !HasFailure(); ++seed) {
    SCOPED_TRACE(
        absl::StrCat("DOCENT_SIMULATION_SEED=", seed,
                     " build/dev/bin/tests_kb_server_replay --gtest_filter=", "ReplaysNeverDifferTest.*"));
    RecordedStage stage(static_cast<uint32_t>(seed), only >= 0);
    stage.Play();
    std::vector<RunId> runs = stage.Runs();
    stage.dice()->Begin(RecordedStage::kSteps + 1);
    Replayer replayer(&stage);
    for (size_t left = only < 0 ? kRunsOfStage : runs.size(); left > 0 && !runs.empty() && !HasFailure();
         --left) {
      const auto run = runs.begin() + stage.dice()->Below(static_cast<int>(runs.size()));
      replayer.Check(*run);
      runs.erase(run);
    }
    decisions += replayer.decisions();
  }
  if (only < 0 && first == 0 && seeds >= 30) {
    EXPECT_GT(decisions, 4u * static_cast<size_t>(seeds)) << "it has to try something";
  }
}

}  // namespace
}  // namespace docent::server::test
