// The shape of a floor in an occupancy map: the outline of its free space, and what stands in it. Pure; any thread.
//
// Free space is the largest area of free cells that hang together by their sides. Its outer border is the hall's outline:
// what lies beyond is a wall or unknown, and no robot drives there. Each border inside is the outline of one obstacle.
// Where two free cells touch by a corner only, one is given up, so that every border is a simple polygon. Borders are
// simplified by at most one cell (Douglas, Peucker: Algorithms for the reduction of the number of points, 1973).
#ifndef DOCENT_MAPS_IMPORT_FLOOR_SHAPE_H_
#define DOCENT_MAPS_IMPORT_FLOOR_SHAPE_H_

#include "absl/status/statusor.h"
#include "maps/import/imported_floor.h"
#include "maps/import/occupancy_map.h"

namespace docent::maps {

// Outline and obstacles, in the map frame (OccupancyGrid::origin). INVALID_ARGUMENT: no cell is free.
absl::StatusOr<ImportedFloor> ShapeOf(const OccupancyGrid& grid);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_IMPORT_FLOOR_SHAPE_H_
