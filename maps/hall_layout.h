// The hall layout as read from RDF: the only source for the places of walls and booths. The OctoMap, the
// distance fields and the simulator's walls are made from it; the regions in the graph are the same quads.
//
// Vocabulary (ontology/place): docent:Hall, docent:Wall, docent:BoothWall, docent:Counter, docent:Pillar,
// docent:Obstacle, docent:Region, docent:Booth, geo:hasGeometry/geo:asWKT, docent:height, docent:radius,
// docent:servicePoint, docent:heading, schema:name, schema:description, docent:exhibitor.
// A value; immutable once read. Any thread.
#ifndef DOCENT_MAPS_HALL_LAYOUT_H_
#define DOCENT_MAPS_HALL_LAYOUT_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/term.h"
#include "maps/geometry.h"

namespace docent::maps {

enum class ObstacleKind { kWall, kBoothWall, kCounter, kPillar, kOther };

// A solid object on the floor: a prism over `outline`, or a cylinder over `disc` (a pillar).
struct Obstacle {
  std::string iri;  // "_:label" for a blank node
  ObstacleKind kind = ObstacleKind::kOther;
  Polygon outline;           // empty for a pillar
  std::optional<Disc> disc;  // pillars only
  double height_m = 0;       // from the floor up
};

// A named place on the floor. Regions may lie inside each other.
struct Region {
  std::string iri;
  std::string name;         // schema:name, or the IRI's last part
  std::string description;  // schema:description; may be empty
  std::string exhibitor;    // the name of a booth's docent:exhibitor; may be empty
  bool is_booth = false;
  Polygon outline;
  std::optional<Pose2> service_point;  // pose of a robot that presents it
};

struct HallLayout {
  std::string iri;
  std::string name;
  Polygon outline;                  // inner face of the hall's outer wall; the space beyond is unknown
  double height_m = 3;              // docent:height of the hall; the default height of obstacles
  std::vector<Obstacle> obstacles;  // by IRI
  std::vector<Region> regions;      // by IRI

  // Reads the layout from `quads`; quads about other things are ignored, and so are graphs. INVALID_ARGUMENT
  // lists every mistake, one a line, each naming its resource: no hall or more than one, a missing or
  // unreadable geometry, a height or radius that is not a number above 0, a service point without a heading
  // or inside an obstacle.
  static absl::StatusOr<HallLayout> FromQuads(const std::vector<TermQuad>& quads);

  // Reads an RDF file (format by its ending). NOT_FOUND, or INVALID_ARGUMENT with the parser's diagnostics.
  static absl::StatusOr<HallLayout> FromFile(const std::string& path);

  const Region* FindRegion(std::string_view region_iri) const;  // nullptr: no such region
};

}  // namespace docent::maps

#endif  // DOCENT_MAPS_HALL_LAYOUT_H_
