// Body of the simulated guide robot: the simulated world around it, its sensors, and driving.
//
// The world (truth, walls, laser, wheels) is simulated; the robot's decisions use scans and odometry alone:
// it localises with the particle filter in the OctoMap's distance field, plans with A* and drives on the
// *estimated* pose. The laser is cast on the layout's analytic shapes, never on that map. No clock, no
// threads: the same seed and calls give the same drive. One thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_GUIDE_BODY_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_GUIDE_BODY_H_

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "maps/analytic_scan.h"
#include "maps/hall_model.h"
#include "robot_adapters/localization/localiser.h"
#include "robot_adapters/navigation/path_follower.h"
#include "robot_adapters/navigation/path_planner.h"
#include "robot_adapters/sim/drive_trace.h"
#include "robot_adapters/sim/simulated_base.h"

namespace docent::robot {

struct GuideBodySettings {
  double tick_s = 0.05;           // 0.01..0.2: one control step
  int ticks_per_scan = 4;         // 1..50: the laser turns at 5 Hz
  double replan_after_s = 2.0;    // 0.5..60: time blocked by an obstacle before a new plan
  double give_up_after_s = 40.0;  // 1..600
  maps::ScannerSettings scanner;  // 180 beams, sigma 2 cm, 1 % lost
  BaseSettings base;
  LocaliserSettings localiser;
  PlannerSettings planner;
  FollowerSettings follower;
};

struct DriveStatus {
  enum class State { kIdle, kDriving, kArrived, kFailed };
  State state = State::kIdle;
  double progress = 0;  // 0..1 of the path
  std::string message;  // kDriving: current action; kFailed: reason
};

class GuideBody {
 public:
  // INVALID_ARGUMENT: settings out of range, or the robot does not fit at `start_in_hall`.
  static absl::StatusOr<std::unique_ptr<GuideBody>> Create(std::shared_ptr<const maps::HallModel> hall,
                                                           const maps::HallLayout& layout,
                                                           const GuideBodySettings& settings,
                                                           const maps::Pose2& start_in_hall, uint64_t seed);

  // One control step of settings.tick_s. `people` are discs that the laser sees and the map does not have.
  void Tick(const std::vector<maps::Disc>& people = {});

  // Starts to drive and ends the drive before. Errors as PathPlanner::Plan, and FAILED_PRECONDITION while not
  // localised.
  absl::Status DriveTo(const maps::Pose2& goal_in_hall);
  void Halt();
  const DriveStatus& drive() const { return drive_; }

  bool localised() const { return localiser_.estimate().localised; }
  const maps::Pose2& estimate() const { return estimate_; }  // in the hall; odometry carries it between scans
  double deviation_m() const;                                // standard deviation of the estimated position
  std::vector<maps::Point2> path() const;  // that it drives along, from its start; empty: it does not drive
  const maps::Pose2& truth() const { return base_.truth(); }
  double time_s() const { return static_cast<double>(ticks_) * settings_.tick_s; }
  DriveReport Report() const;
  const PathPlanner& planner() const { return planner_; }
  const GuideBodySettings& settings() const { return settings_; }

 private:
  GuideBody(std::shared_ptr<const maps::HallModel> hall, const maps::HallLayout& layout,
            const GuideBodySettings& settings, const maps::Pose2& start_in_hall, uint64_t seed);
  void Sense(const std::vector<maps::Disc>& people);
  void Steer();
  void Replan();
  void Fail(std::string message);

  const GuideBodySettings settings_;
  const uint64_t seed_;
  std::shared_ptr<const maps::HallModel> hall_;
  maps::AnalyticScanner scanner_;
  SimulatedBase base_;
  Localiser localiser_;
  PathPlanner planner_;
  PathFollower follower_;
  std::mt19937_64 scan_random_;

  int64_t ticks_ = 0;
  bool searched_ = false;  // the first scan was used for the search
  maps::Pose2 odometry_since_scan_;
  maps::Pose2 estimate_at_scan_;
  maps::Pose2 estimate_;
  maps::LaserScan scan_;
  DriveCommand command_;
  DriveStatus drive_;
  maps::Pose2 goal_;
  double standing_s_ = 0;  // blocked time, over all plans for this goal
  int bumps_ = 0;
  std::vector<TracePoint> trace_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_GUIDE_BODY_H_
