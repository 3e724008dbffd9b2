#include "maps/voxelizer.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace docent::maps {
namespace {

constexpr int kTreeDepth = 16;                     // of every octomap::OcTree
constexpr int kCenterKey = 1 << (kTreeDepth - 1);  // key of the voxel whose corner is the origin

// One row of cells across a polygon: which of its points are inside, by the same rule as maps::Contains (even-odd), but for
// all of them at the cost of one look at the edges. A large floor has millions of cells and thousands of edges.
class PolygonRow {
 public:
  PolygonRow(const Polygon& polygon, double y_m) {
    for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
      const Point2 &a = polygon[i], &b = polygon[j];
      if ((a.y_m > y_m) == (b.y_m > y_m)) continue;
      crossings_m_.push_back((b.x_m - a.x_m) * (y_m - a.y_m) / (b.y_m - a.y_m) + a.x_m);
    }
    std::sort(crossings_m_.begin(), crossings_m_.end());
  }

  bool Contains(double x_m) const {
    return (crossings_m_.end() - std::upper_bound(crossings_m_.begin(), crossings_m_.end(), x_m)) % 2 == 1;
  }

 private:
  std::vector<double> crossings_m_;
};

// The hall from above. All solid objects stand on the floor, so a column is one number: the count of solid
// voxels above the floor.
class ColumnMap {
 public:
  static constexpr int kUnknownColumn = -1;

  ColumnMap(const HallLayout& layout, double resolution_m) : resolution_m_(resolution_m) {
    const Bounds bounds = BoundsOf(layout.outline);
    x0_ = Voxel(bounds.min_x_m - kOuterWallThickness_m) - 1;
    y0_ = Voxel(bounds.min_y_m - kOuterWallThickness_m) - 1;
    width_ = Voxel(bounds.max_x_m + kOuterWallThickness_m) + 2 - x0_;
    height_ = Voxel(bounds.max_y_m + kOuterWallThickness_m) + 2 - y0_;
    ceiling_ = Layers(layout.height_m);
    solid_.assign(static_cast<size_t>(width_) * height_, kUnknownColumn);
    DrawHall(layout.outline);
    for (const Obstacle& obstacle : layout.obstacles) DrawObstacle(obstacle);
  }

  // Content of the cube of `size` voxels whose lowest corner is voxel (x, y, z), counted from the origin.
  enum class Fill { kUnknown, kFree, kOccupied, kMixed };
  Fill FillOf(int x, int y, int z, int size) const {
    if (z + size <= -1 || z >= ceiling_) return Fill::kUnknown;
    const int first_x = std::max(x, x0_), last_x = std::min(x + size, x0_ + width_);
    const int first_y = std::max(y, y0_), last_y = std::min(y + size, y0_ + height_);
    if (first_x >= last_x || first_y >= last_y) return Fill::kUnknown;
    const bool cut =
        last_x - first_x < size || last_y - first_y < size;  // columns beyond the map are unknown
    int low = cut ? kUnknownColumn : solid_[Index(first_x, first_y)];
    int high = low;
    for (int row = first_y; row < last_y; ++row) {
      for (int column = first_x; column < last_x; ++column) {
        const int solid = solid_[Index(column, row)];
        low = std::min(low, solid);
        high = std::max(high, solid);
        if (low == kUnknownColumn && high != kUnknownColumn) return Fill::kMixed;
      }
    }
    if (high == kUnknownColumn) return Fill::kUnknown;
    if (z >= -1 && z + size <= low) return Fill::kOccupied;
    if (z >= high && z + size <= ceiling_) return Fill::kFree;
    return Fill::kMixed;
  }

 private:
  int Voxel(double metres) const { return static_cast<int>(std::floor(metres / resolution_m_ + 1e-9)); }
  // Number of voxels whose centre is below `height_m`.
  int Layers(double height_m) const {
    return static_cast<int>(std::ceil(height_m / resolution_m_ - 0.5 - 1e-9));
  }
  size_t Index(int x, int y) const { return static_cast<size_t>(y - y0_) * width_ + (x - x0_); }
  Point2 Center(int x, int y) const { return {(x + 0.5) * resolution_m_, (y + 0.5) * resolution_m_}; }

  void DrawHall(const Polygon& outline) {
    for (int y = y0_; y < y0_ + height_; ++y) {
      const PolygonRow row(outline, Center(0, y).y_m);
      for (int x = x0_; x < x0_ + width_; ++x) {
        if (row.Contains(Center(x, y).x_m)) solid_[Index(x, y)] = 0;
      }
    }
    for (size_t i = 0; i < outline.size(); ++i) DrawOuterWall(outline[i], outline[(i + 1) % outline.size()]);
  }

  // The wall beyond one edge of the outline: what is near it and not inside the hall.
  void DrawOuterWall(const Point2& a, const Point2& b) {
    const Bounds bounds = BoundsOf({a, b});
    const int x1 = std::min(x0_ + width_ - 1, Voxel(bounds.max_x_m + kOuterWallThickness_m));
    const int y1 = std::min(y0_ + height_ - 1, Voxel(bounds.max_y_m + kOuterWallThickness_m));
    for (int y = std::max(y0_, Voxel(bounds.min_y_m - kOuterWallThickness_m)); y <= y1; ++y) {
      for (int x = std::max(x0_, Voxel(bounds.min_x_m - kOuterWallThickness_m)); x <= x1; ++x) {
        int& solid = solid_[Index(x, y)];
        if (solid == kUnknownColumn && DistanceToSegment(Center(x, y), a, b) < kOuterWallThickness_m)
          solid = ceiling_;
      }
    }
  }

