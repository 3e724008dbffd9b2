// Whole imports, from files to a hall that robots can read.
#include "maps/import/map_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "graph/rdf/formats/parser.h"
#include "maps/hall_model.h"
#include "maps/import/occupancy_map.h"

namespace docent::maps {
namespace {

using testing::HasSubstr;

constexpr char kNs[] = "https://example.org/home#";

class MapImportTest : public testing::Test {
 protected:
  MapImportTest()
      : folder_(testing::TempDir() + "map_import_" +
                testing::UnitTest::GetInstance()->current_test_info()->name()) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    options_.name_space = kNs;
  }

  std::string File(const std::string& name, const std::string& text) {
    std::ofstream(folder_ + "/" + name, std::ios::binary) << text;
    return folder_ + "/" + name;
  }

  // A room of 10 m x 6 m with a pillar, at 0.1 m a pixel; 205 is unknown.
  std::string Room() {
    std::string image = "P5\n# a room\n104 64\n255\n";
    for (int row = 0; row < 64; ++row) {
      for (int x = 0; x < 104; ++x) {
        const bool outside = row == 0 || row == 63 || x == 0 || x == 103;
        const bool wall = row == 1 || row == 62 || x == 1 || x == 102;
        const bool pillar = row > 28 && row < 34 && x > 48 && x < 54;
        image += static_cast<char>(outside ? 205 : wall || pillar ? 0 : 254);
      }
    }
    File("room.pgm", image);
    return File("room.yaml", kRoom);
  }

  std::string Fault(const std::vector<std::string>& files) {
    const auto hall = ImportMaps(files, options_);
    EXPECT_FALSE(hall.ok());
    return std::string(hall.status().message());
  }
  // Of the description of the room, with a change.
  std::string FaultOf(const std::string& from, const std::string& to) {
    Room();
    std::string text = kRoom;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return Fault({File("bad.yaml", text.replace(at, from.size(), to))});
  }

  static HallLayout Layout(const std::string& turtle) {
    const ParsedRdf parsed = ParseRdf(turtle, RdfFormat::kTurtle, {"hall.ttl", "urn:base:", ""});
    EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, turtle);
    auto layout = HallLayout::FromQuads(parsed.quads);
    EXPECT_TRUE(layout.ok()) << layout.status();
    return layout.ok() ? *layout : HallLayout();
  }

  static constexpr char kRoom[] =
      "image: room.pgm\nresolution: 0.1\norigin: [-1.0, -2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
      "free_thresh: 0.196\nmode: trinary\n";
  const std::string folder_;
  MapImportOptions options_;
};

constexpr char kNodes[] =
    "- node:\n    name: Desk\n    pose: {position: {x: 1.0, y: 1.0}}\n    edges: [{node: Door (west)}]\n"
    "- node:\n    name: Door (west)\n    pose: {position: {x: 6.0, y: 1.0}}\n    edges: [{node: Desk}]\n"
    "- node:\n    name: Pillar\n    pose: {position: {x: 4.1, y: 1.1}}\n    edges: []\n";

TEST_F(MapImportTest, AMapWithPlacesBecomesAHallThatRobotsRead) {
  options_.name = "The \"blue\" room";
  const auto hall = ImportMaps({File("nodes.yaml", kNodes), Room()}, options_);
  ASSERT_TRUE(hall.ok()) << hall.status();
  EXPECT_EQ(hall->walls, 1u);
  EXPECT_EQ(hall->places, 3u);
  EXPECT_EQ(hall->connections, 2u);
  EXPECT_THAT(hall->warnings, HasSubstr("nodes.yaml:10:11: warning: place Pillar lies in a wall"));
  const HallLayout layout = Layout(hall->turtle);
  EXPECT_EQ(layout.name, "The \"blue\" room");
  EXPECT_EQ(hall->corners, layout.outline.size());
  EXPECT_NEAR(Area(layout.outline), 10 * 6, 0.01);
  const Bounds bounds = BoundsOf(layout.outline);
  EXPECT_NEAR(bounds.min_x_m, -0.8, 1e-9);
  EXPECT_NEAR(bounds.min_y_m, -1.8, 1e-9);
  ASSERT_NE(layout.FindRegion(std::string(kNs) + "Desk"), nullptr);
  EXPECT_TRUE(layout.FindRegion(std::string(kNs) + "Desk")->service_point.has_value());
  EXPECT_FALSE(layout.FindRegion(std::string(kNs) + "Pillar")->service_point.has_value());
  ASSERT_NE(layout.FindRegion(std::string(kNs) + "Door%20(west)"), nullptr) << hall->turtle;
  EXPECT_THAT(hall->turtle, HasSubstr("docent:fromPlace place:Desk"));
  EXPECT_THAT(hall->turtle, HasSubstr("docent:length 5.0"));

  // The map of the imported hall is the map that was imported.
  const auto model = HallModel::FromLayout(layout, 0.1);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_GT((*model)->DistanceAt(1, 1), 0.5);
  EXPECT_LE((*model)->DistanceAt(4.1, 1.1), 0);
  EXPECT_LE((*model)->DistanceAt(-1, 1), 0);
}

