#include "maps/regions.h"

#include <algorithm>
#include <utility>

namespace docent::maps {

RegionIndex::RegionIndex(std::vector<Region> regions) : regions_(std::move(regions)) {
  std::sort(regions_.begin(), regions_.end(), [](const Region& a, const Region& b) {
    return std::pair(Area(a.outline), std::string_view(a.iri)) <
           std::pair(Area(b.outline), std::string_view(b.iri));
  });
  for (const Region& region : regions_) bounds_.push_back(BoundsOf(region.outline));
}

const Region* RegionIndex::Innermost(const Point2& p) const {
  for (size_t i = 0; i < regions_.size(); ++i) {
    const Bounds& b = bounds_[i];
    if (p.x_m < b.min_x_m || p.x_m > b.max_x_m || p.y_m < b.min_y_m || p.y_m > b.max_y_m) continue;
    if (Contains(regions_[i].outline, p)) return &regions_[i];
  }
  return nullptr;
}

const Region* RegionIndex::Innermost(const Point2& p, const Region* current, double margin_m) const {
  const Region* found = Innermost(p);
  if (current == nullptr || found == current) return found;
  // A region inside `current` is entered at once; only leaving is delayed by the margin.
  if (found != nullptr && found < current) return found;
  return DistanceToOutline(p, current->outline) <= margin_m ? current : found;
}

}  // namespace docent::maps
