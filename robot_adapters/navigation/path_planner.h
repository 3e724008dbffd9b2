// Path planner: A* on the hall model's clearance; it prefers to keep away from walls.
//
// Hart, Nilsson, Raphael, A Formal Basis for the Heuristic Determination of Minimum Cost Paths (1968), on
// 8-connected cells. The path is then shortened by straight lines with the same clearance. Deterministic:
// same map, same path. Immutable after construction; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_NAVIGATION_PATH_PLANNER_H_
#define DOCENT_ROBOT_ADAPTERS_NAVIGATION_PATH_PLANNER_H_

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "maps/hall_model.h"

namespace docent::robot {

struct PlannerSettings {
  double robot_radius_m = 0.25;  // 0.05..1: minimum distance of obstacles from the robot's centre
  double margin_m = 0.10;        // 0..1: additional distance, for errors of pose and control
  double comfort_m = 0.80;       // 0.05..2: larger clearance is not worth a longer path
  double discomfort = 3.0;       // 0..100: cost of a metre at no clearance beyond the margin is 1 + this
  double cell_m = 0.10;          // 0.02..0.5: edge of a planning cell, rounded to whole map cells
  double leave_radius_m =
      0.60;  // 0..2: within this distance of the start less clearance is allowed, to get away from a wall
};

// INVALID_ARGUMENT naming the first field out of its range.
absl::Status Validate(const PlannerSettings& settings);

class PathPlanner {
 public:
  // `settings` must be valid.
  PathPlanner(std::shared_ptr<const maps::HallModel> hall, const PlannerSettings& settings);

  // Points from `from` to exactly `to`; the straight line between neighbours is free. `obstacles` are seen
  // points that are not in the map (people). INVALID_ARGUMENT: a coordinate that is not finite.
  // FAILED_PRECONDITION: the robot does not fit at `to` (gives the clearance there). NOT_FOUND: there is no
  // path.
  absl::StatusOr<std::vector<maps::Point2>> Plan(const maps::Point2& from, const maps::Point2& to,
                                                 const std::vector<maps::Point2>& obstacles = {}) const;

  // The place nearest to `wanted`, at most `radius_m` away, where the robot fits; NOT_FOUND if there is none.
  absl::StatusOr<maps::Point2> NearestFree(const maps::Point2& wanted, double radius_m) const;

  double required_clearance_m() const { return settings_.robot_radius_m + settings_.margin_m; }

 private:
  struct Search;
  std::vector<float> ClearanceWith(const std::vector<maps::Point2>& obstacles) const;
  std::vector<maps::Point2> Shorten(const std::vector<maps::Point2>& way,
                                    const std::vector<float>& clearance) const;
  bool IsFreeLine(const maps::Point2& a, const maps::Point2& b, double least_m,
                  const std::vector<float>& clearance) const;
  int CellOf(const maps::Point2& p) const;  // -1: outside
  maps::Point2 CenterOf(int cell) const;

  const PlannerSettings settings_;
  double cell_m_ = 0;
  double origin_x_m_ = 0;
  double origin_y_m_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::vector<float> clearance_m_;  // at each planning cell's centre, row by row
};

// Length of the path in metres.
double LengthOf(const std::vector<maps::Point2>& path);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_NAVIGATION_PATH_PLANNER_H_
