#include "workflow/cawl/flow_order.h"

#include <functional>
#include <map>
#include <queue>
#include <string_view>
#include <vector>

namespace docent::cawl {

void OrderNodes(Flow* flow) {
  std::map<std::string_view, size_t> index;
  for (size_t i = 0; i < flow->nodes.size(); ++i) index.emplace(flow->nodes[i].name.value, i);
  std::vector<std::vector<size_t>> next(flow->nodes.size());
  std::vector<size_t> before(flow->nodes.size());
  for (const Link& link : flow->links) {
    const auto from = index.find(link.from.value), to = index.find(link.to.value);
    if (from == index.end() || to == index.end() || link.while_text.given()) continue;
    next[from->second].push_back(to->second);
    ++before[to->second];
  }
  std::priority_queue<size_t, std::vector<size_t>, std::greater<>> ready;
  for (size_t i = 0; i < before.size(); ++i) {
    if (before[i] == 0) ready.push(i);
  }
  size_t position = 0;
  for (; !ready.empty();) {
    const size_t node = ready.top();
    ready.pop();
    flow->nodes[node].position = ++position;
    for (const size_t after : next[node]) {
      if (--before[after] == 0) ready.push(after);
    }
  }
  for (Node& node : flow->nodes) {
    if (node.position == 0) node.position = ++position;
  }
}

}  // namespace docent::cawl
