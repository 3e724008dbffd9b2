#include "workflow/engine/state/flow_graph.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "absl/container/flat_hash_set.h"

namespace docent::engine {
namespace {

constexpr size_t kRecent = 32;

std::set<std::string_view> VariablesOf(const cawl::Node& node) {
  std::set<std::string_view> names;
  if (!node.condition) return names;
  for (const cawl::Context& context : node.condition->contexts) {
    for (const cawl::Rule& rule : context.rules) {
      for (const cawl::Constraint& constraint : rule.constraints) {
        for (const cawl::Word* word : {&constraint.subject, &constraint.verb, &constraint.object}) {
          if (word->kind == cawl::Word::Kind::kVariable) names.insert(word->name);
        }
      }
    }
  }
  return names;
}

}  // namespace

size_t NodeIndex(const cawl::Flow& flow, std::string_view name) {
  const auto found = std::find_if(flow.nodes.begin(), flow.nodes.end(),
                                  [name](const cawl::Node& node) { return node.name.value == name; });
  return static_cast<size_t>(found - flow.nodes.begin());
}

FlowGraph::FlowGraph(cawl::DocumentPtr document, size_t flow)
    : document_(std::move(document)),
      flow_(document_->flows[flow]),
      links_from_(flow_.nodes.size() + 1),
      closes_cycle_(flow_.links.size()),
      predecessors_(flow_.nodes.size()) {
  for (const cawl::Node& node : flow_.nodes) {
    index_.emplace(node.name.value, index_.size());
    uses_.push_back(VariablesOf(node));
  }
  const size_t none = flow_.nodes.size();
  for (size_t i = 0; i < flow_.links.size(); ++i) {
    const cawl::Link& link = flow_.links[i];
    targets_.push_back(NodeIndex(link.to.value));
    const size_t from = NodeIndex(link.from.value);
    if (from != none || link.from.value == flow_.source.value) links_from_[from].push_back(i);
  }
  FindCycles();
  for (size_t i = 0; i < flow_.links.size(); ++i) {
    if (targets_[i] != none && !closes_cycle_[i])
      predecessors_[targets_[i]].insert(flow_.links[i].from.value);
  }
}

size_t FlowGraph::NodeIndex(std::string_view name) const {
  const auto found = index_.find(name);
  return found == index_.end() ? flow_.nodes.size() : found->second;
}

bool FlowGraph::UsesAny(size_t node, const std::set<std::string>& names) const {
  return std::any_of(uses_[node].begin(), uses_[node].end(),
                     [&names](std::string_view name) { return names.contains(std::string(name)); });
}

// The nodes of `todo`, and all that can be reached from them over links that `follow` takes; those of `seen` stop it.
std::vector<bool> FlowGraph::ReachedFrom(std::vector<size_t> todo, std::vector<bool> seen,
                                         Follow follow) const {
  while (!todo.empty()) {
    const size_t here = todo.back();
    todo.pop_back();
    if (here >= flow_.nodes.size() || seen[here]) continue;
    seen[here] = true;
    for (const size_t link : links_from_[here]) {
      if (follow(link)) todo.push_back(targets_[link]);
    }
  }
  return seen;
}

std::set<size_t> FlowGraph::Reachable(size_t node) const {
  const std::vector<bool> seen = ReachedFrom({node}, std::vector<bool>(flow_.nodes.size()),
                                             [this](size_t link) { return !closes_cycle_[link]; });
  std::set<size_t> reachable;
  for (size_t i = 0; i < seen.size(); ++i) {
    if (seen[i]) reachable.insert(i);
  }
  return reachable;
}

// Whether the start of the link can be reached from its end.
bool FlowGraph::LeadsBack(size_t link, Follow follow) const {
  return ReachedFrom({targets_[link]}, std::vector<bool>(flow_.nodes.size()),
                     follow)[NodeIndex(flow_.links[link].from.value)];
}

// Whether every way from the source to the start of the link goes through its end.
bool FlowGraph::ComesAfterItsEnd(size_t link) const {
  std::vector<size_t> first;
  for (const size_t i : LinksFromSource()) first.push_back(targets_[i]);
  std::vector<bool> seen(flow_.nodes.size());
  seen[targets_[link]] = true;
  const size_t start = NodeIndex(flow_.links[link].from.value);
  return start == targets_[link] ||
         !ReachedFrom(std::move(first), std::move(seen), [](size_t) { return true; })[start];
}

// Nodes in an order in which links without `while` lead to earlier ones.
std::vector<size_t> FlowGraph::LastFirst() const {
  const size_t none = flow_.nodes.size();
  std::vector<size_t> before(none);
  for (size_t i = 0; i < flow_.links.size(); ++i) {
    const bool counts = !flow_.links[i].while_constraint && NodeIndex(flow_.links[i].from.value) != none;
    if (counts && targets_[i] != none) ++before[targets_[i]];
  }
  std::vector<size_t> order;
  for (size_t node = 0; node < none; ++node) {
    if (before[node] == 0) order.push_back(node);
  }
  for (size_t next = 0; next < order.size(); ++next) {
    for (const size_t link : links_from_[order[next]]) {
      const bool counts = !flow_.links[link].while_constraint && targets_[link] != none;
      if (counts && --before[targets_[link]] == 0) order.push_back(targets_[link]);
    }
  }
  std::reverse(order.begin(), order.end());
  return order;
}

// The `while` links whose start can be reached from their end without such links. Asked for 64 starts together.
std::vector<size_t> FlowGraph::LinksBackWithoutWhile() const {
  const size_t none = flow_.nodes.size();
  std::map<size_t, std::vector<std::pair<size_t, size_t>>> blocks;  // number of 64 nodes → start, link
  for (size_t i = 0; i < flow_.links.size(); ++i) {
    if (!flow_.links[i].while_constraint || targets_[i] == none) continue;
    const size_t from = NodeIndex(flow_.links[i].from.value);
    if (from != none) blocks[from / 64].emplace_back(from, i);
  }
  if (blocks.empty()) return {};
  const std::vector<size_t> order = LastFirst();
  std::vector<size_t> back;
  for (const auto& [block, links] : blocks) {
    std::vector<uint64_t> reaches(none);
    for (const size_t node : order) {
      if (node / 64 == block) reaches[node] = uint64_t{1} << node % 64;
      for (const size_t link : links_from_[node]) {
        if (!flow_.links[link].while_constraint && targets_[link] != none)
          reaches[node] |= reaches[targets_[link]];
      }
    }
    for (const auto& [from, link] : links) {
      if ((reaches[targets_[link]] >> from % 64 & 1) != 0) back.push_back(link);
    }
  }
  return back;
}

void FlowGraph::FindCycles() {
  for (const size_t link : LinksBackWithoutWhile()) closes_cycle_[link] = true;
  std::vector<size_t> open;  // may close one: they stand in a cycle that has several `while` links
  for (size_t i = 0; i < flow_.links.size(); ++i) {
    const bool may = flow_.links[i].while_constraint && !closes_cycle_[i] &&
                     targets_[i] != flow_.nodes.size() &&
                     NodeIndex(flow_.links[i].from.value) != flow_.nodes.size() &&
                     LeadsBack(i, [](size_t) { return true; });
    if (!may) continue;
    if (ComesAfterItsEnd(i))
      closes_cycle_[i] = true;
    else
      open.push_back(i);
  }
  // A cycle of `while` links that can be entered at several nodes: the later ones in the document lead back.
  absl::flat_hash_set<size_t> forward;
  for (const size_t link : open) {
    closes_cycle_[link] = LeadsBack(link, [this, &forward](size_t other) {
      return !flow_.links[other].while_constraint || forward.contains(other);
    });
    if (!closes_cycle_[link]) forward.insert(link);
  }
}

FlowGraphPtr FlowGraphs::Of(const cawl::DocumentPtr& document, size_t flow) {
  std::weak_ptr<const FlowGraph>& kept = graphs_[&document->flows[flow]];
  FlowGraphPtr graph = kept.lock();
  if (graph != nullptr) return graph;
  graph = std::make_shared<const FlowGraph>(document, flow);
  kept = graph;
  recent_.push_back(graph);
  if (recent_.size() > kRecent) recent_.pop_front();
  if (graphs_.size() >= look_at_) {
    absl::erase_if(graphs_, [](const auto& entry) { return entry.second.expired(); });
    look_at_ = graphs_.size() * 2 + 64;
  }
  return graph;
}

}  // namespace docent::engine
