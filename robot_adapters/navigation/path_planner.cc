#include "robot_adapters/navigation/path_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

#include "absl/strings/str_format.h"

namespace docent::robot {

using maps::Point2;

namespace {

bool IsFinite(const Point2& p) {
  return std::isfinite(p.x_m) && std::isfinite(p.y_m);
}

absl::Status CheckRange(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("planner setting %s = %g is not within %g..%g", name, value, low, high));
}

}  // namespace

absl::Status Validate(const PlannerSettings& s) {
  for (absl::Status status :
       {CheckRange("robot_radius_m", s.robot_radius_m, 0.05, 1), CheckRange("margin_m", s.margin_m, 0, 1),
        CheckRange("comfort_m", s.comfort_m, 0.05, 2), CheckRange("discomfort", s.discomfort, 0, 100),
        CheckRange("cell_m", s.cell_m, 0.02, 0.5), CheckRange("leave_radius_m", s.leave_radius_m, 0, 2)}) {
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

double LengthOf(const std::vector<Point2>& path) {
  double length_m = 0;
  for (size_t i = 1; i < path.size(); ++i) length_m += maps::Distance(path[i - 1], path[i]);
  return length_m;
}

PathPlanner::PathPlanner(std::shared_ptr<const maps::HallModel> hall, const PlannerSettings& settings)
    : settings_(settings) {
  const maps::DistanceGrid& grid = hall->clearance();
  const int step = std::max(1, static_cast<int>(std::lround(settings.cell_m / grid.resolution_m)));
  cell_m_ = step * grid.resolution_m;
  origin_x_m_ = grid.origin_x_m;
  origin_y_m_ = grid.origin_y_m;
  width_ = grid.width / step;
  height_ = grid.height / step;
  clearance_m_.resize(static_cast<size_t>(width_) * height_);
  for (int cell = 0; cell < width_ * height_; ++cell) {
    clearance_m_[cell] = static_cast<float>(grid.DistanceAt(CenterOf(cell)));
  }
}

int PathPlanner::CellOf(const Point2& p) const {
  const int i = static_cast<int>(std::floor((p.x_m - origin_x_m_) / cell_m_));
  const int j = static_cast<int>(std::floor((p.y_m - origin_y_m_) / cell_m_));
  return i < 0 || j < 0 || i >= width_ || j >= height_ ? -1 : j * width_ + i;
}

Point2 PathPlanner::CenterOf(int cell) const {
  return {origin_x_m_ + (cell % width_ + 0.5) * cell_m_, origin_y_m_ + (cell / width_ + 0.5) * cell_m_};
}

std::vector<float> PathPlanner::ClearanceWith(const std::vector<Point2>& obstacles) const {
  std::vector<float> clearance = clearance_m_;
  const double reach_m = settings_.comfort_m;
  const int reach = static_cast<int>(std::ceil(reach_m / cell_m_));
  for (const Point2& obstacle : obstacles) {
    const int center = IsFinite(obstacle) ? CellOf(obstacle) : -1;
    if (center < 0) continue;
    for (int j = std::max(0, center / width_ - reach); j <= std::min(height_ - 1, center / width_ + reach);
         ++j) {
      for (int i = std::max(0, center % width_ - reach); i <= std::min(width_ - 1, center % width_ + reach);
           ++i) {
        const int cell = j * width_ + i;
        const float distance_m = static_cast<float>(maps::Distance(CenterOf(cell), obstacle));
        clearance[cell] = std::min(clearance[cell], distance_m);
      }
    }
  }
  return clearance;
}

// One A* run.
struct PathPlanner::Search {
  const PathPlanner& planner;
  const std::vector<float>& clearance;
  const Point2 start;
  const int goal;
  std::vector<float> cost{};
  std::vector<int> before{};

  bool IsPassable(int cell) const {
    const double required_m = planner.required_clearance_m();
    if (clearance[cell] >= required_m || cell == goal) return true;
    return clearance[cell] >= planner.settings_.robot_radius_m / 2 &&
           maps::Distance(planner.CenterOf(cell), start) <= planner.settings_.leave_radius_m;
  }

  float CostPerMetre(int cell) const {
    const double spare = (clearance[cell] - planner.required_clearance_m()) /
                         std::max(1e-6, planner.settings_.comfort_m - planner.required_clearance_m());
    return static_cast<float>(1 + planner.settings_.discomfort * (1 - std::clamp(spare, 0.0, 1.0)));
  }

  bool Run(int from) {
    cost.assign(clearance.size(), std::numeric_limits<float>::infinity());
    before.assign(clearance.size(), -1);
    using Open =
        std::tuple<float, float, int>;  // estimate, minus cost, cell: ties go deeper first, then by cell
    std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
    const Point2 target = planner.CenterOf(goal);
    cost[from] = 0;
    open.push({0.f, 0.f, from});
    while (!open.empty()) {
      const auto [estimate, minus_cost, cell] = open.top();
      open.pop();
      if (-minus_cost > cost[cell]) continue;
      if (cell == goal) return true;
      const int i = cell % planner.width_, j = cell / planner.width_;
      for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) {
          if ((di == 0 && dj == 0) || i + di < 0 || i + di >= planner.width_ || j + dj < 0 ||
              j + dj >= planner.height_) {
            continue;
          }
          const int next = (j + dj) * planner.width_ + i + di;
          if (!IsPassable(next)) continue;
          const float length_m =
              static_cast<float>(planner.cell_m_ * (di != 0 && dj != 0 ? std::sqrt(2.0) : 1.0));
          const float so_far = cost[cell] + length_m * CostPerMetre(next);
          if (so_far >= cost[next]) continue;
          cost[next] = so_far;
          before[next] = cell;
          const float rest_m = static_cast<float>(maps::Distance(planner.CenterOf(next), target));
          open.push({so_far + rest_m, -so_far, next});
        }
      }
    }
    return false;
  }
};

