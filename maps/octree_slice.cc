#include "maps/octree_slice.h"

#include <dynamicEDT3D/dynamicEDT3D.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace docent::maps {
namespace {

// Paints the slab's known leaves from above; pruned leaves cover many cells at once.
void PaintStates(const octomap::OcTree& tree, const SliceSettings& settings, DistanceGrid& grid) {
  const double far = 1e4;
  const double inner = 1e-6;  // a slab that ends on a voxel's face must not touch the next voxel
  const octomap::point3d low(static_cast<float>(std::max(-far, grid.origin_x_m)),
                             static_cast<float>(std::max(-far, grid.origin_y_m)),
                             static_cast<float>(settings.min_z_m + inner));
  const octomap::point3d high(static_cast<float>(grid.origin_x_m + grid.width * grid.resolution_m),
                              static_cast<float>(grid.origin_y_m + grid.height * grid.resolution_m),
                              static_cast<float>(settings.max_z_m - inner));
  for (auto leaf = tree.begin_leafs_bbx(low, high), end = tree.end_leafs_bbx(); leaf != end; ++leaf) {
    const double half = leaf.getSize() / 2;
    const double cell = grid.resolution_m / 2;
    const int i0 = std::max(0, grid.ColumnOf(leaf.getX() - half + cell));
    const int i1 = std::min(grid.width - 1, grid.ColumnOf(leaf.getX() + half - cell));
    const int j0 = std::max(0, grid.RowOf(leaf.getY() - half + cell));
    const int j1 = std::min(grid.height - 1, grid.RowOf(leaf.getY() + half - cell));
    const bool occupied = tree.isNodeOccupied(*leaf);
    for (int j = j0; j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) {
        CellState& state = grid.state[static_cast<size_t>(j) * grid.width + i];
        if (occupied) {
          state = CellState::kOccupied;
        } else if (state == CellState::kUnknown) {
          state = CellState::kFree;
        }
      }
    }
  }
}

// Distance in metres from every cell's centre to the nearest centre of a cell for which `is_obstacle` holds.
std::vector<float> CenterDistances(const DistanceGrid& grid, double max_distance_m,
                                   const std::function<bool(CellState)>& is_obstacle) {
  const int max_cells = static_cast<int>(std::ceil(max_distance_m / grid.resolution_m));
  DynamicEDT3D field(max_cells * max_cells);
  field.initializeEmpty(grid.width, grid.height, 1);
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i) {
      if (is_obstacle(grid.state[static_cast<size_t>(j) * grid.width + i])) field.occupyCell(i, j, 0);
    }
  }
  field.update(true);
  std::vector<float> distances(grid.state.size());
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i) {
      const double metres = field.getDistance(i, j, 0) * grid.resolution_m;
      distances[static_cast<size_t>(j) * grid.width + i] =
          static_cast<float>(std::min(metres, max_distance_m));
    }
  }
  return distances;
}

}  // namespace

DistanceGrid SliceOctree(const octomap::OcTree& tree, const SliceSettings& settings) {
  double min_x, min_y, min_z, max_x, max_y, max_z;
  tree.getMetricMin(min_x, min_y, min_z);
  tree.getMetricMax(max_x, max_y, max_z);
  DistanceGrid grid;
  grid.resolution_m = tree.getResolution();
  grid.max_distance_m = settings.max_distance_m;
  const double margin_cells = std::ceil(settings.margin_m / grid.resolution_m);
  const double first_column = std::round(min_x / grid.resolution_m) - margin_cells;
  const double first_row = std::round(min_y / grid.resolution_m) - margin_cells;
  grid.origin_x_m = first_column * grid.resolution_m;
  grid.origin_y_m = first_row * grid.resolution_m;
  grid.width = static_cast<int>(std::round(max_x / grid.resolution_m) + margin_cells - first_column);
  grid.height = static_cast<int>(std::round(max_y / grid.resolution_m) + margin_cells - first_row);
  grid.state.assign(static_cast<size_t>(grid.width) * grid.height, CellState::kUnknown);
  PaintStates(tree, settings, grid);

  const bool unknown = settings.unknown_is_obstacle;
  const auto obstacle = [unknown](CellState s) {
    return s == CellState::kOccupied || (unknown && s == CellState::kUnknown);
  };
  grid.distance_m = CenterDistances(grid, settings.max_distance_m, obstacle);
  if (settings.surface_at_centers) return grid;
  const std::vector<float> inside =
      CenterDistances(grid, settings.max_distance_m, [&obstacle](CellState s) { return !obstacle(s); });
  // The surface lies half a cell before the centre of the outermost obstacle cell.
  const float half = static_cast<float>(grid.resolution_m / 2);
  for (size_t k = 0; k < grid.distance_m.size(); ++k) {
    grid.distance_m[k] = obstacle(grid.state[k]) ? half - inside[k] : grid.distance_m[k] - half;
  }
  return grid;
}

}  // namespace docent::maps
