#include "maps/wkt.h"

#include <gtest/gtest.h>

namespace docent::maps {
namespace {

std::string PolygonError(const char* text) {
  const absl::StatusOr<Polygon> polygon = ReadWktPolygon(text);
  return polygon.ok() ? "no error" : std::string(polygon.status().message());
}

TEST(Wkt, ReadsPoint) {
  EXPECT_EQ(*ReadWktPoint("POINT(1 2)"), (Point2{1, 2}));
  EXPECT_EQ(*ReadWktPoint("  point ( -1.5e1\t+0.25 ) "), (Point2{-15, 0.25}));
  EXPECT_EQ(*ReadWktPoint("<http://www.opengis.net/def/crs/OGC/1.3/CRS84> POINT(3 4)"), (Point2{3, 4}));
}

TEST(Wkt, RefusesBadPointAndSaysWhere) {
  for (const char* text :
       {"", "POINT", "POINT()", "POINT(1)", "POINT(1 2", "POINT(1 2 3)", "POINT(nan 2)", "POINT(1 inf)",
        "POINT(1 2) x", "POLYGON((0 0, 1 0, 1 1, 0 0))", "<http://unclosed POINT(1 2)"}) {
    EXPECT_EQ(ReadWktPoint(text).status().code(), absl::StatusCode::kInvalidArgument) << text;
  }
  EXPECT_EQ(ReadWktPoint("POINT(1 x)").status().message(),
            "well-known text: expected a finite number at character 9, found 'x)'");
}

TEST(Wkt, ReadsPolygonWithoutItsRepeatedCorner) {
  const absl::StatusOr<Polygon> polygon = ReadWktPolygon("POLYGON ((0 0, 2 0,2 1 ,0 1, 0 0))");
  ASSERT_TRUE(polygon.ok()) << polygon.status();
  EXPECT_EQ(*polygon, (Polygon{{0, 0}, {2, 0}, {2, 1}, {0, 1}}));
  EXPECT_DOUBLE_EQ(Area(*polygon), 2);
}

TEST(Wkt, RefusesPolygonsWithoutMeaning) {
  EXPECT_NE(PolygonError("POLYGON((0 0, 1 0, 0 0))").find("three corners"), std::string::npos);
  EXPECT_NE(PolygonError("POLYGON((0 0, 1 0, 1 1, 0 1))").find("does not close"), std::string::npos);
  EXPECT_NE(PolygonError("POLYGON((0 0, 1 1, 1 0, 0 1, 0 0))").find("cross"), std::string::npos);
  EXPECT_NE(PolygonError("POLYGON((0 0, 1 0, 2 0, 0 0))").find("no area"), std::string::npos);
  EXPECT_NE(PolygonError("POLYGON((0 0, 3 0, 3 3, 0 0), (1 .5, 2 .5, 2 1, 1 .5))").find("hole"),
            std::string::npos);
}

}  // namespace
}  // namespace docent::maps