absl::StatusOr<std::vector<Point2>> PathPlanner::Plan(const Point2& from, const Point2& to,
                                                      const std::vector<Point2>& obstacles) const {
  if (!IsFinite(from) || !IsFinite(to))
    return absl::InvalidArgumentError("a coordinate is not a finite number");
  const int start = CellOf(from), goal = CellOf(to);
  if (start < 0) {
    return absl::FailedPreconditionError(
        absl::StrFormat("the robot at (%.2f, %.2f) is outside the map", from.x_m, from.y_m));
  }
  if (goal < 0 || clearance_m_[goal] < settings_.robot_radius_m) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "the robot, radius %.2f m, does not fit at (%.2f, %.2f): clearance %.2f m", settings_.robot_radius_m,
        to.x_m, to.y_m, goal < 0 ? 0.0 : std::max(0.f, clearance_m_[goal])));
  }
  const std::vector<float> clearance = ClearanceWith(obstacles);
  Search search{*this, clearance, from, goal};
  if (!search.Run(start)) {
    return absl::NotFoundError(
        absl::StrFormat("there is no path from (%.2f, %.2f) to (%.2f, %.2f) for a robot of radius %.2f m",
                        from.x_m, from.y_m, to.x_m, to.y_m, settings_.robot_radius_m));
  }
  std::vector<Point2> way = {to};
  for (int cell = search.before[goal]; cell >= 0 && cell != start; cell = search.before[cell]) {
    way.push_back(CenterOf(cell));
  }
  way.push_back(from);
  std::reverse(way.begin(), way.end());
  return Shorten(way, clearance);
}

bool PathPlanner::IsFreeLine(const Point2& a, const Point2& b, double least_m,
                             const std::vector<float>& clearance) const {
  const int steps = std::max(1, static_cast<int>(std::ceil(maps::Distance(a, b) / (cell_m_ / 2))));
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const int cell = CellOf({a.x_m + t * (b.x_m - a.x_m), a.y_m + t * (b.y_m - a.y_m)});
    if (cell < 0 || clearance[cell] < least_m) return false;
  }
  return true;
}

// Replaces runs of cells by straight lines, if their clearance is at least that of the run (or
// comfortable).
std::vector<Point2> PathPlanner::Shorten(const std::vector<Point2>& way,
                                         const std::vector<float>& clearance) const {
  std::vector<Point2> out = {way.front()};
  size_t at = 0;
  while (at + 1 < way.size()) {
    size_t next = at + 1;
    double least_m = settings_.comfort_m;
    for (size_t i = at + 1; i < way.size(); ++i) {
      const int cell = CellOf(way[i]);
      least_m = std::min<double>(least_m, clearance[cell]);
      if (IsFreeLine(way[at], way[i], std::min<double>(least_m, clearance[CellOf(way[at])]), clearance))
        next = i;
      if (i > next + 15) break;  // no line for a metre and a half: a later one is unlikely
    }
    out.push_back(way[next]);
    at = next;
  }
  return out;
}

absl::StatusOr<Point2> PathPlanner::NearestFree(const Point2& wanted, double radius_m) const {
  if (!IsFinite(wanted)) return absl::InvalidArgumentError("a coordinate is not a finite number");
  const int reach = static_cast<int>(std::ceil(radius_m / cell_m_));
  const int ci = static_cast<int>(std::floor((wanted.x_m - origin_x_m_) / cell_m_));
  const int cj = static_cast<int>(std::floor((wanted.y_m - origin_y_m_) / cell_m_));
  const Point2* found = nullptr;
  Point2 best;
  double best_m = radius_m;
  for (int j = std::max(0, cj - reach); j <= std::min(height_ - 1, cj + reach); ++j) {
    for (int i = std::max(0, ci - reach); i <= std::min(width_ - 1, ci + reach); ++i) {
      const int cell = j * width_ + i;
      if (clearance_m_[cell] < required_clearance_m()) continue;
      const double distance_m = maps::Distance(CenterOf(cell), wanted);
      if (distance_m > best_m || (found != nullptr && distance_m == best_m)) continue;
      best = CenterOf(cell);
      best_m = distance_m;
      found = &best;
    }
  }
  if (found == nullptr) {
    return absl::NotFoundError(absl::StrFormat("the robot fits nowhere within %.2f m of (%.2f, %.2f)",
                                               radius_m, wanted.x_m, wanted.y_m));
  }
  return best;
}

}  // namespace docent::robot
