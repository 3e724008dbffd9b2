#include "maps/hall_model.h"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "maps/analytic_scan.h"
#include "tests/maps/layout_quads.h"

namespace docent::maps {
namespace {

const HallLayout& Layout() {
  static const HallLayout layout = *HallLayout::FromQuads(LayoutQuads::SmallHall().quads());
  return layout;
}

const HallModel& Model() {
  static const std::shared_ptr<const HallModel> model = *HallModel::FromLayout(Layout());
  return *model;
}

// Reference for the fields: distance to the nearest shape that reaches `height_m`.
double AnalyticDistance(const Point2& p, double height_m) {
  double nearest = DistanceToOutline(p, Layout().outline);
  for (const Obstacle& o : Layout().obstacles) {
    if (o.height_m <= height_m) continue;
    nearest = std::min(nearest, o.disc ? std::abs(Distance(p, o.disc->center) - o.disc->radius_m)
                                       : DistanceToOutline(p, o.outline));
  }
  return nearest;
}

bool InObstacle(const Point2& p) {
  for (const Obstacle& o : Layout().obstacles) {
    if (o.disc ? Distance(p, o.disc->center) < o.disc->radius_m : Contains(o.outline, p)) return true;
  }
  return false;
}

TEST(HallModel, VoxelsAreSolidFreeOrUnknownAsTheLayoutSays) {
  const octomap::OcTree& tree = Model().octree();
  const auto occupied = [&tree](double x, double y, double z) {
    const octomap::OcTreeNode* node = tree.search(x, y, z);
    return node == nullptr ? -1 : tree.isNodeOccupied(node) ? 1 : 0;
  };
  EXPECT_EQ(occupied(2, 4, 1), 0);
  EXPECT_EQ(occupied(2, 4, -0.02), 1) << "the floor";
  EXPECT_EQ(occupied(2, 4, -0.12), -1) << "below the floor";
  EXPECT_EQ(occupied(2, 4, 3.2), -1) << "above the ceiling";
  EXPECT_EQ(occupied(8.02, 6.3, 0.97), 1) << "the desk";
  EXPECT_EQ(occupied(8.02, 6.3, 1.03), 0) << "above the desk";
  EXPECT_EQ(occupied(4.03, 1, 2.4), 1) << "the partition";
  EXPECT_EQ(occupied(-0.1, 4, 1), 1) << "the outer wall";
  EXPECT_EQ(occupied(-0.4, 4, 1), -1) << "behind the outer wall";
  EXPECT_EQ(occupied(6.1, 4.1, 2), 1) << "the pillar";
}

TEST(HallModel, DistanceFieldsAgreeWithAnalyticDistance) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> x(0.05, 11.95), y(0.05, 7.95);
  double worst_laser = 0, worst_body = 0;
  for (int k = 0; k < 20000; ++k) {
    const Point2 p = {x(random), y(random)};
    if (InObstacle(p)) continue;
    const double laser = std::min(1.9, AnalyticDistance(p, 0.3)),
                 body = std::min(1.9, AnalyticDistance(p, 0.1));
    worst_laser = std::max(worst_laser, std::abs(std::min(1.9, Model().laser_field().DistanceAt(p)) - laser));
    worst_body = std::max(worst_body, std::abs(std::min(1.9, Model().DistanceAt(p.x_m, p.y_m)) - body));
  }
  // Shapes lie within half a voxel's diagonal of their voxels' faces.
  EXPECT_LT(worst_laser, 0.036);
  EXPECT_LT(worst_body, 0.036);
}

TEST(HallModel, OnASurfaceTheDistanceIsZeroAndInsideItIsNegative) {
  EXPECT_NEAR(Model().laser_field().DistanceAt({0, 4}), 0, 1e-4);
  EXPECT_NEAR(Model().laser_field().DistanceAt({4, 1.5}), 0, 1e-4);
  EXPECT_LT(Model().laser_field().DistanceAt({-0.1, 4}), -0.05);
  EXPECT_LT(Model().DistanceAt(6, 4), -0.2);
  EXPECT_LT(Model().DistanceAt(-50, 4), 0);
}

TEST(HallModel, TheLaserFieldPassesOverWhatIsLowerThanTheLaser) {
  EXPECT_GT(Model().laser_field().DistanceAt({1.5, 6.5}), 0.9);
  EXPECT_LT(Model().DistanceAt(1.5, 6.5), 0);
}

TEST(HallModel, AWallThinnerThanAVoxelDoesNotVanish) {
  LayoutQuads quads = LayoutQuads::SmallHall();
  quads.Thing("Foil", "Wall", "POLYGON((2.011 4, 2.014 4, 2.014 5, 2.011 5, 2.011 4))");
  const auto model = HallModel::FromLayout(*HallLayout::FromQuads(quads.quads()));
  ASSERT_TRUE(model.ok());
  for (double y = 4.01; y < 5; y += 0.01) {
    EXPECT_EQ((*model)->laser_field().StateAt({2.0125, y}), CellState::kOccupied) << y;
  }
}

TEST(HallModel, SavedAndLoadedItIsTheSameMap) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "docent_hall_model_test";
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "hall.bt").string();
  ASSERT_TRUE(Model().Save(path).ok());
  const auto loaded = HallModel::Load(path);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ((*loaded)->hash(), Model().hash());
  EXPECT_EQ((*loaded)->laser_field().distance_m, Model().laser_field().distance_m);
  EXPECT_EQ((*loaded)->clearance().distance_m, Model().clearance().distance_m);

  std::ofstream(path, std::ios::binary) << "# Octomap OcTree binary file\nid OcTree\nsize 3\nres x\ndata\n";
  EXPECT_EQ(HallModel::Load(path).status().code(), absl::StatusCode::kInvalidArgument);
  std::ofstream(path, std::ios::binary) << "not a map";
  EXPECT_EQ(HallModel::Load(path).status().code(), absl::StatusCode::kInvalidArgument);
  std::filesystem::remove_all(folder);
  EXPECT_EQ(HallModel::Load(path).status().code(), absl::StatusCode::kNotFound);
  EXPECT_FALSE(Model().Save(path).ok());
}

