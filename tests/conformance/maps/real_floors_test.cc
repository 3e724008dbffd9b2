// Floors of real buildings become halls that robots can read. They are not a part of this tree: DOCENT_DATA names the folder
// that has them (buildings/aaf and so on).
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "graph/rdf/formats/parser.h"
#include "maps/hall_model.h"
#include "maps/import/map_import.h"

namespace docent::maps {
namespace {

TEST(RealFloorsTest, BecomeHalls) {
  MapImportOptions options;
  options.name_space = "https://example.org/home#";
  const char* data = std::getenv("DOCENT_DATA");
  const std::string root =
      std::string(data != nullptr ? data : DOCENT_SOURCE_DIR "/../shared/data") + "/buildings";
  if (!std::filesystem::exists(root + "/aaf/aaf_HAN_y4.yaml"))
    GTEST_SKIP() << "there are no floors of real buildings; DOCENT_DATA names the folder that has them";
  struct Floor {
    std::vector<std::string> files;
    std::string level;
    size_t least_places;
  };
  for (const Floor& floor :
       {Floor{{"/aaf/y4_aaf-cropped.yaml", "/aaf/aaf_HAN_y4.yaml"}, "", 50},
        Floor{{"/nav2/depot.yaml"}, "", 0}, Floor{{"/nav2/warehouse.yaml"}, "", 0},
        Floor{{"/pal/hospital/map.yaml"}, "", 0}, Floor{{"/pal/pal_office/map.yaml"}, "", 0},
        Floor{{"/rmf/office.building.yaml"}, "", 5}, Floor{{"/rmf/hotel.building.yaml"}, "L1", 5},
        Floor{{"/rmf/airport_terminal.building.yaml"}, "L1", 5}}) {
    std::vector<std::string> files;
    for (const std::string& file : floor.files) files.push_back(root + file);
    options.level = floor.level;
    const auto hall = ImportMaps(files, options);
    ASSERT_TRUE(hall.ok()) << files[0] << "\n" << hall.status();
    EXPECT_GE(hall->places, floor.least_places) << files[0];
    EXPECT_LT(hall->walls, 20000u) << files[0];
    EXPECT_GT(hall->width_m, 5) << files[0];
    const ParsedRdf parsed = ParseRdf(hall->turtle, RdfFormat::kTurtle, {"hall.ttl", "urn:base:", ""});
    ASSERT_TRUE(parsed.ok()) << files[0];
    const auto layout = HallLayout::FromQuads(parsed.quads);
    ASSERT_TRUE(layout.ok()) << files[0] << "\n" << layout.status();
    const auto model = HallModel::FromLayout(*layout, 0.2);
    ASSERT_TRUE(model.ok()) << files[0] << "\n" << model.status();
  }
}

}  // namespace
}  // namespace docent::maps
