// Choice among robots that are free: a SPARQL SELECT of ?robot, the one to be preferred first. Functions without state; any
// thread.
//
// Variables of the query that have the name of a variable of the run have its value. ?goal is the first input of the operation
// that is a resource, for example the place to drive to. Free robots that the query does not name come after those that it
// names. Ties are broken by the robots' IRIs, so that the same graph always gives the same robot.
#ifndef DOCENT_WORKFLOW_CAWL_ROBOT_CHOICE_H_
#define DOCENT_WORKFLOW_CAWL_ROBOT_CHOICE_H_

#include <string>
#include <string_view>

#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"
#include "graph/sparql/syntax/algebra.h"

namespace docent::cawl {

// Where the document has no ext:choose: the nearest to the goal, along the roadmap where the graph has one; then the one with the
// most charge, the one with the smallest load, the one that was used the longest time ago. Of the run's variables, it has ?goal
// alone.
std::string_view DefaultRobotChoice();

struct ParsedChoice {
  sparql::Query query;
  Diagnostics diagnostics;  // places are in the text
};
// The query with the robots' IRIs as its last order.
ParsedChoice ParseRobotChoice(const std::string& text, const Limits& limits);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_ROBOT_CHOICE_H_
