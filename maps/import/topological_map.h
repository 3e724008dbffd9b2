// A topological map as STRANDS' topological_navigation keeps it (the maps of its tools and of its successors): a list of
// nodes, or a mapping whose key `nodes` has it. Pure; any thread.
//
//   - node:
//       name: Kitchen
//       pose: { position: {x: 1.5, y: 2, z: 0}, orientation: {w: 1, x: 0, y: 0, z: 0} }
//       verts: [ {x: 0.7, y: 0.3}, … ]     the node's zone, relative to its position
//       edges: [ {node: Corridor, edge_id: Kitchen_Corridor}, … ]
#ifndef DOCENT_MAPS_IMPORT_TOPOLOGICAL_MAP_H_
#define DOCENT_MAPS_IMPORT_TOPOLOGICAL_MAP_H_

#include <string>

#include "maps/import/imported_floor.h"
#include "maps/import/yaml_document.h"

namespace docent::maps {

// Adds places and connections to `floor`. False: what is wrong stands in `diagnostics`: a node without a name or a pose, a
// number that is none, two nodes of one name, an edge to a node that does not exist, a limit.
bool ReadTopologicalMap(const YamlValue& document, const std::string& file, ImportedFloor* floor,
                        Diagnostics* diagnostics, const MapLimits& limits = kMapLimits);

// The zone of a place that has none of its own: an octagon.
Polygon ZoneAround(const Point2& p);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_IMPORT_TOPOLOGICAL_MAP_H_
