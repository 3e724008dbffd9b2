#include "maps/import/floor_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "maps/wkt.h"

namespace docent::maps {
namespace {

// A corner of cells: (0, 0) is the lower left one of the grid.
struct Corner {
  int x = 0;
  int y = 0;
  friend bool operator==(const Corner&, const Corner&) = default;
};

constexpr std::array<Corner, 4> kSteps = {
    Corner{1, 0}, {0, 1}, {-1, 0}, {0, -1}};  // east, north, west, south
// Borders with so few corners are kept as they are.
constexpr size_t kSmallRing = 8;

class FreeSpace {
 public:
  explicit FreeSpace(const OccupancyGrid& grid) : grid_(grid), free_(grid.cells.size(), 0) {
    for (size_t i = 0; i < free_.size(); ++i) free_[i] = grid.cells[i] == MapCell::kFree;
  }

  // False: there is none.
  bool Find() {
    do {
      if (!KeepLargest()) return false;
    } while (GiveUpCorners());
    return true;
  }

  bool At(int x, int y) const {
    return x >= 0 && y >= 0 && x < grid_.width && y < grid_.height && free_[Index(x, y)] != 0;
  }

 private:
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * grid_.width + x; }

  // Keeps the largest area (of equal ones the first); clears all others.
  bool KeepLargest() {
    std::vector<uint32_t> area_of(free_.size(), 0);
    uint32_t areas = 0, best = 0;
    size_t best_size = 0;
    std::vector<size_t> queue;
    for (size_t first = 0; first < free_.size(); ++first) {
      if (free_[first] == 0 || area_of[first] != 0) continue;
      area_of[first] = ++areas;
      queue.assign(1, first);
      for (size_t at = 0; at < queue.size(); ++at) {
        const int x = static_cast<int>(queue[at] % grid_.width),
                  y = static_cast<int>(queue[at] / grid_.width);
        for (const Corner& step : kSteps) {
          if (!At(x + step.x, y + step.y)) continue;
          const size_t next = Index(x + step.x, y + step.y);
          if (area_of[next] != 0) continue;
          area_of[next] = areas;
          queue.push_back(next);
        }
      }
      if (queue.size() > best_size) {
        best_size = queue.size();
        best = areas;
      }
    }
    if (best == 0) return false;
    for (size_t i = 0; i < free_.size(); ++i) free_[i] = area_of[i] == best;
    return true;
  }

  // Gives up one of two free cells that touch by a corner only. True: there was such a pair.
  bool GiveUpCorners() {
    bool any = false;
    for (int y = 0; y + 1 < grid_.height; ++y) {
      for (int x = 0; x + 1 < grid_.width; ++x) {
        const bool sw = At(x, y), se = At(x + 1, y), nw = At(x, y + 1), ne = At(x + 1, y + 1);
        if (sw != ne || se != nw || sw == se) continue;
        free_[sw ? Index(x, y) : Index(x + 1, y)] = 0;
        any = true;
      }
    }
    return any;
  }

  const OccupancyGrid& grid_;
  std::vector<uint8_t> free_;
};

// The borders of free space, each with it to the left.
class BorderTracer {
 public:
  BorderTracer(const OccupancyGrid& grid, const FreeSpace& free)
      : grid_(grid), free_(free), traced_(grid.cells.size(), 0) {}

  ImportedFloor Trace() {
    for (int y = 0; y < grid_.height; ++y) {
      for (int x = 0; x < grid_.width; ++x) {
        // Each border has a free cell with something below it.
        if (!free_.At(x, y) || free_.At(x, y - 1) || traced_[Index(x, y)] != 0) continue;
        TraceFrom({x, y});
      }
    }
    return std::move(floor_);
  }

 private:
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * grid_.width + x; }

  // The cell to the left of a step from `at` in direction `way`, or to its right.
  static Corner LeftOf(const Corner& at, int way) {
    constexpr std::array<Corner, 4> kLeft = {Corner{0, 0}, {-1, 0}, {-1, -1}, {0, -1}};
    return {at.x + kLeft[way].x, at.y + kLeft[way].y};
  }
  static Corner RightOf(const Corner& at, int way) { return LeftOf(at, (way + 3) % 4); }
  bool IsFree(const Corner& cell) const { return free_.At(cell.x, cell.y); }

