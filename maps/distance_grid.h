// A flat grid of signed distances: one horizontal slice of the hall model, unpacked from the octree for speed.
// Immutable once made (maps/hall_model.h makes it); any thread.
#ifndef DOCENT_MAPS_DISTANCE_GRID_H_
#define DOCENT_MAPS_DISTANCE_GRID_H_

#include <cstdint>
#include <vector>

#include "maps/geometry.h"

namespace docent::maps {

enum class CellState : uint8_t { kUnknown, kFree, kOccupied };

struct DistanceGrid {
  // Corner of cell (0, 0) with the smallest x and y; cell (i, j) covers [x+i*res, x+(i+1)*res) × [y+j*res, …).
  double origin_x_m = 0;
  double origin_y_m = 0;
  double resolution_m = 0;
  int width = 0;              // cells along x
  int height = 0;             // cells along y
  double max_distance_m = 0;  // distances are cut off here

  // At each cell's centre, row by row (index = j * width + i): distance to the surface of the nearest
  // occupied cell, negative inside occupied space. The surface lies half a cell outside the outermost
  // occupied centres. In maps made from measurements it runs through those centres, and no distance is
  // negative (HallModelSettings::measured).
  std::vector<float> distance_m;
  std::vector<CellState> state;

  bool Inside(int i, int j) const { return i >= 0 && j >= 0 && i < width && j < height; }
  int ColumnOf(double x_m) const { return FloorToInt((x_m - origin_x_m) / resolution_m); }
  int RowOf(double y_m) const { return FloorToInt((y_m - origin_y_m) / resolution_m); }
  Point2 CenterOf(int i, int j) const {
    return {origin_x_m + (i + 0.5) * resolution_m, origin_y_m + (j + 0.5) * resolution_m};
  }

  // Bilinear between cell centres. Outside the grid: -max_distance_m.
  double DistanceAt(const Point2& p) const;
  // kUnknown outside the grid.
  CellState StateAt(const Point2& p) const;

 private:
  static int FloorToInt(double v) {
    const int truncated = static_cast<int>(v);
    return v < truncated ? truncated - 1 : truncated;
  }
};

}  // namespace docent::maps

#endif  // DOCENT_MAPS_DISTANCE_GRID_H_
