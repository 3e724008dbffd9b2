// Well-known text (OGC 06-103r4, section 7): the two forms in layouts,
//   POINT(x y)    and    POLYGON((x y, x y, …, x y))    with one ring that ends at its beginning,
// optionally after a coordinate reference system IRI as GeoSPARQL 1.1 (section 8.5.1) allows: `<iri>
// POINT(…)`.
// Pure functions; any thread.
#ifndef DOCENT_MAPS_WKT_H_
#define DOCENT_MAPS_WKT_H_

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "maps/geometry.h"

namespace docent::maps {

// INVALID_ARGUMENT names the expected text and the character (counted from 1). Numbers must be finite.
absl::StatusOr<Point2> ReadWktPoint(std::string_view text);

// The outer ring without its repeated last corner. INVALID_ARGUMENT also for fewer than three corners, a ring
// that does not close, an inner ring (holes have no meaning for a footprint), two edges that cross, and area
// 0.
absl::StatusOr<Polygon> ReadWktPolygon(std::string_view text);

// True if two edges of the ring cross in a point that is no end of either.
bool CrossesItself(const Polygon& ring);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_WKT_H_
