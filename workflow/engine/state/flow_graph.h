// The links of a flow, by node: what an engine asks of them at each step of a run. Made once for a flow, in about linear time;
// immutable.
#ifndef DOCENT_WORKFLOW_ENGINE_STATE_FLOW_GRAPH_H_
#define DOCENT_WORKFLOW_ENGINE_STATE_FLOW_GRAPH_H_

#include <cstddef>
#include <deque>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/functional/function_ref.h"
#include "workflow/cawl/ast.h"

namespace docent::engine {

// Index of the node of that name, without a graph; the number of nodes: none.
size_t NodeIndex(const cawl::Flow& flow, std::string_view name);

class FlowGraph {
 public:
  // Keeps the document: names and links are those of its flow.
  FlowGraph(cawl::DocumentPtr document, size_t flow);

  // Index of the node of that name; the number of nodes for the source, the sink and unknown names.
  size_t NodeIndex(std::string_view name) const;

  // Indexes of links out of a node or of the source, in document order.
  const std::vector<size_t>& LinksFrom(size_t node) const { return links_from_[node]; }
  const std::vector<size_t>& LinksFromSource() const { return links_from_.back(); }
  // The node that a link leads to; the number of nodes: the sink.
  size_t Target(size_t link) const { return targets_[link]; }

  // Names whose links lead to the node, without those that close a cycle (ext:while): the ones that a join waits for.
  const std::set<std::string>& Predecessors(size_t node) const { return predecessors_[node]; }

  // True if the link (one with ext:while) leads back: its end comes before its start. Its start can be reached from there
  // without `while` links, or only from there. No cycle is left without the links that close one.
  bool ClosesCycle(size_t link) const { return closes_cycle_[link]; }

  // Indexes of the nodes that can be reached from `node`, itself included, without going back over cycles.
  std::set<size_t> Reachable(size_t node) const;

  // Whether the node's condition has a `$name` of these.
  bool UsesAny(size_t node, const std::set<std::string>& names) const;

 private:
  using Follow = absl::FunctionRef<bool(size_t link)>;
  std::vector<bool> ReachedFrom(std::vector<size_t> todo, std::vector<bool> seen, Follow follow) const;
  bool LeadsBack(size_t link, Follow follow) const;
  bool ComesAfterItsEnd(size_t link) const;
  std::vector<size_t> LastFirst() const;
  std::vector<size_t> LinksBackWithoutWhile() const;
  void FindCycles();

  const cawl::DocumentPtr document_;
  const cawl::Flow& flow_;
  absl::flat_hash_map<std::string_view, size_t> index_;
  std::vector<std::vector<size_t>> links_from_;  // the source's behind the nodes'
  std::vector<size_t> targets_;
  std::vector<bool> closes_cycle_;
  std::vector<std::set<std::string>> predecessors_;
  std::vector<std::set<std::string_view>> uses_;
};

using FlowGraphPtr = std::shared_ptr<const FlowGraph>;

// The graphs of flows that runs are under way in.
class FlowGraphs {
 public:
  FlowGraphPtr Of(const cawl::DocumentPtr& document, size_t flow);

 private:
  // A graph keeps its document, so that the place of a flow is not another's while the graph lives.
  absl::flat_hash_map<const cawl::Flow*, std::weak_ptr<const FlowGraph>> graphs_;
  std::deque<FlowGraphPtr> recent_;  // flows whose runs end at once
  size_t look_at_ = 64;              // size at which those that are gone are removed
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_STATE_FLOW_GRAPH_H_
