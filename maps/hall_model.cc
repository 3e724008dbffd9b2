#include "maps/hall_model.h"

#include <octomap/OcTree.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_format.h"
#include "graph/base/fingerprint.h"
#include "graph/base/regular_file.h"
#include "maps/octree_slice.h"
#include "maps/voxelizer.h"

namespace docent::maps {
namespace {

constexpr double kMaxColumns = 1e8;

absl::Status Validate(const HallModelSettings& s) {
  if (!(s.resolution_m >= 0.01 && s.resolution_m <= 0.5)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("hall model: resolution %g m is not in 0.01..0.5", s.resolution_m));
  }
  if (!(s.laser_min_z_m < s.laser_max_z_m) || !(s.body_min_z_m < s.body_max_z_m)) {
    return absl::InvalidArgumentError("hall model: a slab needs its lower z below its upper z");
  }
  if (!(s.max_distance_m > 0 && s.max_distance_m <= 20) || !(s.margin_m >= 0 && s.margin_m <= 20)) {
    return absl::InvalidArgumentError("hall model: max_distance_m is not in 0..20 or margin_m not in 0..20");
  }
  return absl::OkStatus();
}

std::string SystemError(const std::string& what) {
  return what + ": " + std::strerror(errno);
}

// Header of a .bt file as octomap::AbstractOccupancyOcTree::writeBinary writes it. Our own code reads and
// writes it because octomap's functions print to the standard streams.
constexpr std::string_view kBtFirstLine = "# Octomap OcTree binary file";

absl::StatusOr<double> ReadBtHeader(std::istream& in) {
  std::string line, word;
  if (!std::getline(in, line) || line.rfind(kBtFirstLine, 0) != 0) {
    return absl::InvalidArgumentError("the first line is not that of an OctoMap .bt file");
  }
  double resolution_m = 0;
  for (int lines = 0; lines < 100 && in >> word; ++lines) {
    if (word == "data") {
      in.get();  // the newline before the voxels
      if (resolution_m > 0) return resolution_m;
      return absl::InvalidArgumentError("the header has no line 'res'");
    }
    std::getline(in, line);
    if (word == "res" && !absl::SimpleAtod(line, &resolution_m)) resolution_m = 0;
    if (word == "id" && line.find("OcTree") == std::string::npos) {
      return absl::InvalidArgumentError("not an OcTree:" + line);
    }
  }
  return absl::InvalidArgumentError("the header does not end with 'data'");
}

}  // namespace

HallModel::~HallModel() = default;

HallModel::HallModel(std::unique_ptr<octomap::OcTree> tree, const HallModelSettings& settings)
    : tree_(std::move(tree)), settings_(settings) {
  settings_.resolution_m = tree_->getResolution();
  clearance_ = SliceOctree(*tree_, {settings.body_min_z_m, settings.body_max_z_m, settings.max_distance_m,
                                    settings.margin_m, true, false});
  laser_field_ = SliceOctree(*tree_, {settings.laser_min_z_m, settings.laser_max_z_m, settings.max_distance_m,
                                      settings.margin_m, false, settings.measured});
  std::ostringstream voxels;
  tree_->writeBinaryNode(voxels, tree_->getRoot());
  hash_ = Fingerprint(std::move(voxels).str());
  hash_ =
      Fingerprint(absl::StrFormat("%.17g %.17g %.17g %.17g %.17g %.17g %d", settings_.resolution_m,
                                  settings_.laser_min_z_m, settings_.laser_max_z_m, settings_.body_min_z_m,
                                  settings_.body_max_z_m, settings_.max_distance_m, settings_.measured),
                  hash_);
}

absl::StatusOr<std::shared_ptr<const HallModel>> HallModel::FromLayout(const HallLayout& layout,
                                                                       double resolution_m) {
  HallModelSettings settings;
  settings.resolution_m = resolution_m;
  return FromLayout(layout, settings);
}

absl::StatusOr<std::shared_ptr<const HallModel>> HallModel::FromLayout(const HallLayout& layout,
                                                                       const HallModelSettings& settings) {
  if (absl::Status s = Validate(settings); !s.ok()) return s;
  if (layout.outline.empty()) return absl::InvalidArgumentError("hall model: the layout has no outline");
  const Bounds b = BoundsOf(layout.outline);
  const double width_m = b.max_x_m - b.min_x_m, depth_m = b.max_y_m - b.min_y_m;
  const double columns = width_m / settings.resolution_m * (depth_m / settings.resolution_m);
  // An octree of depth 16 reaches 32768 voxels from the origin.
  const double reach_m = 32000 * settings.resolution_m;
  const bool too_far =
      b.min_x_m < -reach_m || b.min_y_m < -reach_m || b.max_x_m > reach_m || b.max_y_m > reach_m;
  if (columns > kMaxColumns || too_far || layout.height_m > reach_m) {
    return absl::InvalidArgumentError(
        absl::StrFormat("hall model: %s of %g x %g m is too large at %g m resolution", layout.iri, width_m,
                        depth_m, settings.resolution_m));
  }
  return std::shared_ptr<const HallModel>(new HallModel(Voxelize(layout, settings.resolution_m), settings));
}

