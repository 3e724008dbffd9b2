// Limits for the import of maps of other systems. The rules of limits.h hold here. A separate header, because only the
// import includes it.
#ifndef DOCENT_GRAPH_BASE_MAP_LIMITS_H_
#define DOCENT_GRAPH_BASE_MAP_LIMITS_H_

#include <cstddef>

namespace docent {

struct MapLimits {
  size_t map_yaml_bytes = 16u << 20;    // text of a map's description, a topological map or a building
  size_t map_yaml_values = 2000000;     // values in it
  int map_yaml_nesting = 32;            // lists and mappings inside each other
  size_t map_image_pixels = 100000000;  // pixels of a map's image
  size_t map_places = 100000;           // places of one topological map or building
  size_t map_connections = 1000000;     // connections between them
  size_t map_wall_tests = 1000000000;   // walls times places of one import: each place is sought in each wall
};

inline constexpr MapLimits kMapLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_MAP_LIMITS_H_
