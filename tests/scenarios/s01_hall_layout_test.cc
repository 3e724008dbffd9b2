// The checked-in hall of scenario s01 through the code that the robot uses: layout, map, regions.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "maps/hall_layout.h"
#include "maps/hall_model.h"
#include "maps/regions.h"

namespace docent::maps {
namespace {

constexpr char kExpo[] = "https://w3id.org/docent/expo#";

class S01Hall : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto layout = HallLayout::FromFile(DOCENT_SOURCE_DIR "/scenarios/s01_booth_guide/hall.ttl");
    ASSERT_TRUE(layout.ok()) << layout.status();
    layout_ = new HallLayout(*std::move(layout));
  }
  static void TearDownTestSuite() { delete layout_; }

  static HallLayout* layout_;
};
HallLayout* S01Hall::layout_ = nullptr;

TEST_F(S01Hall, HasTwelveBoothsWithNameExhibitorAndServicePoint) {
  std::set<std::string> booths;
  for (const Region& region : layout_->regions) {
    if (!region.is_booth) continue;
    booths.insert(region.name);
    EXPECT_FALSE(region.exhibitor.empty()) << region.iri;
    EXPECT_GT(region.description.size(), 60u) << region.iri;
    EXPECT_TRUE(region.service_point.has_value()) << region.iri;
  }
  EXPECT_EQ(booths.size(), 12u);
  EXPECT_TRUE(booths.contains("B03"));
  Bounds bounds = BoundsOf(layout_->outline);
  EXPECT_EQ(bounds.max_x_m - bounds.min_x_m, 36);
  EXPECT_EQ(bounds.max_y_m - bounds.min_y_m, 24);
}

TEST_F(S01Hall, ARobotAtAServicePointIsAtThatRegionAndTouchesNothing) {
  RegionIndex regions(*layout_);
  auto model = HallModel::FromLayout(*layout_, 0.05);
  ASSERT_TRUE(model.ok()) << model.status();
  int served = 0;
  for (const Region& region : layout_->regions) {
    if (!region.service_point) continue;
    ++served;
    const Region* innermost = regions.Innermost(region.service_point->position());
    ASSERT_NE(innermost, nullptr) << region.iri;
    EXPECT_EQ(innermost->iri, region.iri);
    // Half a metre in the layout; the map may take up to one voxel of it.
    EXPECT_GE((*model)->DistanceAt(region.service_point->x_m, region.service_point->y_m), 0.45) << region.iri;
  }
  EXPECT_EQ(served, 14);
}

TEST_F(S01Hall, WhereRegionsOverlapTheSmallestCounts) {
  RegionIndex regions(*layout_);
  const Region* cafe = regions.Innermost({20, 3});
  ASSERT_NE(cafe, nullptr);
  EXPECT_EQ(cafe->iri, std::string(kExpo) + "Cafe");
  const Region* aisle = regions.Innermost({26, 3});
  ASSERT_NE(aisle, nullptr);
  EXPECT_EQ(aisle->iri, std::string(kExpo) + "SouthAisle");
}

}  // namespace
}  // namespace docent::maps
