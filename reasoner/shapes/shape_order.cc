#include "reasoner/shapes/shape_order.h"

#include <algorithm>

namespace docent::shapes {
namespace {

std::vector<ShapeIndex> ReferencesOf(const Shape& shape) {
  std::vector<ShapeIndex> out;
  for (const Constraint& constraint : shape.constraints) {
    out.insert(out.end(), constraint.shapes.begin(), constraint.shapes.end());
    out.insert(out.end(), constraint.siblings.begin(), constraint.siblings.end());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

// Removes shapes to which no remaining shape refers, one after the other (Kahn 1962); the remaining ones form
// cycles.
ShapeOrder OrderShapes(const ShapeSet& set) {
  const size_t count = set.shapes.size();
  std::vector<std::vector<ShapeIndex>> references(count);
  std::vector<size_t> referrers(count, 0);
  for (size_t i = 0; i < count; ++i) {
    references[i] = ReferencesOf(set.shapes[i]);
    for (const ShapeIndex to : references[i]) ++referrers[to];
  }
  std::vector<ShapeIndex> order;
  for (size_t i = 0; i < count; ++i) {
    if (referrers[i] == 0) order.push_back(static_cast<ShapeIndex>(i));
  }
  for (size_t at = 0; at < order.size(); ++at) {
    for (const ShapeIndex to : references[order[at]]) {
      if (--referrers[to] == 0) order.push_back(to);
    }
  }
  ShapeOrder out;
  if (order.size() < count) {
    // Another remaining shape refers to each remaining one: walking back from any of them ends in a cycle.
    std::vector<ShapeIndex> back(count, 0);
    ShapeIndex start = 0;
    for (size_t i = 0; i < count; ++i) {
      if (referrers[i] == 0) continue;
      start = static_cast<ShapeIndex>(i);
      for (const ShapeIndex to : references[i]) back[to] = static_cast<ShapeIndex>(i);
    }
    std::vector<int> seen_at(count, -1);
    std::vector<ShapeIndex> way;
    for (ShapeIndex at = start; seen_at[at] < 0; at = back[at]) {
      seen_at[at] = static_cast<int>(way.size());
      way.push_back(at);
    }
    const ShapeIndex meeting = back[way.back()];
    out.cycle.assign(way.begin() + seen_at[meeting], way.end());
    std::reverse(out.cycle.begin(), out.cycle.end());
    return out;
  }
  std::vector<int> depth(count, 1);
  for (auto it = order.rbegin(); it != order.rend(); ++it) {
    for (const ShapeIndex to : references[*it]) depth[*it] = std::max(depth[*it], depth[to] + 1);
    if (depth[*it] > out.depth) {
      out.depth = depth[*it];
      out.deepest = *it;
    }
  }
  return out;
}

}  // namespace docent::shapes