  void TraceFrom(const Corner& start) {
    std::vector<Corner> ring;
    bool occupied = false;
    Corner at = start;
    int way = 0;  // east, with the free cell above
    do {
      if (way == 0) traced_[Index(at.x, at.y)] = 1;
      const Corner beside = RightOf(at, way);
      occupied = occupied || grid_.At(beside.x, beside.y) == MapCell::kOccupied;
      at = {at.x + kSteps[way].x, at.y + kSteps[way].y};
      const int before = way;
      if (IsFree(RightOf(at, way))) {
        way = (way + 3) % 4;
      } else if (!IsFree(LeftOf(at, way))) {
        way = (way + 1) % 4;
      }
      if (way != before) ring.push_back(at);
    } while (!(at == start && way == 0));
    Keep(ring, occupied);
  }

  void Keep(const std::vector<Corner>& ring, bool occupied) {
    int64_t twice_area = 0;
    for (size_t i = 0; i < ring.size(); ++i) {
      const Corner &a = ring[i], &b = ring[(i + 1) % ring.size()];
      twice_area += static_cast<int64_t>(a.x) * b.y - static_cast<int64_t>(b.x) * a.y;
    }
    Polygon outline = InMap(Simplified(ring));
    if (twice_area > 0) {
      floor_.outline = std::move(outline);
    } else {
      floor_.obstacles.push_back({std::move(outline), occupied});
    }
  }

  // In cells. The largest error that gives a simple polygon: a cell, a half, or none.
  Polygon Simplified(const std::vector<Corner>& ring) const {
    Polygon exact;
    for (const Corner& corner : ring)
      exact.push_back({static_cast<double>(corner.x), static_cast<double>(corner.y)});
    if (exact.size() <= kSmallRing) return exact;
    for (const double error : {1.0, 0.5}) {
      Polygon simple = Reduced(exact, error);
      if (simple.size() >= 3 && Area(simple) > 0 && !CrossesItself(simple)) return simple;
    }
    return exact;
  }

  // Douglas and Peucker on the two halves of the ring between its first corner and the one furthest from it.
  static Polygon Reduced(const Polygon& ring, double error) {
    size_t far = 0;
    for (size_t i = 0; i < ring.size(); ++i) {
      if (Distance(ring[0], ring[i]) > Distance(ring[0], ring[far])) far = i;
    }
    std::vector<bool> kept(ring.size(), false);
    kept[0] = kept[far] = true;
    std::vector<std::pair<size_t, size_t>> open = {{0, far}, {far, ring.size()}};
    while (!open.empty()) {
      const auto [first, last] = open.back();
      open.pop_back();
      double worst = error;
      size_t at = 0;
      for (size_t i = first + 1; i < last; ++i) {
        const double distance = DistanceToSegment(ring[i], ring[first], ring[last % ring.size()]);
        if (distance > worst) {
          worst = distance;
          at = i;
        }
      }
      if (at == 0) continue;
      kept[at] = true;
      open.push_back({first, at});
      open.push_back({at, last});
    }
    Polygon out;
    for (size_t i = 0; i < ring.size(); ++i) {
      if (kept[i]) out.push_back(ring[i]);
    }
    return out;
  }

  Polygon InMap(Polygon cells) const {
    for (Point2& p : cells) {
      p = Compose(grid_.origin, {p.x_m * grid_.resolution_m, p.y_m * grid_.resolution_m, 0}).position();
    }
    return cells;
  }

  const OccupancyGrid& grid_;
  const FreeSpace& free_;
  std::vector<uint8_t> traced_;  // free cells whose lower side was passed
  ImportedFloor floor_;
};

}  // namespace

absl::StatusOr<ImportedFloor> ShapeOf(const OccupancyGrid& grid) {
  FreeSpace free(grid);
  if (!free.Find()) {
    return absl::InvalidArgumentError(
        "no cell of the image is free; look at negate and free_thresh in its description");
  }
  return BorderTracer(grid, free).Trace();
}

}  // namespace docent::maps
