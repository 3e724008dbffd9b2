// The graph of a flow against what its links say one by one.
#include "workflow/engine/state/flow_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"

namespace docent::engine {
namespace {

using ::testing::ElementsAre;

void AddLink(cawl::Flow* flow, const std::string& from, const std::string& to, bool with_while = false) {
  cawl::Link& link = flow->links.emplace_back();
  link.from.value = from;
  link.to.value = to;
  if (with_while) link.while_constraint.emplace();
}

cawl::Document Nodes(size_t count) {
  cawl::Document document;
  cawl::Flow& flow = document.flows.emplace_back();
  flow.source.value = "s";
  flow.sink.value = "t";
  for (size_t i = 0; i < count; ++i) flow.nodes.emplace_back().name.value = absl::StrCat("n", i);
  return document;
}

// What links of these lead to, one after the other, never from `blocked`.
std::set<std::string> ReachedFrom(const cawl::Flow& flow, const std::string& start,
                                  const std::vector<bool>& followed, const std::string& blocked = "") {
  std::set<std::string> seen = {start};
  for (bool more = true; more;) {
    more = false;
    for (size_t i = 0; i < flow.links.size(); ++i) {
      const cawl::Link& link = flow.links[i];
      if (followed[i] && link.from.value != blocked && seen.contains(link.from.value))
        more = seen.insert(link.to.value).second || more;
    }
  }
  return seen;
}

// Which links lead back, by what flow_graph.h says.
std::vector<bool> ClosingLinks(const cawl::Flow& flow) {
  const size_t count = flow.links.size();
  std::vector<bool> closes(count), forward(count), open(count);
  const std::vector<bool> all(count, true);
  for (size_t i = 0; i < count; ++i) forward[i] = !flow.links[i].while_constraint;
  const std::vector<bool> plain = forward;
  const auto leads_back = [&flow](size_t i, const std::vector<bool>& followed) {
    return ReachedFrom(flow, flow.links[i].to.value, followed).contains(flow.links[i].from.value);
  };
  for (size_t i = 0; i < count; ++i) {
    const cawl::Link& link = flow.links[i];
    if (!link.while_constraint || link.to.value == "t" || !leads_back(i, all)) continue;
    closes[i] = leads_back(i, plain) || link.from.value == link.to.value ||
                !ReachedFrom(flow, "s", all, link.to.value).contains(link.from.value);
    open[i] = !closes[i];
  }
  for (size_t i = 0; i < count; ++i) {
    if (!open[i]) continue;
    closes[i] = leads_back(i, forward);
    forward[i] = !closes[i];
  }
  return closes;
}

TEST(FlowGraph, LinksOfANodeAreThoseOfTheDocument) {
  cawl::Document document = Nodes(3);
  cawl::Flow& flow = document.flows[0];
  AddLink(&flow, "n1", "n2");
  AddLink(&flow, "s", "n0");
  AddLink(&flow, "n0", "n1");
  AddLink(&flow, "n2", "t");
  AddLink(&flow, "n2", "n1", true);
  AddLink(&flow, "n1", "t");
  const FlowGraph graph(std::make_shared<const cawl::Document>(std::move(document)), 0);
  EXPECT_THAT(graph.LinksFromSource(), ElementsAre(1));
  EXPECT_THAT(graph.LinksFrom(1), ElementsAre(0, 5));
  EXPECT_THAT(graph.LinksFrom(2), ElementsAre(3, 4));
  EXPECT_EQ(graph.Target(0), 2u);
  EXPECT_EQ(graph.Target(3), 3u) << "the sink";
  EXPECT_EQ(graph.NodeIndex("n2"), 2u);
  EXPECT_EQ(graph.NodeIndex("s"), 3u);
  EXPECT_THAT(graph.Predecessors(0), ElementsAre("s"));
  EXPECT_THAT(graph.Predecessors(1), ElementsAre("n0")) << "not the one that closes a cycle";
  EXPECT_TRUE(graph.ClosesCycle(4));
  EXPECT_FALSE(graph.ClosesCycle(0));
  EXPECT_THAT(graph.Reachable(1), ElementsAre(1, 2));
}

TEST(FlowGraph, RandomFlows) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    const size_t count = 1 + random() % 150;
    cawl::Document document = Nodes(count);
    cawl::Flow& flow = document.flows[0];
    const auto name = [](size_t node) { return absl::StrCat("n", node); };
    AddLink(&flow, "s", name(count / 2));
    for (size_t i = 0; i < count * 2; ++i) {
      const size_t a = random() % count, b = random() % count;
      const bool with_while = random() % 4 == 0;
      // without `while`, links lead from even to odd, and up among equals: no cycle, and not the order of the document
      const auto rank = [count](size_t node) { return node % 2 * count + node; };
      if (with_while || rank(a) < rank(b)) AddLink(&flow, name(a), name(b), with_while);
      if (with_while && random() % 3 == 0) AddLink(&flow, name(a), "t", true);
    }
    const auto kept = std::make_shared<const cawl::Document>(std::move(document));
    const FlowGraph graph(kept, 0);
    const std::vector<bool> closing = ClosingLinks(kept->flows[0]);
    std::vector<std::set<std::string>> before(count);
    for (size_t i = 0; i < kept->flows[0].links.size(); ++i) {
      const cawl::Link& link = kept->flows[0].links[i];
      ASSERT_EQ(graph.ClosesCycle(i), closing[i]) << link.from.value << " to " << link.to.value;
      if (link.to.value != "t" && !closing[i]) before[graph.NodeIndex(link.to.value)].insert(link.from.value);
    }
    for (size_t node = 0; node < count; ++node) ASSERT_EQ(graph.Predecessors(node), before[node]);
  }
}

TEST(FlowGraphs, AGraphIsMadeOnceWhileItIsUsed) {
  FlowGraphs graphs;
  const auto document = std::make_shared<const cawl::Document>(Nodes(2));
  const FlowGraphPtr graph = graphs.Of(document, 0);
  EXPECT_EQ(graphs.Of(document, 0), graph);
  for (int i = 0; i < 1000; ++i) graphs.Of(std::make_shared<const cawl::Document>(Nodes(1)), 0);
  EXPECT_EQ(graphs.Of(document, 0), graph);
}

}  // namespace
}  // namespace docent::engine
