// A robot's map of the hall: an OctoMap (free, occupied, unknown voxels) and two distance fields made from
// it, one in the plane of the laser (localisation) and one over the height of the robot (planning).
//
// Immutable and shared by all robots of a process as shared_ptr<const HallModel>; any thread.
#ifndef DOCENT_MAPS_HALL_MODEL_H_
#define DOCENT_MAPS_HALL_MODEL_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "maps/distance_grid.h"
#include "maps/hall_layout.h"
#include "maps/laser_scan.h"

namespace octomap {
class OcTree;
}

namespace docent::maps {

struct HallModelSettings {
  double resolution_m = 0.05;    // 0.01..0.5: edge of a voxel (for a layout; an octree has its own)
  double laser_min_z_m = 0.275;  // slab that the laser sees: around ScannerSettings::height_m
  double laser_max_z_m = 0.325;
  double body_min_z_m = 0.10;  // height band of the robot's body
  double body_max_z_m = 1.20;
  double max_distance_m = 2.0;  // distance fields are cut off here; planning ignores larger distances
  double margin_m = 1.0;        // unknown space kept around the mapped space
  // Position of surfaces. False: along the faces of occupied voxels (a drawn layout). True: through their
  // middle (a map from measured points, which lie anywhere in their voxel). Used for the plane of the laser.
  bool measured = false;
};

// A scan taken at a known pose: the input for mapping a real building.
struct PosedScan {
  Pose2 robot_in_hall;
  LaserScan scan;
};

class HallModel {
 public:
  ~HallModel();
  HallModel(const HallModel&) = delete;
  HallModel& operator=(const HallModel&) = delete;

  // Voxelises the layout. A voxel is occupied if its centre lies in an obstacle or beyond the hall's outline
  // (within one wall's thickness), free inside the hall above and beside obstacles, unknown elsewhere.
  // INVALID_ARGUMENT: settings out of range, or a hall of more than 10^8 columns at this resolution.
  static absl::StatusOr<std::shared_ptr<const HallModel>> FromLayout(const HallLayout& layout,
                                                                     double resolution_m = 0.05);
  static absl::StatusOr<std::shared_ptr<const HallModel>> FromLayout(const HallLayout& layout,
                                                                     const HallModelSettings& settings);

  // From the map of a real building. Takes the tree. INVALID_ARGUMENT if the slab of the laser is empty.
  static absl::StatusOr<std::shared_ptr<const HallModel>> FromOctoMap(std::unique_ptr<octomap::OcTree> tree,
                                                                      const HallModelSettings& settings = {});

  // Maps a real building: every beam marks the voxels on its way at the height of the laser's slab as free
  // and its end voxel as occupied (OctoMap's insertion of point clouds, with its default probabilities).
  // Beams longer than `max_range_m` are not used. INVALID_ARGUMENT if no beam is left.
  static absl::StatusOr<std::shared_ptr<const HallModel>> FromScans(const std::vector<PosedScan>& scans,
                                                                    double max_range_m,
                                                                    const HallModelSettings& settings);

  // Reads a binary octree (.bt). NOT_FOUND, or INVALID_ARGUMENT if it is not one.
  static absl::StatusOr<std::shared_ptr<const HallModel>> Load(const std::string& bt_path,
                                                               const HallModelSettings& settings = {});
  // Writes the octree as .bt (through a temporary file in the same folder). PERMISSION_DENIED, or the
  // system's error.
  absl::Status Save(const std::string& bt_path) const;

  // Clearance at a point: distance from the robot's body to the nearest obstacle, in metres, cut off at
  // max_distance_m. 0 or less in occupied or unknown space and outside the map.
  double DistanceAt(double x_m, double y_m) const { return clearance_.DistanceAt({x_m, y_m}); }

  // For cells where the body band is free: distance to the nearest cell that is occupied or unknown.
  const DistanceGrid& clearance() const { return clearance_; }
  // The plane of the laser: distance to the nearest occupied cell; unknown cells count as empty.
  const DistanceGrid& laser_field() const { return laser_field_; }

  const octomap::OcTree& octree() const { return *tree_; }
  const HallModelSettings& settings() const { return settings_; }
  // A hash of voxels and settings: equal hashes mean equal maps. Recorded in the log when a map comes into
  // use.
  uint64_t hash() const { return hash_; }

 private:
  HallModel(std::unique_ptr<octomap::OcTree> tree, const HallModelSettings& settings);

  std::unique_ptr<octomap::OcTree> tree_;
  HallModelSettings settings_;
  DistanceGrid clearance_;
  DistanceGrid laser_field_;
  uint64_t hash_ = 0;
};

}  // namespace docent::maps

#endif  // DOCENT_MAPS_HALL_MODEL_H_