absl::StatusOr<std::shared_ptr<const HallModel>> HallModel::FromOctoMap(std::unique_ptr<octomap::OcTree> tree,
                                                                        const HallModelSettings& settings) {
  HallModelSettings with_tree = settings;
  if (tree == nullptr || tree->size() <= 1)
    return absl::InvalidArgumentError("hall model: the octree is empty");
  with_tree.resolution_m = tree->getResolution();
  if (absl::Status s = Validate(with_tree); !s.ok()) return s;
  double low[3], high[3];
  tree->getMetricMin(low[0], low[1], low[2]);
  tree->getMetricMax(high[0], high[1], high[2]);
  const double area = (high[0] - low[0] + 2 * settings.margin_m) * (high[1] - low[1] + 2 * settings.margin_m);
  if (area / (with_tree.resolution_m * with_tree.resolution_m) > kMaxColumns) {
    return absl::InvalidArgumentError(absl::StrFormat("hall model: an octree of %g m² is too large", area));
  }
  std::shared_ptr<const HallModel> model(new HallModel(std::move(tree), with_tree));
  for (const CellState state : model->laser_field().state) {
    if (state == CellState::kOccupied) return model;
  }
  return absl::InvalidArgumentError(absl::StrFormat("hall model: nothing is occupied between z %g and %g m",
                                                    settings.laser_min_z_m, settings.laser_max_z_m));
}

absl::StatusOr<std::shared_ptr<const HallModel>> HallModel::FromScans(const std::vector<PosedScan>& scans,
                                                                      double max_range_m,
                                                                      const HallModelSettings& settings) {
  if (absl::Status s = Validate(settings); !s.ok()) return s;
  auto tree = std::make_unique<octomap::OcTree>(settings.resolution_m);
  const double z_m = (settings.laser_min_z_m + settings.laser_max_z_m) / 2;
  for (const PosedScan& posed : scans) {
    const Pose2 sensor = Compose(posed.robot_in_hall, posed.scan.sensor_in_robot);
    octomap::Pointcloud ends;
    for (size_t i = 0; i < posed.scan.range_m.size(); ++i) {
      const double range = posed.scan.range_m[i];
      if (!(range > 0) || range >= std::min(max_range_m, posed.scan.max_range_m)) continue;
      const double bearing = sensor.heading_rad + posed.scan.first_bearing_rad +
                             static_cast<double>(i) * posed.scan.bearing_step_rad;
      ends.push_back(static_cast<float>(sensor.x_m + range * std::cos(bearing)),
                     static_cast<float>(sensor.y_m + range * std::sin(bearing)), static_cast<float>(z_m));
    }
    const octomap::point3d origin(static_cast<float>(sensor.x_m), static_cast<float>(sensor.y_m),
                                  static_cast<float>(z_m));
    tree->insertPointCloud(ends, origin, -1, true);
  }
  tree->updateInnerOccupancy();
  tree->toMaxLikelihood();  // as a .bt file stores it, so that the saved map equals this one
  tree->prune();
  return FromOctoMap(std::move(tree), settings);
}

absl::StatusOr<std::shared_ptr<const HallModel>> HallModel::Load(const std::string& bt_path,
                                                                 const HallModelSettings& settings) {
  if (absl::Status status = CheckRegularFile(bt_path); absl::IsInvalidArgument(status)) return status;
  std::ifstream in(bt_path, std::ios::binary);
  if (!in) return absl::NotFoundError(SystemError("cannot read the map " + bt_path));
  const absl::StatusOr<double> resolution_m = ReadBtHeader(in);
  if (!resolution_m.ok()) {
    return absl::InvalidArgumentError(bt_path + ": " + std::string(resolution_m.status().message()));
  }
  auto tree = std::make_unique<octomap::OcTree>(*resolution_m);
  tree->readBinaryData(in);
  if (!in) return absl::InvalidArgumentError(bt_path + ": the voxels end too early");
  return FromOctoMap(std::move(tree), settings);
}

absl::Status HallModel::Save(const std::string& bt_path) const {
  const std::string temporary = bt_path + ".new";
  {
    std::ofstream out(temporary, std::ios::binary);
    if (!out) return absl::PermissionDeniedError(SystemError("cannot write the map " + temporary));
    out << kBtFirstLine
        << "\n# (feel free to add / change comments, but leave the first line as it is!)\n#\nid "
        << tree_->getTreeType() << "\nsize " << tree_->size() << "\nres " << settings_.resolution_m
        << "\ndata\n";
    tree_->writeBinaryNode(out, tree_->getRoot());
    out.flush();
    if (!out) return absl::UnavailableError(SystemError("cannot write the map " + temporary));
  }
  if (std::rename(temporary.c_str(), bt_path.c_str()) != 0) {
    return absl::UnavailableError(SystemError("cannot write the map " + bt_path));
  }
  return absl::OkStatus();
}

}  // namespace docent::maps
