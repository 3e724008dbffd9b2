#include "robot_adapters/rawlog/log_replay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "robot_adapters/rawlog/reference_track.h"
#include "tests/robot_adapters/rawlog/real_log.h"

namespace docent::robot {
namespace {

// All steps at once.
absl::StatusOr<std::vector<ReplayedStep>> ReplayAll(LogReplay& replay) {
  std::vector<ReplayedStep> steps;
  while (!replay.Done()) {
    absl::StatusOr<ReplayedStep> step = replay.Next();
    if (!step.ok()) return step.status();
    steps.push_back(*step);
  }
  return steps;
}

constexpr char kEastDoors[] = "https://w3id.org/docent/s02#EastDoors";

std::optional<size_t> EntryInReplay(const maps::RegionIndex& regions, const std::string& region,
                                    uint64_t seed) {
  LogReplay replay(Building(), *ReadRawlog(*FindMrptDataset(kLog)), &regions, {}, seed);
  const auto steps = ReplayAll(replay);
  EXPECT_TRUE(steps.ok()) << steps.status();
  for (const ReplayedStep& step : *steps) {
    if (step.region != nullptr && step.region->iri == region) return step.number;
  }
  return std::nullopt;
}

class LogReplayTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(Missing(), "");  // the recording is in the Debian package mrpt-common
  }
};

TEST_F(LogReplayTest, TheRecordingHolds37StepsOfALaserAheadOfTheAxle) {
  const auto drive = ReadRawlog(*FindMrptDataset(kLog));
  ASSERT_TRUE(drive.ok()) << drive.status();
  ASSERT_EQ(drive->steps.size(), 37u);
  EXPECT_EQ(drive->steps[0].time_us, 1137772793094853);
  EXPECT_EQ(drive->steps[0].scan.range_m.size(), 361u);
  EXPECT_NEAR(drive->steps[0].scan.sensor_in_robot.x_m, 0.78, 1e-6);
  EXPECT_NEAR(drive->steps[1].odometry.x_m, 0.181072, 1e-6);
  for (size_t i = 1; i < drive->steps.size(); ++i)
    EXPECT_GT(drive->steps[i].time_us, drive->steps[i - 1].time_us);
  EXPECT_EQ(ReadSimplemap(*FindMrptDataset(kMap))->size(), 72u);
}

TEST_F(LogReplayTest, TheEstimateStaysNearTheRecordedReference) {
  const auto reference = ReadReference(kScenario + "/reference.csv");
  ASSERT_TRUE(reference.ok()) << reference.status();
  for (const uint64_t seed : {1, 2, 3}) {
    LogReplay replay(Building(), *ReadRawlog(*FindMrptDataset(kLog)), nullptr, {}, seed);
    const auto steps = ReplayAll(replay);
    ASSERT_TRUE(steps.ok()) << steps.status();
    ASSERT_EQ(steps->size(), reference->size());
    double squares = 0;
    for (size_t k = 0; k < steps->size(); ++k) {
      EXPECT_EQ((*steps)[k].time_us, (*reference)[k].time_us);
      squares += std::pow(
          maps::Distance((*steps)[k].estimate.pose().position(), (*reference)[k].robot_in_hall.position()),
          2);
    }
    // Both rest on a recorded map that is itself good to a few centimetres.
    EXPECT_LT(std::sqrt(squares / static_cast<double>(steps->size())), 0.06) << "seed " << seed;
    EXPECT_EQ(steps->back().estimate.relocalisations, 0);
  }
}

TEST_F(LogReplayTest, TheRegionIsEnteredWithinOneStepOfTheReference) {
  const maps::HallLayout layout = Layout();
  const maps::RegionIndex regions(layout);
  const auto reference = ReadReference(kScenario + "/reference.csv");
  ASSERT_TRUE(reference.ok()) << reference.status();
  const std::optional<size_t> expected = StepOfEntry(*reference, *layout.FindRegion(kEastDoors));
  ASSERT_TRUE(expected.has_value());
  EXPECT_GT(*expected, 5u) << "the robot comes into the region, it does not begin there";
  for (const uint64_t seed : {1, 2, 3, 4, 5}) {
    const std::optional<size_t> entered = EntryInReplay(regions, kEastDoors, seed);
    ASSERT_TRUE(entered.has_value()) << "seed " << seed;
    EXPECT_LE(std::abs(static_cast<double>(*entered) - static_cast<double>(*expected)), 1) << "seed " << seed;
  }
}

TEST_F(LogReplayTest, ARegionThatIsMovedAwayIsNeverEntered) {
  maps::HallLayout layout = Layout();
  for (maps::Region& region : layout.regions) {
    if (region.iri != kEastDoors) continue;
    for (maps::Point2& corner : region.outline) corner.y_m += 9;
  }
  EXPECT_EQ(EntryInReplay(maps::RegionIndex(layout), kEastDoors, 1), std::nullopt);
}

TEST(RecordedDrive, BadFilesAreRefused) {
  EXPECT_EQ(ReadRawlog("/nonexistent.rawlog").status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ReadSimplemap("/nonexistent.simplemap").status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(FindMrptDataset("no_such_data_set").status().code(), absl::StatusCode::kNotFound);
  const std::string path = ::testing::TempDir() + "/docent_not_a_log.rawlog";
  std::ofstream(path) << "this is not a log";
  EXPECT_EQ(ReadRawlog(path).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(ReadSimplemap(path).status().code(), absl::StatusCode::kInvalidArgument);
  std::remove(path.c_str());
}

}  // namespace
}  // namespace docent::robot
