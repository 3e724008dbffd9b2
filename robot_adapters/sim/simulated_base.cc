#include "robot_adapters/sim/simulated_base.h"

#include <algorithm>
#include <cmath>

namespace docent::robot {

using maps::Pose2;

SimulatedBase::SimulatedBase(const Pose2& start_in_hall, const BaseSettings& settings, uint64_t seed)
    : settings_(settings),
      random_(seed),
      truth_(start_in_hall),
      before_(start_in_hall),
      reported_at_(start_in_hall) {
  std::normal_distribution<double> normal(0, 1);
  scale_xy_ = 1 + settings_.scale_sigma * normal(random_);
  scale_heading_ = 1 + settings_.scale_sigma * normal(random_);
}

void SimulatedBase::Advance(const DriveCommand& command, double dt_s) {
  constexpr double kStepS = 0.01;
  before_ = truth_;
  last_step_m_ = 0;
  for (double left_s = dt_s; left_s > 1e-9; left_s -= kStepS) {
    const double step_s = std::min(left_s, kStepS);
    const double follow = 1 - std::exp(-step_s / settings_.lag_s);  // first-order lag, exact for a step
    speed_ += follow * (command.speed_m_per_s - speed_);
    turn_ += follow * (command.turn_rad_per_s - turn_);
    const double way_m = speed_ * step_s, turned = turn_ * step_s;
    truth_ = maps::Compose(truth_, {way_m * std::cos(turned / 2), way_m * std::sin(turned / 2), turned});
    last_step_m_ += std::abs(way_m);
  }
  driven_m_ += last_step_m_;
}

void SimulatedBase::Undo() {
  truth_ = before_;
  driven_m_ -= last_step_m_;
  last_step_m_ = 0;
  speed_ = 0;
  turn_ = 0;
}

Pose2 SimulatedBase::TakeOdometry() {
  const Pose2 moved = maps::Between(reported_at_, truth_);
  reported_at_ = truth_;
  const double way_m = std::hypot(moved.x_m, moved.y_m), turn = std::abs(moved.heading_rad);
  if (way_m < 1e-6 && turn < 1e-6) return {};
  std::normal_distribution<double> normal(0, 1);
  Pose2 reported;
  reported.x_m = scale_xy_ * moved.x_m + settings_.xy_per_m * way_m * normal(random_);
  reported.y_m =
      scale_xy_ * moved.y_m + settings_.xy_per_m / 2 * way_m * normal(random_);  // wheels slip less sideways
  reported.heading_rad =
      scale_heading_ * moved.heading_rad +
      (settings_.heading_per_rad * turn + settings_.heading_per_m * way_m) * normal(random_);
  return reported;
}

}  // namespace docent::robot
