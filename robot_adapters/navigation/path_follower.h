// Path follower: pure pursuit on the estimated pose; each command is first simulated against the
// scan.
//
// Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, CMU-RI-TR-92-01 (1992): the
// arc through the point one look-ahead further on the path. A command whose simulated movement, with
// braking, would touch a scanned point is slowed down until it does not; if no speed is safe, the
// robot stops. Deterministic. One thread.
#ifndef DOCENT_ROBOT_ADAPTERS_NAVIGATION_PATH_FOLLOWER_H_
#define DOCENT_ROBOT_ADAPTERS_NAVIGATION_PATH_FOLLOWER_H_

#include <vector>

#include "absl/status/status.h"
#include "maps/geometry.h"
#include "maps/laser_scan.h"

namespace docent::robot {

struct FollowerSettings {
  double max_speed_m_per_s = 0.7;       // 0.05..3
  double max_turn_rad_per_s = 1.0;      // 0.05..5
  double acceleration_m_per_s2 = 0.6;   // 0.05..5, braking too
  double look_ahead_m = 0.6;            // 0.1..3
  double turn_in_place_rad = 0.9;       // 0.1..3.1: if the way lies further to the side, turn first
  double robot_radius_m = 0.25;         // 0.05..1
  double safety_m = 0.05;               // 0..1: scanned points must stay further away than radius plus this
  double lag_s = 0.2;                   // 0..2: time until the wheels follow a command
  double goal_tolerance_m = 0.05;       // 0.01..1
  double heading_tolerance_rad = 0.04;  // 0.005..1
};

// INVALID_ARGUMENT naming the first field out of its range.
absl::Status Validate(const FollowerSettings& settings);

// A velocity command for the wheels.
struct DriveCommand {
  double speed_m_per_s = 0;   // forward
  double turn_rad_per_s = 0;  // counter-clockwise
};

class PathFollower {
 public:
  enum class State { kIdle, kDriving, kBlocked, kArrived };

  // `settings` must be valid.
  explicit PathFollower(const FollowerSettings& settings) : settings_(settings) {}

  // Starts to drive along `path` (from about here; at least one point) and to end with `goal_heading_rad`.
  void Start(std::vector<maps::Point2> path, double goal_heading_rad);
  void Stop();

  // The next command. `robot_in_hall` is the current estimated pose, `scan` the newest scan, taken at
  // `scan_pose_in_hall`; `dt_s` the time since the last Step.
  DriveCommand Step(const maps::Pose2& robot_in_hall, const maps::LaserScan& scan,
                    const maps::Pose2& scan_pose_in_hall, double dt_s);

  State state() const { return state_; }
  double remaining_m() const { return remaining_m_; }  // along the path
  double length_m() const { return length_m_; }        // of the whole path
  double blocked_s() const { return blocked_s_; }      // time without a break that an obstacle stops it
  const std::vector<maps::Point2>& path() const { return path_; }

  // The points of a scan in the robot's frame at `robot_in_hall`.
  static std::vector<maps::Point2> PointsOf(const maps::LaserScan& scan, const maps::Pose2& scan_pose_in_hall,
                                            const maps::Pose2& robot_in_hall);

 private:
  DriveCommand Wanted(const maps::Pose2& robot_in_hall);
  DriveCommand Approach(const maps::Pose2& robot_in_hall);
  DriveCommand Turn(double angle_rad) const;
  bool IsSafe(const DriveCommand& command, const std::vector<maps::Point2>& points) const;

  const FollowerSettings settings_;
  State state_ = State::kIdle;
  std::vector<maps::Point2> path_;
  double goal_heading_rad_ = 0;
  size_t segment_ = 0;     // the current one, between path_[segment_] and path_[segment_ + 1]
  bool aligning_ = false;  // at the goal, turning to its heading
  double remaining_m_ = 0;
  double length_m_ = 0;
  double blocked_s_ = 0;
  DriveCommand last_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_NAVIGATION_PATH_FOLLOWER_H_
