// Point-in-region lookup: finds the named region that a robot reports as docent:isAt. Immutable; any thread.
#ifndef DOCENT_MAPS_REGIONS_H_
#define DOCENT_MAPS_REGIONS_H_

#include <vector>

#include "maps/hall_layout.h"

namespace docent::maps {

class RegionIndex {
 public:
  explicit RegionIndex(const HallLayout& layout) : RegionIndex(layout.regions) {}
  explicit RegionIndex(std::vector<Region> regions);

  // The smallest region (by area, ties by IRI) that contains `p`; nullptr if there is none. The pointer is
  // valid as long as the index.
  const Region* Innermost(const Point2& p) const;

  // As above, but a point that has left `current` by no more than `margin_m` still counts as inside it, so
  // that a noisy pose on a border does not cause repeated changes. `current` may be nullptr or come from this
  // index.
  const Region* Innermost(const Point2& p, const Region* current, double margin_m) const;

  // Smallest first.
  const std::vector<Region>& regions() const { return regions_; }

 private:
  std::vector<Region> regions_;
  std::vector<Bounds> bounds_;
};

}  // namespace docent::maps

#endif  // DOCENT_MAPS_REGIONS_H_
