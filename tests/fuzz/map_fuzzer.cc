// Any bytes as the parts of a map of another system. The first byte says as which: a PGM image, the description of a map with
// its cells, a topological map, or a building. What is taken gives a hall that robots can read.
#include <cstddef>
#include <cstdint>

#include "graph/rdf/formats/parser.h"
#include "maps/hall_layout.h"
#include "maps/import/building_map.h"
#include "maps/import/floor_shape.h"
#include "maps/import/hall_writer.h"
#include "maps/import/occupancy_map.h"
#include "maps/import/topological_map.h"
#include "tests/fuzz/fuzz_check.h"

namespace docent {
namespace {

void RequireHall(const maps::ImportedFloor& floor) {
  const maps::HallText written = maps::WriteHall(floor, "https://example.org/f#", 2.5, "from a fuzzer");
  const ParsedRdf parsed = ParseRdf(written.turtle, RdfFormat::kTurtle, {"hall.ttl", "urn:base:", ""});
  fuzz::Require(parsed.ok(), "a hall that is no Turtle:\n" + written.turtle);
}

void Image(std::string_view bytes) {
  MapLimits limits;
  limits.map_image_pixels = 1 << 16;
  const absl::StatusOr<maps::GreyImage> image = maps::ReadPgm(bytes, limits);
  if (!image.ok()) {
    fuzz::Require(!image.status().message().empty(), "refused without a word");
    return;
  }
  fuzz::Require(image->pixels.size() == static_cast<size_t>(image->width) * image->height,
                "pixels are missing");
  maps::MapDescription description;
  description.resolution_m = 0.1;
  absl::StatusOr<maps::ImportedFloor> floor = maps::ShapeOf(maps::GridOf(description, *image));
  if (!floor.ok()) return;
  floor->name = "floor";
  const maps::HallText written = maps::WriteHall(*floor, "https://example.org/f#", 2.5, "");
  const ParsedRdf parsed = ParseRdf(written.turtle, RdfFormat::kTurtle, {"hall.ttl", "urn:base:", ""});
  fuzz::Require(parsed.ok(), "a hall that is no Turtle");
  const auto layout = maps::HallLayout::FromQuads(parsed.quads);
  fuzz::Require(layout.ok(), "a hall that is refused: " + std::string(layout.status().message()));
}

void Yaml(std::string_view text, uint8_t kind) {
  MapLimits limits;
  limits.map_yaml_values = 20000;
  Diagnostics diagnostics;
  const auto document = maps::ParseYaml(text, "f", &diagnostics, limits);
  fuzz::Require(document.has_value() == diagnostics.empty(), "a document without a word, or with one");
  maps::ImportedFloor floor;
  floor.outline = {{0, 0}, {1, 0}, {1, 1}};
  bool good = false;
  if (document && kind == 1) {
    good = maps::ReadMapDescription(*document, "f", &diagnostics).has_value();
  } else if (document && kind == 2) {
    good = maps::ReadTopologicalMap(*document, "f", &floor, &diagnostics, limits);
  } else if (document) {
    good = maps::ReadBuilding(*document, "f", "", &floor, &diagnostics, limits);
  }
  fuzz::Require(good != HasErrors(diagnostics), "taken with a mistake, or refused without one");
  fuzz::RequireSound(diagnostics, text);
  for (const maps::ImportedConnection& connection : floor.connections) {
    fuzz::Require(connection.from < floor.places.size() && connection.to < floor.places.size(),
                  "a connection to nowhere");
  }
  if (good && kind != 1) RequireHall(floor);
}

}  // namespace
}  // namespace docent

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 4 == 0) {
    docent::Image(rest);
  } else {
    docent::Yaml(rest, data[0] % 4);
  }
  return 0;
}
