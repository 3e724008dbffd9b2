#include "reasoner/rules/stratification.h"

#include <algorithm>

namespace docent::rules {
namespace {

// Tarjan's algorithm with an explicit stack. A component comes after all components on which it depends.
class Components {
 public:
  explicit Components(const DependencyGraph& graph)
      : graph_(graph), order_(graph.size(), 0), low_(graph.size(), 0), component_(graph.size(), -1) {
    for (uint32_t v = 0; v < graph.size(); ++v) {
      if (order_[v] == 0) Visit(v);
    }
  }
  const std::vector<int>& component() const { return component_; }
  int count() const { return count_; }

 private:
  struct Frame {
    uint32_t vertex;
    size_t next_edge;
  };

  void Enter(uint32_t v) {
    order_[v] = low_[v] = ++clock_;
    open_.push_back(v);
    frames_.push_back({v, 0});
  }

  void Visit(uint32_t root) {
    Enter(root);
    while (!frames_.empty()) {
      Frame& frame = frames_.back();
      const uint32_t v = frame.vertex;
      if (frame.next_edge < graph_[v].size()) {
        const uint32_t w = graph_[v][frame.next_edge++];
        if (order_[w] == 0) {
          Enter(w);
        } else if (component_[w] < 0) {
          low_[v] = std::min(low_[v], order_[w]);
        }
        continue;
      }
      if (low_[v] == order_[v]) Close(v);
      frames_.pop_back();
      if (!frames_.empty()) low_[frames_.back().vertex] = std::min(low_[frames_.back().vertex], low_[v]);
    }
  }

  void Close(uint32_t v) {
    uint32_t w;
    do {
      w = open_.back();
      open_.pop_back();
      component_[w] = count_;
    } while (w != v);
    ++count_;
  }

  const DependencyGraph& graph_;
  std::vector<uint32_t> order_;
  std::vector<uint32_t> low_;
  std::vector<int> component_;
  std::vector<uint32_t> open_;
  std::vector<Frame> frames_;
  uint32_t clock_ = 0;
  int count_ = 0;
};

// A shortest path from `from` to `to` along the graph, with both ends; empty: there is none.
std::vector<uint32_t> ShortestWay(const DependencyGraph& graph, uint32_t from, uint32_t to) {
  std::vector<int64_t> before(graph.size(), -1);
  std::vector<uint32_t> queue = {from};
  before[from] = from;
  for (size_t i = 0; i < queue.size() && before[to] < 0; ++i) {
    for (const uint32_t w : graph[queue[i]]) {
      if (before[w] >= 0) continue;
      before[w] = queue[i];
      queue.push_back(w);
    }
  }
  if (before[to] < 0) return {};
  std::vector<uint32_t> way = {to};
  while (way.back() != from) way.push_back(static_cast<uint32_t>(before[way.back()]));
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace

DependencyGraph GraphOf(uint32_t rule_count, const std::vector<RuleDependency>& dependencies) {
  DependencyGraph graph(rule_count);
  for (const RuleDependency& d : dependencies) graph[d.from].push_back(d.to);
  return graph;
}

std::vector<uint32_t> CycleThrough(uint32_t rule, const DependencyGraph& graph) {
  std::vector<int64_t> before(graph.size(), -1);
  std::vector<uint32_t> queue = {rule};
  for (size_t i = 0; i < queue.size(); ++i) {
    for (const uint32_t w : graph[queue[i]]) {
      if (w == rule) {
        std::vector<uint32_t> cycle = {queue[i]};
        while (cycle.back() != rule) cycle.push_back(static_cast<uint32_t>(before[cycle.back()]));
        std::reverse(cycle.begin(), cycle.end());
        return cycle;
      }
      if (before[w] >= 0) continue;
      before[w] = queue[i];
      queue.push_back(w);
    }
  }
  return {};
}

Stratification Stratify(uint32_t rule_count, const std::vector<RuleDependency>& dependencies) {
  const DependencyGraph graph = GraphOf(rule_count, dependencies);
  const Components components(graph);
  Stratification result;
  result.stratum = components.component();
  result.count = components.count();
  for (const RuleDependency& d : dependencies) {
    if (!d.negative || result.stratum[d.from] != result.stratum[d.to]) continue;
    result.negative_cycle = {d.from};
    if (d.from != d.to) {
      const std::vector<uint32_t> back = ShortestWay(graph, d.to, d.from);
      result.negative_cycle.insert(result.negative_cycle.end(), back.begin(), back.end() - 1);
    }
    break;
  }
  return result;
}

}  // namespace docent::rules
