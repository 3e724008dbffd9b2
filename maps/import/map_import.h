// Import of the maps of other systems as a hall layout: an occupancy map of ROS (map_server), with a topological map if there
// is one, or a building of Open-RMF. The result is what maps/hall_layout.h reads, so a robot's map, the simulator's walls
// and the regions are made of it as of any other hall. Reads files; any thread.
#ifndef DOCENT_MAPS_IMPORT_MAP_IMPORT_H_
#define DOCENT_MAPS_IMPORT_MAP_IMPORT_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace docent::maps {

struct MapImportOptions {
  std::string name_space;  // of the places' IRIs; ends in # or /
  std::string name;        // of the hall; empty: the building's, or the file's
  std::string level;       // of a building; empty: its only one
  double height_m = 2.5;   // of the hall and its walls, above 0
};

struct ImportedHall {
  std::string turtle;
  std::string warnings;  // rendered, for people; may be empty
  size_t corners = 0;    // of the outline
  size_t walls = 0;      // and obstacles, within it
  size_t places = 0;
  size_t connections = 0;
  double width_m = 0;
  double depth_m = 0;
};

// `files` in any order; what each is is seen from its content. INVALID_ARGUMENT: files that do not go together, or what is
// wrong in one, with its place. NOT_FOUND: a file that cannot be read.
absl::StatusOr<ImportedHall> ImportMaps(const std::vector<std::string>& files,
                                        const MapImportOptions& options);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_IMPORT_MAP_IMPORT_H_
