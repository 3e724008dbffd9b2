// Places and connections: topological maps and buildings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maps/import/building_map.h"
#include "maps/import/topological_map.h"

namespace docent::maps {
namespace {

using testing::HasSubstr;

struct Read {
  ImportedFloor floor;
  std::string said;
  bool good = false;
};

Read Topology(const std::string& text, MapLimits limits = {}) {
  Read out;
  Diagnostics diagnostics;
  const auto document = ParseYaml(text, "nodes.yaml", &diagnostics);
  out.good = document && ReadTopologicalMap(*document, "nodes.yaml", &out.floor, &diagnostics, limits);
  out.said = Render(diagnostics, text);
  return out;
}

Read Building(const std::string& text, const std::string& level = "", MapLimits limits = {}) {
  Read out;
  Diagnostics diagnostics;
  const auto document = ParseYaml(text, "b.yaml", &diagnostics);
  out.good = document && ReadBuilding(*document, "b.yaml", level, &out.floor, &diagnostics, limits);
  out.said = Render(diagnostics, text);
  return out;
}

constexpr char kTwoNodes[] = R"(- meta: {map: home}
  node:
    name: Kitchen
    pose:
      position: {x: 1.5, y: 2.0, z: 0}
      orientation: {w: 0.7071068, x: 0.0, y: 0.0, z: 0.7071068}
    verts: [{x: 1, y: -1}, {x: 1, y: 1}, {x: -1, y: 1}, {x: -1, y: -1}]
    edges: [{node: Hall 2, edge_id: a}]
- meta: {map: home}
  node:
    name: Hall 2
    pose:
      position: {x: 4.5, y: 6.0}
    edges: []
)";

TEST(TopologicalMapTest, NodesArePlacesAndEdgesConnections) {
  const Read read = Topology(kTwoNodes);
  ASSERT_TRUE(read.good) << read.said;
  ASSERT_EQ(read.floor.places.size(), 2u);
  const ImportedPlace& kitchen = read.floor.places[0];
  EXPECT_EQ(kitchen.name, "Kitchen");
  EXPECT_NEAR(kitchen.pose.heading_rad, 1.5708, 1e-4);
  EXPECT_EQ(Area(kitchen.outline), 4);
  EXPECT_EQ(Centroid(kitchen.outline).x_m, 1.5);
  EXPECT_EQ(read.floor.places[1].outline.size(), 8u) << "a node without a zone has one";
  ASSERT_EQ(read.floor.connections.size(), 1u);
  EXPECT_EQ(read.floor.connections[0].to, 1u);
  EXPECT_EQ(read.floor.connections[0].length_m, 5);
}

TEST(TopologicalMapTest, WhatIsWrongIsSaidWithItsPlace) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kTwoNodes;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return Topology(text.replace(at, from.size(), to)).said;
  };
  EXPECT_THAT(
      with("node: Hall 2", "node: Hall2"),
      HasSubstr("nodes.yaml:8:20: error: an edge of Kitchen leads to the node Hall2, which does not exist"));
  EXPECT_THAT(with("node: Hall 2", "node: Hall2"), HasSubstr("did you mean Hall 2?"));
  EXPECT_THAT(with("name: Hall 2", "name: Kitchen"),
              HasSubstr("nodes.yaml:11:11: error: a second node Kitchen; the first one stands in line 3"));
  EXPECT_THAT(with("x: 4.5", "x: .nan"), HasSubstr("nodes.yaml:13:21: error: x is not a finite number"));
  EXPECT_THAT(with("x: 4.5", "x: 1e9"), HasSubstr("x 1e9 is beyond"));
  EXPECT_THAT(with("    name: Hall 2\n", ""), HasSubstr("the key name is missing"));
  EXPECT_THAT(with("{x: 4.5, y: 6.0}", "{x: 4.5}"), HasSubstr("the key y is missing"));
  EXPECT_THAT(with("name: Kitchen", "name: \"a\\nb\""), HasSubstr("control character"));
  EXPECT_THAT(with("{x: 1, y: 1}", "{x: -2, y: 0.5}"),
              HasSubstr("warning: the zone of the node is no simple polygon"));
  EXPECT_THAT(Topology("a: 1\n").said, HasSubstr("a topological map is a list of nodes"));
  EXPECT_THAT(Topology("- a: 1\n").said, HasSubstr("an entry of the map has no node"));
}

TEST(TopologicalMapTest, AListMayStandBeneathNodes) {
  EXPECT_TRUE(Topology("nodes:\n- node: {name: A, pose: {position: {x: 0, y: 0}}}\n").good);
}

TEST(TopologicalMapTest, LimitsHold) {
  MapLimits limits;
  limits.map_places = 2;
  limits.map_connections = 1;
  EXPECT_TRUE(Topology(kTwoNodes, limits).good);
  limits.map_connections = 0;
  EXPECT_THAT(Topology(kTwoNodes, limits).said, HasSubstr("the limit map_connections is 0"));
  limits.map_places = 1;
  EXPECT_THAT(Topology(kTwoNodes, limits).said, HasSubstr("the limit map_places is 1"));
}

