// Graph of names: a flow's links, or which flow contains which. Functions without state; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_LINK_GRAPH_H_
#define DOCENT_WORKFLOW_CAWL_LINK_GRAPH_H_

#include <map>
#include <set>
#include <string>
#include <vector>

namespace docent::cawl {

using LinkGraph = std::map<std::string, std::set<std::string>>;

// `starts` and what a way leads to from them.
std::set<std::string> Reachable(const LinkGraph& graph, std::vector<std::string> starts);

// The links that are part of a cycle. Takes time in proportion to the links.
LinkGraph LinksOnCycles(const LinkGraph& graph);

// The names of a shortest way of one link or more from `start` to `end`, which may be the same; empty if there is none.
std::vector<std::string> ShortestWay(const LinkGraph& graph, const std::string& start,
                                     const std::string& end);

// "A → B → A".
std::string Arrows(const std::vector<std::string>& way);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_LINK_GRAPH_H_
