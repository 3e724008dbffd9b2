// Simulated wheels: a differential drive that follows commands with a lag, and odometry with realistic
// errors. Deterministic by seed. One thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_SIMULATED_BASE_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_SIMULATED_BASE_H_

#include <cstdint>
#include <random>

#include "maps/geometry.h"
#include "robot_adapters/navigation/path_follower.h"

namespace docent::robot {

struct BaseSettings {
  double lag_s =
      0.2;  // 0.01..2: time constant of the wheels' speed (measured on small research robots: 0.1 to 0.3)
  // Odometry: random errors of each increment, and wheel wear as a scale error drawn once.
  double xy_per_m = 0.05;         // 0..1, standard deviation, m for each m driven
  double heading_per_rad = 0.05;  // 0..1, rad for each rad turned
  double heading_per_m = 0.02;    // 0..1, rad for each m driven
  double scale_sigma = 0.01;      // 0..0.2
};

class SimulatedBase {
 public:
  SimulatedBase(const maps::Pose2& start_in_hall, const BaseSettings& settings, uint64_t seed);

  // Moves for `dt_s` under the newest command.
  void Advance(const DriveCommand& command, double dt_s);
  // Collision: returns to the pose before the last Advance.
  void Undo();

  // Wheel odometry since the last call, in the robot's frame at that call. Standing still reports no
  // movement.
  maps::Pose2 TakeOdometry();

  const maps::Pose2& truth() const { return truth_; }  // in the hall
  double speed_m_per_s() const { return speed_; }
  double turn_rad_per_s() const { return turn_; }
  double driven_m() const { return driven_m_; }

 private:
  const BaseSettings settings_;
  std::mt19937_64 random_;
  double scale_xy_ = 1;
  double scale_heading_ = 1;
  maps::Pose2 truth_;
  maps::Pose2 before_;
  maps::Pose2 reported_at_;  // truth when odometry was last taken
  double speed_ = 0;
  double turn_ = 0;
  double driven_m_ = 0;
  double last_step_m_ = 0;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_SIMULATED_BASE_H_
