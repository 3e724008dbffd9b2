#include "workflow/cawl/link_graph.h"

#include <algorithm>
#include <utility>

namespace docent::cawl {

std::set<std::string> Reachable(const LinkGraph& graph, const std::string& start) {
  std::set<std::string> seen{start};
  std::vector<std::string> todo{start};
  while (!todo.empty()) {
    std::string here = std::move(todo.back());
    todo.pop_back();
    auto it = graph.find(here);
    if (it == graph.end()) continue;
    for (const std::string& next : it->second) {
      if (seen.insert(next).second) todo.push_back(next);
    }
  }
  return seen;
}

std::vector<std::string> CycleThrough(const LinkGraph& graph, const std::string& start) {
  std::map<std::string, std::string> came_from;
  std::vector<std::string> todo{start};
  for (size_t i = 0; i < todo.size(); ++i) {
    auto it = graph.find(todo[i]);
    if (it == graph.end()) continue;
    for (const std::string& next : it->second) {
      if (next == start) {
        std::vector<std::string> way{start};
        for (std::string at = todo[i]; at != start; at = came_from[at]) way.push_back(at);
        way.push_back(start);
        std::reverse(way.begin(), way.end());
        return way;
      }
      if (came_from.emplace(next, todo[i]).second) todo.push_back(next);
    }
  }
  return {};
}

std::string Arrows(const std::vector<std::string>& way) {
  std::string out;
  for (const std::string& name : way) out += (out.empty() ? "" : " → ") + name;
  return out;
}

}  // namespace docent::cawl
