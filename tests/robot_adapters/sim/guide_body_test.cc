// The simulated robot closed on its estimated pose, in the hall of scenario s01. No threads, no clock.
#include "robot_adapters/sim/guide_body.h"

#include <iostream>

#include "gtest/gtest.h"

namespace docent::robot {
namespace {

using maps::Pose2;

// The hall and its model, made once: voxelising takes seconds.
struct Hall {
  maps::HallLayout layout;
  std::shared_ptr<const maps::HallModel> model;

  static const Hall& Get() {
    static const Hall hall = [] {
      Hall made;
      auto layout = maps::HallLayout::FromFile(DOCENT_SOURCE_DIR "/scenarios/s01_booth_guide/hall.ttl");
      EXPECT_TRUE(layout.ok()) << layout.status();
      made.layout = *layout;
      auto model = maps::HallModel::FromLayout(made.layout);
      EXPECT_TRUE(model.ok()) << model.status();
      made.model = *model;
      return made;
    }();
    return hall;
  }
  Pose2 ServicePoint(const std::string& name) const {
    const maps::Region* region = layout.FindRegion("https://w3id.org/docent/expo#" + name);
    EXPECT_NE(region, nullptr) << name;
    return *region->service_point;
  }
};

std::unique_ptr<GuideBody> MakeBody(uint64_t seed, const GuideBodySettings& settings = {},
                                    const std::string& start = "RobotDock") {
  const Hall& hall = Hall::Get();
  auto body = GuideBody::Create(hall.model, hall.layout, settings, hall.ServicePoint(start), seed);
  EXPECT_TRUE(body.ok()) << body.status();
  return *std::move(body);
}

void Localise(GuideBody& body) {
  for (int i = 0; i < 400 && !body.localised(); ++i) body.Tick();
  ASSERT_TRUE(body.localised());
}

// Drives to a place; false, with the reason printed, if it does not arrive within `limit_s` simulated
// seconds.
bool Drive(
    GuideBody& body, const Pose2& goal, double limit_s = 180,
    const std::function<std::vector<maps::Disc>()>& people = [] { return std::vector<maps::Disc>(); }) {
  absl::Status begun = body.DriveTo(goal);
  EXPECT_TRUE(begun.ok()) << begun;
  const double end_s = body.time_s() + limit_s;
  while (body.drive().state == DriveStatus::State::kDriving && body.time_s() < end_s) body.Tick(people());
  if (body.drive().state != DriveStatus::State::kArrived) {
    std::cerr << "not arrived: " << body.drive().message << " at " << body.truth().x_m << " "
              << body.truth().y_m << "\n";
  }
  return body.drive().state == DriveStatus::State::kArrived;
}

TEST(GuideBodyTest, FindsItselfWithoutBeingToldWhereItStands) {
  auto body = MakeBody(3);
  Localise(*body);
  EXPECT_LT(maps::Distance(body->estimate().position(), body->truth().position()), 0.1);
}

class GuideBodySeedTest : public testing::TestWithParam<int> {};

TEST_P(GuideBodySeedTest, GuidesAVisitorWithinTheErrorBounds) {
  auto body = MakeBody(static_cast<uint64_t>(GetParam()));
  Localise(*body);
  const Hall& hall = Hall::Get();
  for (const char* place : {"Entrance", "B03"}) {
    const Pose2 goal = hall.ServicePoint(place);
    ASSERT_TRUE(Drive(*body, goal)) << place;
    EXPECT_LT(maps::Distance(body->truth().position(), goal.position()), 0.15) << place;
    EXPECT_LT(std::abs(maps::WrapAngle(body->truth().heading_rad - goal.heading_rad)), 0.12) << place;
  }
  const DriveReport report = body->Report();
  const PathError error = ErrorOf(report.trace);
  std::cout << "seed " << GetParam() << ": " << report.path_m << " m in " << report.simulated_s << " s, RMSE "
            << error.rmse_mm << " mm " << error.rmse_deg << " deg, max " << error.max_error_mm << " mm\n";
  EXPECT_EQ(report.bumps, 0);
  EXPECT_GT(report.path_m, 20);
  EXPECT_LE(error.rmse_mm, 22);
  EXPECT_LE(error.rmse_deg, 0.3);
}

INSTANTIATE_TEST_SUITE_P(FiveSeeds, GuideBodySeedTest, testing::Values(1, 2, 3, 4, 5));

TEST(GuideBodyTest, ReachesEveryBooth) {
  auto body = MakeBody(7);
  Localise(*body);
  const Hall& hall = Hall::Get();
  int booths = 0;
  for (const maps::Region& region : hall.layout.regions) {
    if (!region.is_booth) continue;
    ++booths;
    EXPECT_TRUE(Drive(*body, *region.service_point)) << region.iri;
    EXPECT_LT(maps::Distance(body->truth().position(), region.service_point->position()), 0.15) << region.iri;
    EXPECT_TRUE(maps::Contains(region.outline, body->truth().position())) << region.iri;
  }
  EXPECT_EQ(booths, 12);
  const DriveReport report = body->Report();
  const PathError error = ErrorOf(report.trace);
  std::cout << "12 booths: " << report.path_m << " m in " << report.simulated_s << " s, RMSE "
            << error.rmse_mm << " mm " << error.rmse_deg << " deg, max " << error.max_error_mm
            << " mm, bumps " << report.bumps << "\n";
  EXPECT_EQ(report.bumps, 0);
  EXPECT_LE(error.rmse_mm, 25);
}

TEST(GuideBodyTest, SameSeedSameDrive) {
  std::vector<Pose2> ends;
  for (int run = 0; run < 2; ++run) {
    auto body = MakeBody(11);
    Localise(*body);
    ASSERT_TRUE(Drive(*body, Hall::Get().ServicePoint("Entrance")));
    ends.push_back(body->truth());
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(GuideBodyTest, StopsBeforeAPersonAndGoesOnWhenTheWayIsFree) {
  auto body = MakeBody(5);
  Localise(*body);
  ASSERT_TRUE(body->DriveTo(Hall::Get().ServicePoint("Entrance")).ok());
  // After two metres a person steps right in front of the robot, as wide as the aisle.
  while (maps::Distance(body->truth().position(), Hall::Get().ServicePoint("RobotDock").position()) < 1.5)
    body->Tick();
  const maps::Pose2 ahead = maps::Compose(body->truth(), {1.2, 0, 0});
  std::vector<maps::Disc> wall;
  for (int i = -12; i <= 12; ++i) wall.push_back({maps::Compose(ahead, {0, 0.3 * i, 0}).position(), 0.2});
  double nearest_m = 10;
  for (int i = 0; i < 400; ++i) {
    body->Tick(wall);
    for (const maps::Disc& person : wall) {
      nearest_m =
          std::min(nearest_m, maps::Distance(body->truth().position(), person.center) - person.radius_m);
    }
  }
  EXPECT_EQ(body->drive().state, DriveStatus::State::kDriving);
  EXPECT_GT(nearest_m, body->settings().planner.robot_radius_m);
  for (int i = 0; i < 4000 && body->drive().state == DriveStatus::State::kDriving; ++i) body->Tick();
  EXPECT_EQ(body->drive().state, DriveStatus::State::kArrived) << body->drive().message;
}

TEST(GuideBodyTest, FailsWhenTheWayStaysBlocked) {
  GuideBodySettings settings;
  settings.give_up_after_s = 6;
  auto body = MakeBody(5, settings);
  Localise(*body);
  std::vector<maps::Disc> ring;  // people all round the robot
  for (int i = 0; i < 24; ++i) {
    const double angle = i * 0.2618;
    ring.push_back(
        {{body->truth().x_m + 0.75 * std::cos(angle), body->truth().y_m + 0.75 * std::sin(angle)}, 0.1});
  }
  ASSERT_TRUE(body->DriveTo(Hall::Get().ServicePoint("Entrance")).ok());
  for (int i = 0; i < 1000 && body->drive().state == DriveStatus::State::kDriving; ++i) body->Tick(ring);
  EXPECT_EQ(body->drive().state, DriveStatus::State::kFailed);
  EXPECT_NE(body->drive().message.find("stood in the way"), std::string::npos) << body->drive().message;
}

TEST(GuideBodyTest, RefusesGoalsThatNobodyCanReach) {
  auto body = MakeBody(5);
  EXPECT_TRUE(absl::IsFailedPrecondition(body->DriveTo({5, 5, 0})));  // not localised yet
  Localise(*body);
  EXPECT_TRUE(absl::IsFailedPrecondition(body->DriveTo({-50, 0, 0})));
  EXPECT_TRUE(absl::IsFailedPrecondition(body->DriveTo({1.0, 10.5, 0})));  // in the stair tower
  EXPECT_FALSE(body->DriveTo({std::nan(""), 0, 0}).ok());
}

TEST(GuideBodyTest, HaltStandsStill) {
  auto body = MakeBody(5);
  Localise(*body);
  ASSERT_TRUE(body->DriveTo(Hall::Get().ServicePoint("Entrance")).ok());
  for (int i = 0; i < 60; ++i) body->Tick();
  body->Halt();
  for (int i = 0; i < 40; ++i) body->Tick();
  const Pose2 stood = body->truth();
  for (int i = 0; i < 40; ++i) body->Tick();
  EXPECT_LT(maps::Distance(stood.position(), body->truth().position()), 0.001);
  EXPECT_EQ(body->drive().state, DriveStatus::State::kIdle);
}

TEST(GuideBodyTest, StartInsideAWallIsRefused) {
  const Hall& hall = Hall::Get();
  EXPECT_TRUE(
      absl::IsInvalidArgument(GuideBody::Create(hall.model, hall.layout, {}, {0.9, 11, 0}, 1).status()));
  GuideBodySettings settings;
  settings.tick_s = 1;
  EXPECT_TRUE(
      absl::IsInvalidArgument(GuideBody::Create(hall.model, hall.layout, settings, {5, 5, 0}, 1).status()));
}

}  // namespace
}  // namespace docent::robot
