#include "workflow/cawl/link_graph.h"

#include <algorithm>
#include <utility>

namespace docent::cawl {

namespace {

// The names in the order in which a search in depth leaves them.
std::vector<std::string> LeavingOrder(const LinkGraph& graph) {
  std::vector<std::string> order;
  std::set<std::string> seen;
  for (const auto& entry : graph) {
    std::vector<std::pair<const std::string*, bool>> todo{{&entry.first, false}};  // true: it is left
    while (!todo.empty()) {
      const auto [name, is_left] = todo.back();
      todo.pop_back();
      if (is_left) order.push_back(*name);
      if (is_left || !seen.insert(*name).second) continue;
      todo.emplace_back(name, true);
      const auto links = graph.find(*name);
      if (links == graph.end()) continue;
      for (const std::string& next : links->second) todo.emplace_back(&next, false);
    }
  }
  return order;
}

LinkGraph Reversed(const LinkGraph& graph) {
  LinkGraph out;
  for (const auto& [from, targets] : graph) {
    for (const std::string& to : targets) out[to].insert(from);
  }
  return out;
}

}  // namespace

std::set<std::string> Reachable(const LinkGraph& graph, std::vector<std::string> starts) {
  std::set<std::string> seen(starts.begin(), starts.end());
  std::vector<std::string> todo = std::move(starts);
  while (!todo.empty()) {
    const auto links = graph.find(todo.back());
    todo.pop_back();
    if (links == graph.end()) continue;
    for (const std::string& next : links->second) {
      if (seen.insert(next).second) todo.push_back(next);
    }
  }
  return seen;
}

// By Kosaraju: against the links, from those that are left last, a search finds one strong component after the other.
LinkGraph LinksOnCycles(const LinkGraph& graph) {
  const std::vector<std::string> order = LeavingOrder(graph);
  const LinkGraph back = Reversed(graph);
  std::map<std::string, size_t> component;
  for (size_t i = order.size(); i-- > 0;) {
    std::vector<std::string> todo{order[i]};
    while (!todo.empty()) {
      const std::string here = std::move(todo.back());
      todo.pop_back();
      if (!component.emplace(here, i).second) continue;
      const auto links = back.find(here);
      if (links == back.end()) continue;
      for (const std::string& before : links->second) {
        if (!component.contains(before)) todo.push_back(before);
      }
    }
  }
  LinkGraph out;
  for (const auto& [from, targets] : graph) {
    for (const std::string& to : targets) {
      if (component.at(from) == component.at(to)) out[from].insert(to);
    }
  }
  return out;
}

std::vector<std::string> ShortestWay(const LinkGraph& graph, const std::string& start,
                                     const std::string& end) {
  std::map<std::string, std::string> came_from;
  std::vector<std::string> todo{start};
  for (size_t i = 0; i < todo.size(); ++i) {
    const auto links = graph.find(todo[i]);
    if (links == graph.end()) continue;
    for (const std::string& next : links->second) {
      if (next == end) {
        std::vector<std::string> way{end};
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