constexpr char kOffice[] = R"(coordinate_system: reference_image
name: office
levels:
  L1:
    measurements:
      - [0, 1, {distance: [3, 5]}]
    vertices:
      - [0, 0, 0, ""]
      - [100, 0, 0, ""]
      - [100, 60, 0, pantry, {is_charger: [4, true]}]
      - [20, 60, 0, lounge]
      - [60, 60, 0, ""]
    walls:
      - [0, 1, {alpha: [3, 1]}]
    lanes:
      - [3, 4, {bidirectional: [4, true], graph_idx: [2, 0]}]
      - [4, 2, {bidirectional: [4, false], graph_idx: [2, 0]}]
)";

TEST(BuildingMapTest, VerticesWallsAndLanesInMetres) {
  const Read read = Building(kOffice);
  ASSERT_TRUE(read.good) << read.said;
  EXPECT_EQ(read.floor.name, "office");
  ASSERT_EQ(read.floor.places.size(), 3u);
  EXPECT_EQ(read.floor.places[0].name, "pantry");
  EXPECT_EQ(read.floor.places[0].pose.x_m, 5);
  EXPECT_EQ(read.floor.places[0].pose.y_m, -3);
  EXPECT_EQ(read.floor.places[2].name, "waypoint4");
  EXPECT_TRUE(read.floor.places[2].outline.empty());
  ASSERT_EQ(read.floor.connections.size(), 3u);
  EXPECT_EQ(read.floor.connections[0].length_m, 2);
  EXPECT_EQ(read.floor.connections[1].to, 1u) << "the way back";
  EXPECT_EQ(read.floor.connections[2].to, 0u) << "one way only";
  ASSERT_EQ(read.floor.obstacles.size(), 1u);
  EXPECT_NEAR(Area(read.floor.obstacles[0].outline), 5.1 * 0.1, 1e-9);
  EXPECT_TRUE(Contains(read.floor.outline, {0, 0}));
}

TEST(BuildingMapTest, WhatIsWrongIsSaidWithItsPlace) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kOffice;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return Building(text.replace(at, from.size(), to)).said;
  };
  EXPECT_THAT(with("[4, 2,", "[4, 9,"),
              HasSubstr("b.yaml:17:13: error: vertex 9 does not exist; there are 5"));
  EXPECT_THAT(with("[4, 2,", "[4, -1,"), HasSubstr("vertex -1 does not exist"));
  EXPECT_THAT(with("[4, 2,", "[4, 1.5,"), HasSubstr("vertex 1.5 does not exist"));
  EXPECT_THAT(
      with("lounge", "pantry"),
      HasSubstr(
          "warning: a second vertex pantry; the first one stands in line 10, this one becomes pantry_3"));
  EXPECT_THAT(with("[20, 60", "[.inf, 60"), HasSubstr("x is not a finite number"));
  EXPECT_THAT(with("reference_image", "wgs84"), HasSubstr("coordinate_system wgs84 is not read"));
  EXPECT_THAT(with("[3, 5]", "[3, 0]"), HasSubstr("a distance above 0"));
  EXPECT_THAT(with("measurements", "measured"),
              HasSubstr("warning: nothing was measured; a pixel is taken as 0.05 m"));
  EXPECT_THAT(with("levels", "floors"), HasSubstr("the building has no levels"));
  EXPECT_THAT(with("    vertices", "    points"), HasSubstr("the key vertices is missing"));
  EXPECT_THAT(Building(kOffice, "L2").said, HasSubstr("the building has no level L2"));
}

TEST(BuildingMapTest, ALevelOfSeveralHasToBeNamed) {
  const std::string two = std::string(kOffice) + "  L2:\n    vertices: [[0, 0, 0, x], [1, 1, 0, y]]\n";
  EXPECT_THAT(Building(two).said, HasSubstr("several levels; which one has to be said"));
  EXPECT_THAT(Building(two).said, HasSubstr("there are: L1, L2"));
  const Read read = Building(two, "L2");
  ASSERT_TRUE(read.good) << read.said;
  EXPECT_EQ(read.floor.name, "office L2");
}

TEST(BuildingMapTest, LimitsHold) {
  MapLimits limits;
  limits.map_places = 5;
  limits.map_connections = 4;
  EXPECT_TRUE(Building(kOffice, "", limits).good);
  limits.map_connections = 2;
  EXPECT_THAT(Building(kOffice, "", limits).said, HasSubstr("the limit map_connections is 2"));
  limits.map_places = 4;
  EXPECT_THAT(Building(kOffice, "", limits).said, HasSubstr("the limit map_places is 4"));
}

}  // namespace
}  // namespace docent::maps
