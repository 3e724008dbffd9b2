#include "workflow/cawl/check/node_reach.h"

#include <map>
#include <string_view>

namespace docent::cawl {
namespace {

NodeSet Closure(const std::vector<NodeSet>& next, const NodeSet& starts) {
  NodeSet seen = starts, todo = starts;
  while (todo.any()) {
    const size_t here = todo._Find_first();
    todo.reset(here);
    const NodeSet found = next[here] & ~seen;
    seen |= found;
    todo |= found;
  }
  return seen;
}

}  // namespace

NodeReach::NodeReach(const Flow& flow, const std::function<bool(const Link&)>& takes)
    : next_(flow.nodes.size()), before_(flow.nodes.size()) {
  std::map<std::string_view, size_t> places;
  for (size_t i = 0; i < flow.nodes.size(); ++i) places.emplace(flow.nodes[i].name.value, i);
  for (const Link& link : flow.links) {
    const auto to = places.find(link.to.value), from = places.find(link.from.value);
    if (to == places.end() || !takes(link)) continue;  // the sink
    (from == places.end() ? first_ : next_[from->second]).set(to->second);
  }
  for (const NodeSet& next : next_) after_.push_back(Closure(next_, next));
  for (size_t i = 0; i < after_.size(); ++i)
    ForEachNode(after_[i], [&](size_t after) { before_[after].set(i); });
}

NodeSet NodeReach::ReachedWith(size_t node, const NodeSet& onward) const {
  std::vector<NodeSet> next = next_;
  next[node] = onward;
  return Closure(next, first_);
}

}  // namespace docent::cawl
