#include "robot_adapters/rawlog/log_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/robot_adapters/rawlog/real_log.h"

namespace docent::robot {
namespace {

using ::testing::HasSubstr;

class LogRobotTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = Missing(); !missing.empty()) GTEST_SKIP() << missing;
    std::filesystem::create_directories(folder_);
    options_.adapter.robot = "https://w3id.org/docent/s02#Recorded";
    options_.adapter.server = "127.0.0.1:1";  // nobody: the robot lives its recording all the same
    options_.adapter.linger = absl::ZeroDuration();
    options_.layout_path = kScenario + "/layout.ttl";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) / "docent_log_robot_test";
  LogRobotOptions options_;
};

TEST_F(LogRobotTest, LivesTheRecordingInItsOwnTimeAndReportsIt) {
  options_.speed = 2;
  auto robot = LogRobot::Start(options_);
  ASSERT_TRUE(robot.ok()) << robot.status();
  std::chrono::microseconds slept{0};
  const absl::Status status = (*robot)->Replay([&slept](std::chrono::microseconds pause) {
    slept += pause;
    return true;
  });
  ASSERT_TRUE(status.ok()) << status;
  const std::vector<ReplayedStep> steps = (*robot)->Steps();
  ASSERT_EQ(steps.size(), 37u);
  EXPECT_NEAR(static_cast<double>(slept.count()), static_cast<double>(steps.back().time_us - steps.front().time_us) / 2, 100);

  ASSERT_TRUE((*robot)->WriteReport(folder_.string()).ok());
  std::ostringstream report;
  report << std::ifstream(folder_ / "report.json").rdbuf();
  EXPECT_THAT(report.str(), HasSubstr("\"steps\": 37"));
  EXPECT_THAT(report.str(), HasSubstr("s02#EastDoors"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "path.png"));
  EXPECT_FALSE((*robot)->WriteReport("/nonexistent").ok());
}

TEST_F(LogRobotTest, StopsWhenAsked) {
  auto robot = LogRobot::Start(options_);
  ASSERT_TRUE(robot.ok()) << robot.status();
  int pauses = 0;
  EXPECT_EQ((*robot)->Replay([&pauses](std::chrono::microseconds) { return ++pauses <= 5; }).code(),
            absl::StatusCode::kCancelled);
  EXPECT_EQ((*robot)->Steps().size(), 5u);
}

TEST_F(LogRobotTest, BadOptionsAreSaid) {
  options_.speed = 0;
  EXPECT_EQ(LogRobot::Start(options_).status().code(), absl::StatusCode::kInvalidArgument);
  options_.speed = 1;
  options_.layout_path = "/nonexistent.ttl";
  EXPECT_EQ(LogRobot::Start(options_).status().code(), absl::StatusCode::kNotFound);
  options_.layout_path = kScenario + "/layout.ttl";
  options_.map_path = "/nonexistent.simplemap";
  EXPECT_EQ(LogRobot::Start(options_).status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace docent::robot