  // The voxels of one obstacle, seen from above.
  struct Footprint {
    int x0, y0, width, height;
    std::vector<bool> solid;
    bool At(int x, int y) const {
      return x >= x0 && y >= y0 && x < x0 + width && y < y0 + height && solid[(y - y0) * width + (x - x0)];
    }
    bool AtOrBeside(int x, int y) const {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          if (At(x + dx, y + dy)) return true;
        }
      }
      return false;
    }
  };

  void DrawObstacle(const Obstacle& obstacle) {
    const int layers = std::min(ceiling_, std::max(1, Layers(obstacle.height_m)));
    const Footprint footprint = FootprintOf(obstacle);
    for (int y = footprint.y0; y < footprint.y0 + footprint.height; ++y) {
      for (int x = footprint.x0; x < footprint.x0 + footprint.width; ++x) {
        if (footprint.At(x, y)) Raise(x, y, layers);
      }
    }
    if (obstacle.disc) {
      Raise(Voxel(obstacle.disc->center.x_m), Voxel(obstacle.disc->center.y_m), layers);
    } else {
      DrawThinParts(obstacle.outline, footprint, layers);
    }
  }

  Footprint FootprintOf(const Obstacle& obstacle) const {
    Bounds bounds;
    if (obstacle.disc) {
      const Disc& d = *obstacle.disc;
      bounds = {d.center.x_m - d.radius_m, d.center.y_m - d.radius_m, d.center.x_m + d.radius_m,
                d.center.y_m + d.radius_m};
    } else {
      bounds = BoundsOf(obstacle.outline);
    }
    const int x0 = std::max(x0_, Voxel(bounds.min_x_m)), y0 = std::max(y0_, Voxel(bounds.min_y_m));
    const int x1 = std::min(x0_ + width_ - 1, Voxel(bounds.max_x_m));
    const int y1 = std::min(y0_ + height_ - 1, Voxel(bounds.max_y_m));
    Footprint footprint = {x0, y0, std::max(0, x1 - x0 + 1), std::max(0, y1 - y0 + 1), {}};
    for (int y = y0; y <= y1; ++y) {
      const PolygonRow row(obstacle.outline, Center(0, y).y_m);
      for (int x = x0; x <= x1; ++x) {
        const Point2 center = Center(x, y);
        footprint.solid.push_back(obstacle.disc
                                      ? Distance(center, obstacle.disc->center) <= obstacle.disc->radius_m
                                      : row.Contains(center.x_m));
      }
    }
    return footprint;
  }

  // An obstacle thinner than a voxel may contain no centre: there the voxels of its outline are drawn.
  void DrawThinParts(const Polygon& outline, const Footprint& footprint, int layers) {
    for (size_t i = 0; i < outline.size(); ++i) {
      const Point2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
      const int steps = 1 + static_cast<int>(2 * Distance(a, b) / resolution_m_);
      for (int k = 0; k <= steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        const int x = Voxel(a.x_m + t * (b.x_m - a.x_m)), y = Voxel(a.y_m + t * (b.y_m - a.y_m));
        if (!footprint.AtOrBeside(x, y)) Raise(x, y, layers);
      }
    }
  }

  bool InMap(int x, int y) const { return x >= x0_ && y >= y0_ && x < x0_ + width_ && y < y0_ + height_; }

  void Raise(int x, int y, int layers) {
    if (InMap(x, y)) solid_[Index(x, y)] = std::max(solid_[Index(x, y)], layers);
  }

  double resolution_m_;
  int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;  // in voxels from the origin
  int ceiling_ = 0;
  std::vector<int> solid_;
};

// Builds a pruned tree from the root down: 50 times faster than setting 14 million voxels one by one.
class HallTree : public octomap::OcTree {
 public:
  explicit HallTree(double resolution_m) : OcTree(resolution_m) {}

  void Build(const ColumnMap& columns) {
    clear();
    root = new octomap::OcTreeNode();
    tree_size = 1;
    size_changed = true;
    Split(root, columns, -kCenterKey, -kCenterKey, -kCenterKey, 1 << kTreeDepth);
  }

 private:
  void Split(octomap::OcTreeNode* node, const ColumnMap& columns, int x, int y, int z, int size) {
    const int half = size / 2;
    for (unsigned child = 0; child < 8; ++child) {
      const int cx = x + (child & 1 ? half : 0), cy = y + (child & 2 ? half : 0),
                cz = z + (child & 4 ? half : 0);
      const ColumnMap::Fill fill = columns.FillOf(cx, cy, cz, half);
      if (fill == ColumnMap::Fill::kUnknown) continue;
      octomap::OcTreeNode* made = createNodeChild(node, child);
      if (fill == ColumnMap::Fill::kMixed) {
        Split(made, columns, cx, cy, cz, half);
      } else {
        made->setLogOdds(fill == ColumnMap::Fill::kOccupied ? getClampingThresMaxLog()
                                                            : getClampingThresMinLog());
      }
    }
    if (nodeHasChildren(node)) node->updateOccupancyChildren();
  }
};

}  // namespace

std::unique_ptr<octomap::OcTree> Voxelize(const HallLayout& layout, double resolution_m) {
  auto tree = std::make_unique<HallTree>(resolution_m);
  tree->Build(ColumnMap(layout, resolution_m));
  return tree;
}

}  // namespace docent::maps
