// Graph of names: a flow's links, or which flow contains which. Functions without state; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_LINK_GRAPH_H_
#define DOCENT_WORKFLOW_CAWL_LINK_GRAPH_H_

#include <map>
#include <set>
#include <string>
#include <vector>

namespace docent::cawl {

using LinkGraph = std::map<std::string, std::set<std::string>>;

// `start` and what a way leads to from it.
std::set<std::string> Reachable(const LinkGraph& graph, const std::string& start);

// The names of a shortest way from `start` back to it, `start` first and last; empty if there is none.
std::vector<std::string> CycleThrough(const LinkGraph& graph, const std::string& start);

// "A → B → A".
std::string Arrows(const std::vector<std::string>& way);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_LINK_GRAPH_H_
