// An occupancy map as ROS's map_server keeps it: a YAML description and a grey image. Pure; any thread.
//
//   image: floor.pgm
//   resolution: 0.05            metres a pixel
//   origin: [-12.8, -36.2, 0]   pose of the image's lower left corner in the map frame: metres and radians
//   negate: 0                   1: white is occupied
//   occupied_thresh: 0.65
//   free_thresh: 0.196
//   mode: trinary               or scale, raw
#ifndef DOCENT_MAPS_IMPORT_OCCUPANCY_MAP_H_
#define DOCENT_MAPS_IMPORT_OCCUPANCY_MAP_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maps/geometry.h"
#include "maps/import/pgm_image.h"
#include "maps/import/yaml_document.h"

namespace docent::maps {

struct MapDescription {
  enum class Mode { kTrinary, kScale, kRaw };
  std::string image;  // path of the image, relative to the description's folder
  SourceSpan image_place;
  double resolution_m = 0;
  Pose2 origin;
  bool negate = false;
  double occupied_threshold = 0.65;
  double free_threshold = 0.196;  // ROS 1; what is unknown is drawn as 205, which is 0.1961
  Mode mode = Mode::kTrinary;
};

enum class MapCell : uint8_t { kUnknown, kFree, kOccupied };

// Cell (i, j) is column i from the left and row j from the *bottom*; index j * width + i.
struct OccupancyGrid {
  int width = 0;
  int height = 0;
  double resolution_m = 0;
  Pose2 origin;  // of the lower left corner of cell (0, 0)
  std::vector<MapCell> cells;

  MapCell At(int i, int j) const {
    if (i < 0 || j < 0 || i >= width || j >= height) return MapCell::kUnknown;
    return cells[static_cast<size_t>(j) * width + i];
  }
};

// nullopt: what is wrong stands in `diagnostics`.
std::optional<MapDescription> ReadMapDescription(const YamlValue& document, const std::string& file,
                                                 Diagnostics* diagnostics);

// Darkness p of a pixel in trinary and scale mode: (255 - v) / 255, or v / 255 with negate. Above the occupied threshold it
// is occupied, below the free threshold free, else unknown; of scale mode's values between the two nothing is driven on.
// In raw mode, v is the occupancy in percent, and what is above 100 unknown.
OccupancyGrid GridOf(const MapDescription& description, const GreyImage& image);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_IMPORT_OCCUPANCY_MAP_H_
