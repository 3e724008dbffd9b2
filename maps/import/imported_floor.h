// What is imported of a floor, whatever the format: its outline, what stands on it, places and the connections between
// them. Values; any thread.
#ifndef DOCENT_MAPS_IMPORT_IMPORTED_FLOOR_H_
#define DOCENT_MAPS_IMPORT_IMPORTED_FLOOR_H_

#include <optional>
#include <string>
#include <vector>

#include "graph/base/diagnostic.h"
#include "maps/geometry.h"

namespace docent::maps {

struct ImportedPlace {
  std::string name;
  Polygon outline;  // of a region; empty: a point on the way that has no meaning of its own
  Pose2 pose;       // where a robot stands
  SourceSpan span;
};

// A robot can drive straight from one place to the other.
struct ImportedConnection {
  size_t from = 0;  // in ImportedFloor::places
  size_t to = 0;
  double length_m = 0;
};

struct ImportedObstacle {
  Polygon outline;
  bool is_wall = false;  // false: what is behind it is not known
};

struct ImportedFloor {
  std::string name;
  Polygon outline;
  std::vector<ImportedObstacle> obstacles;
  std::vector<ImportedPlace> places;
  std::vector<ImportedConnection> connections;
};

}  // namespace docent::maps

#endif  // DOCENT_MAPS_IMPORT_IMPORTED_FLOOR_H_
