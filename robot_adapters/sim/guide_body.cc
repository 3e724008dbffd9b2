#include "robot_adapters/sim/guide_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"

namespace docent::robot {

using maps::Point2;
using maps::Pose2;

namespace {

// Seeds of three random sequences that must differ: scans, wheels, particles.
constexpr uint64_t kWheelStream =
    0x9E3779B97F4A7C15;  // the golden ratio, as in Knuth's multiplicative hashing
constexpr uint64_t kLocaliserStream = 0xC2B2AE3D27D4EB4F;

// Seen obstacles within this distance count for a new plan.
constexpr double kObstacleRangeM = 4.0;
// A scanned point at least this far from any mapped surface is not in the map.
constexpr double kUnmappedM = 0.25;
// Below this speed the robot counts as standing, and its trace does not grow.
constexpr double kMovingMPerS = 0.01;
constexpr double kMovingRadPerS = 0.01;

}  // namespace

absl::StatusOr<std::unique_ptr<GuideBody>> GuideBody::Create(std::shared_ptr<const maps::HallModel> hall,
                                                             const maps::HallLayout& layout,
                                                             const GuideBodySettings& settings,
                                                             const Pose2& start_in_hall, uint64_t seed) {
  for (absl::Status status :
       {Validate(settings.localiser), Validate(settings.planner), Validate(settings.follower)}) {
    if (!status.ok()) return status;
  }
  if (!(settings.tick_s >= 0.01 && settings.tick_s <= 0.2) || settings.ticks_per_scan < 1 ||
      settings.ticks_per_scan > 50) {
    return absl::InvalidArgumentError(
        absl::StrFormat("tick_s = %g is not within 0.01..0.2, or ticks_per_scan = %d not within 1..50",
                        settings.tick_s, settings.ticks_per_scan));
  }
  auto body =
      std::unique_ptr<GuideBody>(new GuideBody(std::move(hall), layout, settings, start_in_hall, seed));
  if (body->scanner_.Collides(start_in_hall.position(), settings.planner.robot_radius_m)) {
    return absl::InvalidArgumentError(absl::StrFormat("the robot does not fit at its start (%.2f, %.2f)",
                                                      start_in_hall.x_m, start_in_hall.y_m));
  }
  return body;
}

GuideBody::GuideBody(std::shared_ptr<const maps::HallModel> hall, const maps::HallLayout& layout,
                     const GuideBodySettings& settings, const Pose2& start_in_hall, uint64_t seed)
    : settings_(settings),
      seed_(seed),
      hall_(std::move(hall)),
      scanner_(layout, settings.scanner),
      base_(start_in_hall, settings.base, seed ^ kWheelStream),
      localiser_(hall_, settings.localiser, seed ^ kLocaliserStream),
      planner_(hall_, settings.planner),
      follower_(settings.follower),
      scan_random_(seed) {}

void GuideBody::Tick(const std::vector<maps::Disc>& people) {
  if (ticks_ % settings_.ticks_per_scan == 0) Sense(people);
  Steer();
  base_.Advance(command_, settings_.tick_s);
  if (scanner_.Collides(base_.truth().position(), settings_.planner.robot_radius_m)) {
    base_.Undo();
    ++bumps_;
  }
  const Pose2 odometry = base_.TakeOdometry();
  odometry_since_scan_ = maps::Compose(odometry_since_scan_, odometry);
  estimate_ = maps::Compose(estimate_at_scan_, odometry_since_scan_);
  ++ticks_;
}

void GuideBody::Sense(const std::vector<maps::Disc>& people) {
  scan_ = scanner_.Scan(base_.truth(), people, scan_random_);
  if (!searched_) {
    if (!localiser_.InitialiseGlobally(scan_).ok()) return;  // no return: try again with the next scan
    searched_ = true;
  } else if (auto updated = localiser_.Update(odometry_since_scan_, scan_); !updated.ok()) {
    return;  // the increment is kept for the next scan
  }
  odometry_since_scan_ = {};
  estimate_at_scan_ = estimate_ = localiser_.estimate().pose();
  const bool moving =
      std::abs(base_.speed_m_per_s()) > kMovingMPerS || std::abs(base_.turn_rad_per_s()) > kMovingRadPerS;
  if (moving && localised()) trace_.push_back({time_s(), base_.truth(), estimate_});
}

void GuideBody::Steer() {
  command_ = {};
  if (drive_.state != DriveStatus::State::kDriving) return;
  if (!localised()) {
    drive_.message = "looking around: not sure where it is";
    standing_s_ += settings_.tick_s;
    if (standing_s_ > settings_.give_up_after_s) Fail("the robot does not know where it is");
    return;
  }
  command_ = follower_.Step(estimate_, scan_, estimate_at_scan_, settings_.tick_s);
  switch (follower_.state()) {
    case PathFollower::State::kArrived:
      drive_ = {DriveStatus::State::kArrived, 1, ""};
      break;
    case PathFollower::State::kBlocked:
      standing_s_ += settings_.tick_s;
      drive_.message = "an obstacle is in the way";
      if (standing_s_ > settings_.give_up_after_s) {
        Fail(absl::StrFormat("something stood in the way at (%.1f, %.1f) for %.0f s", estimate_.x_m,
                             estimate_.y_m, settings_.give_up_after_s));
      } else if (follower_.blocked_s() > settings_.replan_after_s) {
        Replan();
      }
      break;
    default:
      drive_.message = "driving";
      if (follower_.length_m() > 0) {
        drive_.progress = std::max(drive_.progress,
                                   std::clamp(1 - follower_.remaining_m() / follower_.length_m(), 0.0, 1.0));
      }
  }
}

// Plans a path around scanned points that are not in the map; if there is none, keeps the path.
void GuideBody::Replan() {
  std::vector<Point2> obstacles;
  for (const Point2& in_robot : PathFollower::PointsOf(scan_, estimate_at_scan_, estimate_)) {
    if (std::hypot(in_robot.x_m, in_robot.y_m) > kObstacleRangeM) continue;
    const Point2 in_hall = maps::Compose(estimate_, {in_robot.x_m, in_robot.y_m, 0}).position();
    if (hall_->DistanceAt(in_hall.x_m, in_hall.y_m) > kUnmappedM) obstacles.push_back(in_hall);
  }
  auto way = planner_.Plan(estimate_.position(), goal_.position(), obstacles);
  if (!way.ok()) way = planner_.Plan(estimate_.position(), goal_.position());
  if (way.ok()) follower_.Start(*std::move(way), goal_.heading_rad);
}

absl::Status GuideBody::DriveTo(const Pose2& goal_in_hall) {
  Halt();
  if (!localised()) return absl::FailedPreconditionError("the robot does not know where it is");
  auto way = planner_.Plan(estimate_.position(), goal_in_hall.position());
  if (!way.ok()) return way.status();
  goal_ = goal_in_hall;
  standing_s_ = 0;
  follower_.Start(*std::move(way), goal_in_hall.heading_rad);
  drive_ = {DriveStatus::State::kDriving, 0, "driving"};
  return absl::OkStatus();
}

void GuideBody::Halt() {
  follower_.Stop();
  drive_ = {};
}

void GuideBody::Fail(std::string message) {
  follower_.Stop();
  command_ = {};
  drive_ = {DriveStatus::State::kFailed, drive_.progress, std::move(message)};
}

double GuideBody::deviation_m() const {
  const std::array<double, 9>& covariance = localiser_.estimate().covariance;
  return std::sqrt(std::max(0.0, covariance[0] + covariance[4]));
}

std::vector<Point2> GuideBody::path() const {
  return drive_.state == DriveStatus::State::kDriving ? follower_.path() : std::vector<Point2>();
}

DriveReport GuideBody::Report() const {
  DriveReport report;
  report.seed = seed_;
  report.path_m = base_.driven_m();
  report.simulated_s = time_s();
  report.bumps = bumps_;
  report.relocalisations = localiser_.estimate().relocalisations;
  report.trace = trace_;
  return report;
}

}  // namespace docent::robot