TEST(HallModel, AnotherLayoutHasAnotherHash) {
  LayoutQuads quads = LayoutQuads::SmallHall();
  quads.Thing("More", "Counter", "POLYGON((1 1, 1.2 1, 1.2 1.2, 1 1))");
  EXPECT_NE((*HallModel::FromLayout(*HallLayout::FromQuads(quads.quads())))->hash(), Model().hash());
}

TEST(HallModel, AMapFromScansHasItsSurfacesWhereTheBeamsEnded) {
  const AnalyticScanner scanner(Layout(), {});
  std::vector<PosedScan> scans;
  for (const Pose2 pose : {Pose2{2, 4, 0}, Pose2{2, 4, 3.1}, Pose2{8, 4.5, 1}, Pose2{8, 4.5, -2}}) {
    scans.push_back({pose, scanner.ExactScan(pose)});
  }
  HallModelSettings settings;
  settings.measured = true;
  const auto model = HallModel::FromScans(scans, 20, settings);
  ASSERT_TRUE(model.ok()) << model.status();
  double sum = 0;
  int beams = 0;
  for (const PosedScan& posed : scans) {
    for (size_t i = 0; i < posed.scan.range_m.size(); ++i) {
      const double bearing = posed.robot_in_hall.heading_rad + posed.scan.first_bearing_rad +
                             static_cast<double>(i) * posed.scan.bearing_step_rad;
      const Pose2 end =
          Compose({posed.robot_in_hall.x_m, posed.robot_in_hall.y_m, bearing}, {posed.scan.range_m[i], 0, 0});
      sum += (*model)->laser_field().DistanceAt(end.position());
      ++beams;
    }
  }
  EXPECT_LT(sum / beams, 0.03) << "mean distance of a beam's end from the surface";
  EXPECT_EQ((*model)->laser_field().StateAt({3, 4}), CellState::kFree);
  EXPECT_EQ((*model)->laser_field().StateAt({11.45, 1}), CellState::kUnknown) << "inside the booth's wall";
  EXPECT_EQ(HallModel::FromScans({}, 20, settings).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(HallModel, RefusesSettingsOutOfRange) {
  HallModelSettings settings;
  settings.resolution_m = 0.001;
  EXPECT_EQ(HallModel::FromLayout(Layout(), settings).status().code(), absl::StatusCode::kInvalidArgument);
  settings = {};
  settings.laser_min_z_m = 1;
  EXPECT_EQ(HallModel::FromLayout(Layout(), settings).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(HallModel::FromOctoMap(nullptr).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(HallModel::FromOctoMap(std::make_unique<octomap::OcTree>(0.05)).status().code(),
            absl::StatusCode::kInvalidArgument);
  HallLayout huge = Layout();
  huge.outline = {{0, 0}, {1e6, 0}, {1e6, 1e6}};
  EXPECT_EQ(HallModel::FromLayout(huge).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace docent::maps
