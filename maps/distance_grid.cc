#include "maps/distance_grid.h"

#include <algorithm>

namespace docent::maps {

double DistanceGrid::DistanceAt(const Point2& p) const {
  const double u = (p.x_m - origin_x_m) / resolution_m - 0.5;
  const double v = (p.y_m - origin_y_m) / resolution_m - 0.5;
  if (u < -0.5 || v < -0.5 || u > width - 0.5 || v > height - 0.5) return -max_distance_m;
  const int i = std::clamp(static_cast<int>(u), 0, std::max(0, width - 2));
  const int j = std::clamp(static_cast<int>(v), 0, std::max(0, height - 2));
  const double fu = std::clamp(u - i, 0.0, 1.0), fv = std::clamp(v - j, 0.0, 1.0);
  const int i1 = std::min(i + 1, width - 1), j1 = std::min(j + 1, height - 1);
  const auto at = [this](int column, int row) {
    return static_cast<double>(distance_m[row * width + column]);
  };
  return (1 - fv) * ((1 - fu) * at(i, j) + fu * at(i1, j)) + fv * ((1 - fu) * at(i, j1) + fu * at(i1, j1));
}

CellState DistanceGrid::StateAt(const Point2& p) const {
  const int i = ColumnOf(p.x_m), j = RowOf(p.y_m);
  return Inside(i, j) ? state[j * width + i] : CellState::kUnknown;
}

}  // namespace docent::maps
