// A horizontal slab of an octree, flattened into a DistanceGrid. Used by HallModel only. Pure; any thread.
#ifndef DOCENT_MAPS_OCTREE_SLICE_H_
#define DOCENT_MAPS_OCTREE_SLICE_H_

#include "maps/distance_grid.h"

namespace octomap {
class OcTree;
}

namespace docent::maps {

struct SliceSettings {
  double min_z_m = 0;  // voxels that touch the slab [min_z, max_z] count
  double max_z_m = 0;
  double max_distance_m = 0;
  double margin_m = 0;               // unknown cells added around the tree's known space
  bool unknown_is_obstacle = false;  // measure distances to unknown cells as well
  bool surface_at_centers =
      false;  // surfaces run through the middle of occupied cells, not along their faces
};

// A cell is occupied if any voxel of its column in the slab is, else free if any is, else unknown. Distances
// by dynamicEDT3D (Lau, Sprunk, Burgard: Efficient grid-based spatial representations, RAS 2013) on that
// layer.
DistanceGrid SliceOctree(const octomap::OcTree& tree, const SliceSettings& settings);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_OCTREE_SLICE_H_
