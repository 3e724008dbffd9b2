// Roadmap: the ways between places that a robot can drive, straight or with a length of their own, and the length of a route along
// them. Immutable, but for what it remembers of goals: one thread each.
//
// A route leaves the point for the nearest point of a way, follows ways in their directions, and leaves them at the point nearest
// to the goal. Two points that are no farther from each other than both together are from the ways count as being in one
// room: their route is the straight line. The same ways give the same lengths, in whatever order they are told.
#ifndef DOCENT_MAPS_ROADMAP_H_
#define DOCENT_MAPS_ROADMAP_H_

#include <cstddef>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "maps/geometry.h"

namespace docent::maps {

// "X Y" or WKT "POINT(X Y)", in metres. INVALID_ARGUMENT: it is neither.
absl::StatusOr<Point2> ReadPoint(std::string_view text);

class Roadmap {
 public:
  // Text: ways, separated by ";", each two points as ReadPoint takes them, from the first to the second, and perhaps a length in
  // metres: "0 0 4 0; POINT(4 0) POINT(4 3) 12.5". Points that are the same to the millimetre are one place. INVALID_ARGUMENT: it
  // is not that, or a length is below 0; RESOURCE_EXHAUSTED: more than the limit roadmap_ways.
  static absl::StatusOr<Roadmap> Read(std::string_view text);

  // Metres. NOT_FOUND: no ways lead from the one point to the other.
  absl::StatusOr<double> RouteLength(const Point2& from, const Point2& to);

 private:
  // Between two places, in one direction or both; infinite: not in this direction.
  struct Way {
    size_t from = 0, to = 0;  // of places_
    double forward_m, backward_m;
  };
  // The point of the ways that is nearest to a given one.
  struct Access {
    double distance_m = 0;
    size_t way = 0;
    double along = 0;  // 0 to 1 of the way
  };

  Access AccessOf(const Point2& point) const;
  // Metres from each place to the access; infinite: no ways lead there.
  const std::vector<double>& LengthsTo(const Access& goal);

  std::vector<Point2> places_;
  std::vector<Way> ways_;
  std::vector<std::vector<size_t>> ways_of_;                             // by place
  std::map<std::pair<size_t, double>, std::vector<double>> lengths_to_;  // by way and `along`
};

}  // namespace docent::maps

#endif  // DOCENT_MAPS_ROADMAP_H_
