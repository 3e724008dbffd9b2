#include "maps/hall_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/maps/layout_quads.h"

namespace docent::maps {
namespace {

using ::testing::HasSubstr;

std::string ErrorOf(const LayoutQuads& quads) {
  const absl::StatusOr<HallLayout> layout = HallLayout::FromQuads(quads.quads());
  return layout.ok() ? "no error" : std::string(layout.status().message());
}

TEST(HallLayout, ReadsEverythingOfAHall) {
  const absl::StatusOr<HallLayout> layout = HallLayout::FromQuads(LayoutQuads::SmallHall().quads());
  ASSERT_TRUE(layout.ok()) << layout.status();
  EXPECT_EQ(layout->iri, LayoutQuads::Iri("Hall"));
  EXPECT_EQ(layout->name, "Hall");
  EXPECT_DOUBLE_EQ(Area(layout->outline), 96);
  ASSERT_EQ(layout->obstacles.size(), 6u);
  EXPECT_TRUE(std::is_sorted(layout->obstacles.begin(), layout->obstacles.end(),
                             [](const Obstacle& a, const Obstacle& b) { return a.iri < b.iri; }));
  const auto pillar = std::find_if(layout->obstacles.begin(), layout->obstacles.end(),
                                   [](const Obstacle& o) { return o.kind == ObstacleKind::kPillar; });
  ASSERT_NE(pillar, layout->obstacles.end());
  EXPECT_DOUBLE_EQ(pillar->disc->radius_m, 0.3);
  const Region* booth = layout->FindRegion(LayoutQuads::Iri("B1"));
  ASSERT_NE(booth, nullptr);
  EXPECT_TRUE(booth->is_booth);
  EXPECT_EQ(booth->name, "First booth");
  EXPECT_EQ(*booth->service_point, (Pose2{10, 2.2, -1.571}));
  EXPECT_FALSE(layout->FindRegion(LayoutQuads::Iri("East"))->is_booth);
  EXPECT_EQ(layout->FindRegion("urn:nowhere"), nullptr);
}

TEST(HallLayout, AnObstacleWithoutHeightReachesTheCeiling) {
  const absl::StatusOr<HallLayout> layout = HallLayout::FromQuads(LayoutQuads::SmallHall().quads());
  const auto side = std::find_if(layout->obstacles.begin(), layout->obstacles.end(),
                                 [](const Obstacle& o) { return o.iri == LayoutQuads::Iri("B1Side"); });
  EXPECT_DOUBLE_EQ(side->height_m, 3);
}

TEST(HallLayout, DoesNotDependOnTheOrderOfQuads) {
  std::vector<TermQuad> quads = LayoutQuads::SmallHall().quads();
  const absl::StatusOr<HallLayout> forwards = HallLayout::FromQuads(quads);
  std::reverse(quads.begin(), quads.end());
  const absl::StatusOr<HallLayout> backwards = HallLayout::FromQuads(quads);
  ASSERT_TRUE(forwards.ok() && backwards.ok());
  ASSERT_EQ(forwards->obstacles.size(), backwards->obstacles.size());
  for (size_t i = 0; i < forwards->obstacles.size(); ++i) {
    EXPECT_EQ(forwards->obstacles[i].iri, backwards->obstacles[i].iri);
  }
}

TEST(HallLayout, NeedsExactlyOneHall) {
  EXPECT_THAT(ErrorOf(LayoutQuads()), HasSubstr("no docent:Hall"));
  LayoutQuads two = LayoutQuads::SmallHall();
  two.Thing("Other", "Hall", "POLYGON((0 0, 1 0, 1 1, 0 0))");
  EXPECT_THAT(ErrorOf(two), HasSubstr("more than one docent:Hall"));
}

TEST(HallLayout, TellsAllMistakesAtOnceAndNamesEachResource) {
  LayoutQuads quads = LayoutQuads::SmallHall();
  quads.Thing("Open", "Wall", "POLYGON((0 0, 1 0, 1 1, 0 1))");
  quads.Thing("NoRadius", "Pillar", "POINT(1 1)");
  quads.Thing("Flat", "Counter", "POLYGON((0 0, 1 0, 1 1, 0 0))").Number("Flat", "height", "0");
  quads.Add(Term::Iri(LayoutQuads::Iri("Nowhere")), std::string(kRdfType), Term::Iri(DocentIri("Region")));
  quads.Thing("Blind", "Booth", "POLYGON((0 0, 1 0, 1 1, 0 0))").ServicePoint("Blind", "POINT(.5 .2)", "");
  quads.Thing("InWall", "Booth", "POLYGON((0 0, 1 0, 1 1, 0 0))")
      .ServicePoint("InWall", "POINT(4.05 1)", "0");
  quads.Thing("Outside", "Booth", "POLYGON((0 0, 1 0, 1 1, 0 0))")
      .ServicePoint("Outside", "POINT(-1 1)", "0");
  const std::string error = ErrorOf(quads);
  for (const char* expected :
       {"#Open: well-known text: the polygon does not close", "#NoRadius: a pillar without docent:radius",
        "#Flat: docent:height is not a number above 0", "#Nowhere: no geometry",
        "#Blind: docent:servicePoint has no docent:heading",
        "#InWall: docent:servicePoint lies inside https://example.org/hall#Partition",
        "#Outside: docent:servicePoint lies outside the hall"}) {
    EXPECT_THAT(error, HasSubstr(expected));
  }
}

TEST(HallLayout, RefusesTwoGeometriesOrTwoHeights) {
  LayoutQuads quads = LayoutQuads::SmallHall();
  quads.Thing("Desk", "Counter", "POLYGON((1 1, 2 1, 2 2, 1 1))").Number("P1", "radius", "0.4");
  EXPECT_THAT(ErrorOf(quads), HasSubstr("#Desk: more than one geometry"));
  EXPECT_THAT(ErrorOf(quads), HasSubstr("#P1: more than one docent:radius: 0.3 and 0.4"));
}

TEST(HallLayout, FileErrorsNameTheFile) {
  EXPECT_EQ(HallLayout::FromFile("/nonexistent/hall.ttl").status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(HallLayout::FromFile("hall.txt").status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace docent::maps
