#include "robot_adapters/navigation/path_follower.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"

namespace docent::robot {

using maps::Point2;
using maps::Pose2;

namespace {

absl::Status CheckRange(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("follower setting %s = %g is not within %g..%g", name, value, low, high));
}

// Position on the segment a–b nearest to `p`: 0 at a, 1 at b.
double ShareAlong(const Point2& p, const Point2& a, const Point2& b) {
  const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
  const double square = dx * dx + dy * dy;
  return square <= 0 ? 1 : std::clamp(((p.x_m - a.x_m) * dx + (p.y_m - a.y_m) * dy) / square, 0.0, 1.0);
}

Point2 Between(const Point2& a, const Point2& b, double share) {
  return {a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m)};
}

constexpr double kSpeedSteps[] = {1.0, 0.7, 0.45, 0.25, 0.1};
constexpr double kSimulationStepS = 0.1;
constexpr double kSmallestTurn = 0.12;  // rad/s: at lower speeds the wheels of a real robot would stick

}  // namespace

absl::Status Validate(const FollowerSettings& s) {
  for (absl::Status status :
       {CheckRange("max_speed_m_per_s", s.max_speed_m_per_s, 0.05, 3),
        CheckRange("max_turn_rad_per_s", s.max_turn_rad_per_s, 0.05, 5),
        CheckRange("acceleration_m_per_s2", s.acceleration_m_per_s2, 0.05, 5),
        CheckRange("look_ahead_m", s.look_ahead_m, 0.1, 3),
        CheckRange("turn_in_place_rad", s.turn_in_place_rad, 0.1, 3.1),
        CheckRange("robot_radius_m", s.robot_radius_m, 0.05, 1), CheckRange("safety_m", s.safety_m, 0, 1),
        CheckRange("lag_s", s.lag_s, 0, 2), CheckRange("goal_tolerance_m", s.goal_tolerance_m, 0.01, 1),
        CheckRange("heading_tolerance_rad", s.heading_tolerance_rad, 0.005, 1)}) {
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

void PathFollower::Start(std::vector<Point2> path, double goal_heading_rad) {
  path_ = std::move(path);
  if (path_.size() == 1) path_.push_back(path_.front());
  goal_heading_rad_ = goal_heading_rad;
  segment_ = 0;
  aligning_ = false;
  blocked_s_ = 0;
  length_m_ = 0;
  for (size_t i = 1; i < path_.size(); ++i) length_m_ += maps::Distance(path_[i - 1], path_[i]);
  remaining_m_ = length_m_;
  state_ = path_.empty() ? State::kIdle : State::kDriving;
}

void PathFollower::Stop() {
  path_.clear();
  last_ = {};
  state_ = State::kIdle;
}

DriveCommand PathFollower::Step(const Pose2& robot_in_hall, const maps::LaserScan& scan,
                                const Pose2& scan_pose_in_hall, double dt_s) {
  if (state_ != State::kDriving && state_ != State::kBlocked) return last_ = {};
  DriveCommand wanted = Wanted(robot_in_hall);
  if (state_ == State::kArrived) return last_ = {};
  // Acceleration is limited here; deceleration follows from the wheels' lag.
  wanted.speed_m_per_s = std::min(
      wanted.speed_m_per_s, last_.speed_m_per_s + settings_.acceleration_m_per_s2 * std::max(dt_s, 0.01));
  const std::vector<Point2> points = PointsOf(scan, scan_pose_in_hall, robot_in_hall);
  for (double share : kSpeedSteps) {
    // The same arc, more slowly.
    const DriveCommand slower = {share * wanted.speed_m_per_s, share * wanted.turn_rad_per_s};
    if (!IsSafe(slower, points)) continue;
    state_ = State::kDriving;
    blocked_s_ = 0;
    return last_ = slower;
  }
  state_ = State::kBlocked;
  blocked_s_ += dt_s;
  return last_ = {};
}

DriveCommand PathFollower::Wanted(const Pose2& robot_in_hall) {
  const Point2 at = robot_in_hall.position();
  // Chooses the current segment: the nearest of those not much further on; the robot never goes back.
  double best_m = std::numeric_limits<double>::infinity(), ahead_m = 0;
  size_t best = segment_;
  for (size_t i = segment_; i + 1 < path_.size() && ahead_m < 2 * settings_.look_ahead_m; ++i) {
    const Point2 nearest = Between(path_[i], path_[i + 1], ShareAlong(at, path_[i], path_[i + 1]));
    const double distance_m = maps::Distance(at, nearest);
    if (distance_m < best_m) {
      best_m = distance_m;
      best = i;
    }
    ahead_m += maps::Distance(i == segment_ ? nearest : path_[i], path_[i + 1]);
  }
  segment_ = best;
  Point2 on_path = Between(path_[best], path_[best + 1], ShareAlong(at, path_[best], path_[best + 1]));
  remaining_m_ = maps::Distance(on_path, path_[best + 1]);
  for (size_t i = best + 1; i + 1 < path_.size(); ++i) remaining_m_ += maps::Distance(path_[i], path_[i + 1]);

  if (aligning_ || maps::Distance(at, path_.back()) <= settings_.goal_tolerance_m) {
    aligning_ = maps::Distance(at, path_.back()) <= 3 * settings_.goal_tolerance_m;
    const double off_rad = maps::WrapAngle(goal_heading_rad_ - robot_in_hall.heading_rad);
    if (aligning_ && std::abs(off_rad) <= settings_.heading_tolerance_rad) {
      remaining_m_ = 0;
      state_ = State::kArrived;
      return {};
    }
    if (aligning_) return Turn(off_rad);
  }
  if (remaining_m_ < settings_.look_ahead_m) return Approach(robot_in_hall);

  double left_m = settings_.look_ahead_m;
  size_t i = best;
  Point2 target = on_path;
  while (i + 1 < path_.size() && left_m > 0) {
    const double step_m = maps::Distance(target, path_[i + 1]);
    target = step_m <= left_m ? path_[i + 1] : Between(target, path_[i + 1], left_m / step_m);
    left_m -= step_m;
    ++i;
  }
  const double distance_m = std::max(1e-6, maps::Distance(at, target));
  const double off_rad =
      maps::WrapAngle(std::atan2(target.y_m - at.y_m, target.x_m - at.x_m) - robot_in_hall.heading_rad);
  if (std::abs(off_rad) > settings_.turn_in_place_rad) return Turn(off_rad);
  // Coulter (1992), equation 3: curvature = 2 x / L², x the target's offset to the side.
  const double curvature = 2 * std::sin(off_rad) / distance_m;
  const double brake_m_per_s =
      std::sqrt(2 * settings_.acceleration_m_per_s2 * std::max(0.0, remaining_m_ - 0.02));
  double speed = std::min(settings_.max_speed_m_per_s * std::max(0.25, std::cos(off_rad)), brake_m_per_s);
  speed = std::min(speed, settings_.max_turn_rad_per_s / std::max(1e-6, std::abs(curvature)));
  return {speed, speed * curvature};
}

// The last look-ahead: straight to the goal, with decreasing speed.
DriveCommand PathFollower::Approach(const Pose2& robot_in_hall) {
  const Point2 goal = path_.back();
  const double distance_m = maps::Distance(robot_in_hall.position(), goal);
  const double off_rad = maps::WrapAngle(
      std::atan2(goal.y_m - robot_in_hall.y_m, goal.x_m - robot_in_hall.x_m) - robot_in_hall.heading_rad);
  if (std::abs(off_rad) > 0.35) return Turn(off_rad);
  const double speed = std::clamp(0.8 * distance_m, 0.04, settings_.max_speed_m_per_s);
  return {std::min(speed, std::sqrt(2 * settings_.acceleration_m_per_s2 * distance_m)),
          std::clamp(1.5 * off_rad, -settings_.max_turn_rad_per_s, settings_.max_turn_rad_per_s)};
}

DriveCommand PathFollower::Turn(double angle_rad) const {
  const double rate = std::clamp(1.6 * std::abs(angle_rad), kSmallestTurn, settings_.max_turn_rad_per_s);
  return {0, std::copysign(rate, angle_rad)};
}

std::vector<Point2> PathFollower::PointsOf(const maps::LaserScan& scan, const Pose2& scan_pose_in_hall,
                                           const Pose2& robot_in_hall) {
  const Pose2 scan_in_robot =
      maps::Between(robot_in_hall, maps::Compose(scan_pose_in_hall, scan.sensor_in_robot));
  std::vector<Point2> points;
  points.reserve(scan.range_m.size());
  for (size_t i = 0; i < scan.range_m.size(); ++i) {
    if (scan.range_m[i] <= 0) continue;
    const double bearing = scan.first_bearing_rad + static_cast<double>(i) * scan.bearing_step_rad;
    points.push_back(maps::Compose(scan_in_robot, {scan.range_m[i] * std::cos(bearing),
                                                   scan.range_m[i] * std::sin(bearing), 0})
                         .position());
  }
  return points;
}

// Simulates the motion: the command for the lag and one step, then braking to a stop.
bool PathFollower::IsSafe(const DriveCommand& command, const std::vector<Point2>& points) const {
  const double reach_m = settings_.robot_radius_m + settings_.safety_m;
  Pose2 pose;  // in the robot's current frame
  double speed = command.speed_m_per_s;
  double time_s = 0;
  while (speed > 1e-3) {
    pose = maps::Compose(pose, {speed * kSimulationStepS, 0, command.turn_rad_per_s * kSimulationStepS});
    for (const Point2& point : points) {
      const double distance_m = maps::Distance(pose.position(), point);
      // The robot may move away from a point that is already too near, but not towards it.
      if (distance_m < reach_m && distance_m < std::hypot(point.x_m, point.y_m)) return false;
    }
    time_s += kSimulationStepS;
    if (time_s >= settings_.lag_s + kSimulationStepS)
      speed -= settings_.acceleration_m_per_s2 * kSimulationStepS;
  }
  return true;  // turning on the spot is always safe for a round robot
}

}  // namespace docent::robot
