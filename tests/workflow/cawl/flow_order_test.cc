#include "workflow/cawl/flow_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace docent::cawl {
namespace {

using ::testing::ElementsAre;

// Links as "from to", with "*" in front of one that has `while`.
std::vector<std::string> Ordered(const std::vector<std::string>& nodes,
                                 const std::vector<std::string>& links) {
  Flow flow;
  for (const std::string& name : nodes) flow.nodes.emplace_back().name.value = name;
  for (const std::string& text : links) {
    Link& link = flow.links.emplace_back();
    const bool loops = text[0] == '*';
    const size_t blank = text.find(' ');
    link.from.value = text.substr(loops ? 1 : 0, blank - (loops ? 1 : 0));
    link.to.value = text.substr(blank + 1);
    if (loops) link.while_text.span.line = 1;
  }
  OrderNodes(&flow);
  std::sort(flow.nodes.begin(), flow.nodes.end(),
            [](const Node& a, const Node& b) { return a.position < b.position; });
  std::vector<std::string> names;
  for (const Node& node : flow.nodes) names.push_back(node.name.value);
  return names;
}

TEST(FlowOrder, FollowsTheLinksWhateverTheNames) {
  EXPECT_THAT(Ordered({"Call", "Answer", "Bow"}, {"s Bow", "Bow Answer", "Answer Call", "Call e"}),
              ElementsAre("Bow", "Answer", "Call"));
}

TEST(FlowOrder, BranchesStandAsInTheDocumentAndLoopsDoNotCount) {
  EXPECT_THAT(
      Ordered({"Join", "Left", "Right", "Begin"},
              {"s Begin", "Begin Left", "Begin Right", "Left Join", "Right Join", "*Join Begin", "Join e"}),
      ElementsAre("Begin", "Left", "Right", "Join"));
}

TEST(FlowOrder, NodesOfACycleComeLast) {
  EXPECT_THAT(Ordered({"A", "B", "C"}, {"A B", "B A", "s C"}), ElementsAre("C", "A", "B"));
}

}  // namespace
}  // namespace docent::cawl