TEST_F(MapImportTest, NegateModesAndYaw) {
  Diagnostics diagnostics;
  MapDescription description;
  description.resolution_m = 1;
  const GreyImage image = {4, 1, {0, 100, 205, 255}};
  const auto cells = [&] {
    std::string out;
    for (const MapCell cell : GridOf(description, image).cells)
      out += cell == MapCell::kFree ? '.' : cell == MapCell::kOccupied ? '#' : '?';
    return out;
  };
  EXPECT_EQ(cells(), "#??.");
  description.mode = MapDescription::Mode::kScale;
  EXPECT_EQ(cells(), "#??.");
  description.negate = true;
  EXPECT_EQ(cells(), ".?##");
  description.mode = MapDescription::Mode::kRaw;
  EXPECT_EQ(cells(), ".#??") << "raw is percent, whatever negate says";
  description = {};
  description.free_threshold = 0.25;
  EXPECT_EQ(cells(), "#?..") << "0.1961 is below 0.25";
}

TEST_F(MapImportTest, WhatIsWrongIsSaidWithItsPlace) {
  EXPECT_THAT(FaultOf("room.pgm", "none.pgm"), HasSubstr("bad.yaml:1:8: error: cannot read "));
  EXPECT_THAT(FaultOf("room.pgm", "room.yaml"), HasSubstr("not a PGM image"));
  EXPECT_THAT(FaultOf("resolution: 0.1", "resolution: 0"),
              HasSubstr("bad.yaml:2:13: error: resolution 0 is not above 0"));
  EXPECT_THAT(FaultOf("resolution: 0.1", "resolution: -1"), HasSubstr("resolution -1 is not above 0"));
  EXPECT_THAT(FaultOf("-1.0, -2.0", ".nan, -2.0"),
              HasSubstr("bad.yaml:3:10: error: a number of origin is not a finite number: .nan"));
  EXPECT_THAT(FaultOf("-1.0, -2.0", "nan, -2.0"), HasSubstr("not a finite number"));
  EXPECT_THAT(FaultOf("-1.0, -2.0, 0.0", "-1.0, -2.0"), HasSubstr("origin is not a list of three numbers"));
  EXPECT_THAT(FaultOf("negate: 0", "negate: 2"), HasSubstr("negate is neither 0 nor 1: 2"));
  EXPECT_THAT(FaultOf("0.65", "1.65"), HasSubstr("occupied_thresh 1.65 is not within 0 and 1"));
  EXPECT_THAT(FaultOf("free_thresh: 0.196", "free_thresh: 0.9"),
              HasSubstr("bad.yaml:6:14: error: free_thresh 0.9 is not below occupied_thresh 0.65"));
  EXPECT_THAT(FaultOf("trinary", "ternary"), HasSubstr("mode is unknown: ternary"));
  EXPECT_THAT(FaultOf("image: room.pgm\n", ""), HasSubstr("the key image is missing"));
  EXPECT_THAT(FaultOf("negate: 0", "negate: 1\nnegate: 0"), HasSubstr("the key negate stands twice"));
  EXPECT_THAT(FaultOf("negate: 0", "\tnegate: 0"), HasSubstr("bad.yaml:4"));
  ASSERT_EQ(mkfifo((folder_ + "/pipe.pgm").c_str(), 0600), 0);  // reading it would wait for a writer
  EXPECT_THAT(FaultOf("room.pgm", "pipe.pgm"), HasSubstr("pipe.pgm is not a file"));
  File("bomb.pgm", "P5 1000000000 1000000000 255\n");
  EXPECT_THAT(FaultOf("room.pgm", "bomb.pgm"), HasSubstr("the limit map_image_pixels"));
  File("black.pgm", std::string("P5 2 2 255\n") + std::string(4, '\0'));
  EXPECT_THAT(FaultOf("room.pgm", "black.pgm"), HasSubstr("no cell of the image is free"));
}

TEST_F(MapImportTest, FilesThatDoNotGoTogetherAreRefused) {
  const std::string room = Room(), nodes = File("nodes.yaml", kNodes);
  const std::string building = File(
      "b.building.yaml", "levels: {L1: {vertices: [[0, 0, 0, a], [9, 9, 0, b]], lanes: [[0, 1, {}]]}}\n");
  EXPECT_THAT(Fault({nodes}), HasSubstr("an import needs the description of a map"));
  EXPECT_THAT(Fault({room, building}), HasSubstr("a building alone"));
  EXPECT_THAT(Fault({room, room}), HasSubstr("of the same kind"));
  EXPECT_THAT(Fault({File("x.yaml", "a: 1\n")}), HasSubstr("is neither the description of a map"));
  EXPECT_THAT(Fault({folder_ + "/none.yaml"}), HasSubstr("cannot read"));
  const auto hall = ImportMaps({building}, options_);
  ASSERT_TRUE(hall.ok()) << hall.status();
  EXPECT_EQ(hall->places, 2u);
}

// Lanes are read behind vertices of which hundreds have the same name, too.
TEST_F(MapImportTest, ManyWarningsHideNoMistake) {
  std::string vertices;
  for (int i = 0; i < 300; ++i) absl::StrAppend(&vertices, i == 0 ? "" : ", ", "[", i, ", 0, 0, a]");
  const std::string building =
      File("b.building.yaml", "levels: {L1: {vertices: [" + vertices + "], lanes: [[0, 5000, {}]]}}\n");
  EXPECT_THAT(Fault({building}), HasSubstr("5000"));
}

}  // namespace
}  // namespace docent::maps
