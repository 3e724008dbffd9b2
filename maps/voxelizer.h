// Conversion of a hall layout to an octree. Used only by HallModel; keeps OctoMap's types out of the public
// headers. Pure; any thread.
#ifndef DOCENT_MAPS_VOXELIZER_H_
#define DOCENT_MAPS_VOXELIZER_H_

#include <memory>

#include "maps/hall_layout.h"

namespace octomap {
class OcTree;
}

namespace docent::maps {

// Thickness in the map of walls beyond the hall's outline; the space behind them is unknown.
inline constexpr double kOuterWallThickness_m = 0.20;

// A voxel is occupied if its centre lies in an obstacle, in the outer wall, or in the floor's only layer;
// free between obstacle and ceiling inside the hall; unknown elsewhere. An obstacle thinner than a voxel
// becomes one voxel thick, so none vanishes. The tree is pruned and holds only the two clamping values.
std::unique_ptr<octomap::OcTree> Voxelize(const HallLayout& layout, double resolution_m);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_VOXELIZER_H_
