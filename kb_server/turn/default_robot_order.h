// Order of robots by the default query of workflow/cawl/robot_choice.h, read straight from the indexes for the robots that
// are asked about. The query itself looks at every robot of the graph, which is most of the work of a short run. Both give
// the same order; where only the query can tell, there is no answer here.
#ifndef DOCENT_KB_SERVER_TURN_DEFAULT_ROBOT_ORDER_H_
#define DOCENT_KB_SERVER_TURN_DEFAULT_ROBOT_ORDER_H_

#include <optional>
#include <vector>

#include "graph/base/ids.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/term_id.h"
#include "graph/store/graph_version.h"

namespace docent::server {

// The robots, the one to be preferred first; ties in the order of the IRIs, then those that are no docent:Robot as they
// came. `goal`: the place to go to; none: there is none. nullopt: the goal has a place, so that distances count, or a robot
// has several values of one property. Pure function of its arguments; any thread.
std::optional<std::vector<RobotId>> DefaultRobotOrder(const GraphVersion& version,
                                                      const Dictionary& dictionary,
                                                      std::optional<TermId> goal,
                                                      const std::vector<RobotId>& able);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_TURN_DEFAULT_ROBOT_ORDER_H_
