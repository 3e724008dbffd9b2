// A building of Open-RMF's traffic editor (NAME.building.yaml): levels with vertices, walls and lanes between vertices.
// Pure; any thread.
//
//   levels:
//     L1:
//       vertices: [ [x, y, z, name, {…}], … ]        pixels of the level's drawing, y down; or metres
//       measurements: [ [i, j, {distance: [3, 9.3]}], … ]     metres between two vertices: the scale
//       walls: [ [i, j, {…}], … ]
//       lanes: [ [i, j, {bidirectional: [4, true]}], … ]
#ifndef DOCENT_MAPS_IMPORT_BUILDING_MAP_H_
#define DOCENT_MAPS_IMPORT_BUILDING_MAP_H_

#include <string>

#include "maps/import/imported_floor.h"
#include "maps/import/yaml_document.h"

namespace docent::maps {

// Reads one level; an empty `level` is the only one. Coordinates become metres with y up. Named vertices become places with a
// zone, other ends of lanes points on the way. The outline is a rectangle around all of it. False: what is wrong stands in
// `diagnostics`.
bool ReadBuilding(const YamlValue& document, const std::string& file, const std::string& level,
                  ImportedFloor* floor, Diagnostics* diagnostics, const MapLimits& limits = kMapLimits);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_IMPORT_BUILDING_MAP_H_
