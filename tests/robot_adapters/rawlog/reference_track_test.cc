#include "robot_adapters/rawlog/reference_track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace docent::robot {
namespace {

using ::testing::HasSubstr;

class ReferenceTrackTest : public ::testing::Test {
 protected:
  ReferenceTrackTest() { std::filesystem::create_directories(folder_); }
  ~ReferenceTrackTest() override { std::filesystem::remove_all(folder_); }
  std::string ErrorFor(const std::string& text) {
    std::ofstream(path_) << text;
    const auto poses = ReadReference(path_);
    return poses.ok() ? "no error" : std::string(poses.status().message());
  }
  // Of this process: tests run beside each other.
  const std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) /
                                        ("docent_reference_track_test_" + std::to_string(getpid()));
  const std::string path_ = (folder_ / "reference.csv").string();
};

TEST_F(ReferenceTrackTest, ReadsWhatItWrites) {
  const std::vector<ReferencePose> poses = {{0, 1137772793094853, {1.25, -2.5, 0.125}, 0.01},
                                            {1, 1137772793295141, {2, 3, -3}, 0}};
  ASSERT_TRUE(WriteReference(path_, {"how it was made"}, poses).ok());
  const auto read = ReadReference(path_);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->size(), 2u);
  EXPECT_EQ((*read)[0].time_us, 1137772793094853);
  EXPECT_EQ((*read)[0].robot_in_hall, (maps::Pose2{1.25, -2.5, 0.125}));
  EXPECT_EQ((*read)[1].step, 1u);
}

TEST_F(ReferenceTrackTest, ErrorsNameTheLine) {
  EXPECT_THAT(ErrorFor("# only a comment\n"), HasSubstr("no pose"));
  EXPECT_THAT(ErrorFor("a,b\n"), HasSubstr("reference.csv:1: expected step,time_us"));
  EXPECT_THAT(ErrorFor("step,time_us,x_m,y_m,heading_rad,spread_m\n1,2,3,4,5\n"),
              HasSubstr(":2: expected six numbers"));
  EXPECT_THAT(ErrorFor("step,time_us,x_m,y_m,heading_rad,spread_m\n1,2,3,x,5,6\n"), HasSubstr(":2:"));
  EXPECT_EQ(ReadReference("/nonexistent.csv").status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(WriteReference("/nonexistent/x.csv", {}, {}).code(), absl::StatusCode::kUnavailable);
}

TEST_F(ReferenceTrackTest, TheFirstStepInsideIsTheEntry) {
  maps::Region region;
  region.outline = {{1, -1}, {2, -1}, {2, 1}, {1, 1}};
  const std::vector<ReferencePose> poses = {
      {0, 0, {0, 0, 0}, 0}, {1, 0, {1.5, 0, 0}, 0}, {2, 0, {1.7, 0, 0}, 0}};
  EXPECT_EQ(StepOfEntry(poses, region), 1u);
  region.outline = {{11, -1}, {12, -1}, {12, 1}, {11, 1}};
  EXPECT_EQ(StepOfEntry(poses, region), std::nullopt);
}

}  // namespace
}  // namespace docent::robot
