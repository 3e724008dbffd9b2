#include "maps/roadmap.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "graph/base/workflow_limits.h"
#include "gtest/gtest.h"

namespace docent::maps {
namespace {

// -1: no ways lead there.
double Length(const std::string& text, const Point2& from, const Point2& to) {
  absl::StatusOr<Roadmap> roadmap = Roadmap::Read(text);
  EXPECT_TRUE(roadmap.ok()) << roadmap.status();
  if (!roadmap.ok()) return -2;
  const absl::StatusOr<double> length = roadmap->RouteLength(from, to);
  if (length.ok()) return *length;
  EXPECT_EQ(length.status().code(), absl::StatusCode::kNotFound);
  return -1;
}
std::string BothWays(const std::string& a, const std::string& b, const std::string& length = "") {
  return absl::StrCat(a, " ", b, " ", length, ";", b, " ", a, " ", length, ";");
}

// A corridor along y = 0, with a dead end at x = 10.
std::string Corridor() {
  return BothWays("0 0", "10 0") + BothWays("10 0", "20 0") + BothWays("10 0", "10 5");
}

TEST(RoadmapTest, ARouteFollowsTheWays) {
  EXPECT_NEAR(Length(Corridor(), {0, 0}, {10, 5}), 15, 1e-9);
  EXPECT_NEAR(Length(Corridor(), {2, 1}, {11, 4}), 1 + 8 + 4 + 1, 1e-9)
      << "from beside a way to beside another";
  EXPECT_NEAR(Length(Corridor(), {3, 0}, {7, 0}), 4, 1e-9) << "on one way";
  EXPECT_NEAR(Length(Corridor(), {7, 0}, {3, 0}), 4, 1e-9) << "and back";
}

TEST(RoadmapTest, TheShortestOfSeveralRoutesCounts) {
  const std::string round = BothWays("0 0", "0 10") + BothWays("0 10", "10 10") + BothWays("10 10", "10 0");
  EXPECT_NEAR(Length(round + BothWays("0 0", "10 0", "31"), {0, 0}, {10, 0}), 30, 1e-9);
  EXPECT_NEAR(Length(round + BothWays("0 0", "10 0", "12"), {0, 0}, {10, 0}), 12, 1e-9);
  EXPECT_NEAR(Length(round + BothWays("0 0", "10 0", "12") + BothWays("0 0", "10 0", "11"), {0, 0}, {10, 0}),
              11, 1e-9);
}

TEST(RoadmapTest, AWayLeadsInItsDirectionOnly) {
  const std::string one_way = "0 0 10 0; 10 0 10 10; 10 10 0 10; 0 10 0 0";
  EXPECT_NEAR(Length(one_way, {0, 0}, {10, 0}), 10, 1e-9);
  EXPECT_NEAR(Length(one_way, {10, 0}, {0, 0}), 30, 1e-9);
  EXPECT_NEAR(Length(one_way, {4, 0}, {2, 0}), 38, 1e-9) << "once around";
  EXPECT_EQ(Length("0 0 10 0", {10, 0}, {0, 0}), -1);
  EXPECT_NEAR(Length("0 0 10 0; 20 0 10 0", {20, 0}, {10, 0}), 10, 1e-9) << "to the end of two ways";
  EXPECT_NEAR(Length("0 0 10 0; 10 0 20 0", {10, 0}, {20, 0}), 10, 1e-9) << "from it";
}

TEST(RoadmapTest, PointsThatAreNearerToEachOtherThanToTheWaysAreInOneRoom) {
  EXPECT_NEAR(Length(Corridor(), {2, 3}, {4, 3}), 2, 1e-9);
  EXPECT_NEAR(Length(Corridor(), {0, 0.1}, {9.9, 5}), 0.1 + 10 + 5 + 0.1, 1e-9);
}

TEST(RoadmapTest, WithoutWaysTheStraightLineCounts) {
  EXPECT_NEAR(Length("", {0, 0}, {3, 4}), 5, 1e-9);
  EXPECT_NEAR(Length("1 1 1 1", {0, 0}, {3, 4}), 5, 1e-9) << "a way to itself is none";
}

TEST(RoadmapTest, WhereNoWaysLeadThereIsNoLength) {
  EXPECT_EQ(Length("0 0 10 0; 10 0 0 0; 0 50 10 50; 10 50 0 50", {0, 1}, {0, 49}), -1);
}

TEST(RoadmapTest, TheOrderOfWaysDoesNotMatter) {
  EXPECT_EQ(Length("0 0 10 0; 10 0 20 0; 20 0 20 7.5", {1, 1}, {19, 7}),
            Length("20 0 20 7.5 ; 10 0 20 0;;0 0 10 0; 0 0 10 0", {1, 1}, {19, 7}));
}

TEST(RoadmapTest, PointsMayBeWkt) {
  EXPECT_NEAR(Length("POINT(0 0) 10 0; POINT (10 0) POINT(10 5) 7.5", {0, 0}, {10, 5}), 17.5, 1e-9);
  EXPECT_EQ(*ReadPoint("POINT(1.5 -2)"), (Point2{1.5, -2}));
  EXPECT_EQ(*ReadPoint(" 1.5 -2 "), (Point2{1.5, -2}));
  for (const char* text : {"", "1", "1 2 3", "POINT()", "LINE(1 2)", "1 inf"})
    EXPECT_FALSE(ReadPoint(text).ok()) << text;
}

TEST(RoadmapTest, PointsThatAreTheSameToTheMillimetreAreOnePlace) {
  EXPECT_NEAR(Length("0 0 10 0; 10.0001 0 20 0", {0, 0}, {20, 0}), 20, 1e-3);
}

TEST(RoadmapTest, WhatIsNoWayIsRefused) {
  for (const char* text :
       {"0 0 10", "0 0 10 0 1 1", "0 0 ten 0", "0 0 nan 0", "0 0 1e300 0", "0 0 10 0 -1"}) {
    const absl::StatusOr<Roadmap> roadmap = Roadmap::Read(absl::StrCat("0 0 5 0; ", text));
    EXPECT_EQ(roadmap.status().code(), absl::StatusCode::kInvalidArgument) << text;
  }
}

TEST(RoadmapTest, OneWayMoreThanTheLimitIsRefused) {
  const size_t most = kWorkflowLimits.roadmap_ways;
  std::string text;
  for (size_t i = 0; i < most; ++i) absl::StrAppend(&text, i, " 0 ", i + 1, " 0;");
  EXPECT_NEAR(Length(text, {0, 0}, {static_cast<double>(most), 0}), static_cast<double>(most), 1e-6);
  absl::StrAppend(&text, "0 0 0 5");
  EXPECT_EQ(Roadmap::Read(text).status().code(), absl::StatusCode::kResourceExhausted);
}

}  // namespace
}  // namespace docent::maps
