// Rules that must have held for some time: <rule ext:for="5s">. Functions without state; any thread.
//
// A rule with `for` is looked at by itself: each binding of its variables has its own time, which begins when the
// binding begins to hold (or when the condition is first awaited, if that is later) and ends with it. The rules of
// the context are joined as always, with the same values, and a solution counts while the part of it that belongs
// to such a rule has held for the rule's time.
//
// Therefore a variable that such a rule shares with another rule must be bound by a constraint of its own, outside
// of `not`, in each alternative of an `or`.
#ifndef DOCENT_WORKFLOW_CAWL_LASTING_RULES_H_
#define DOCENT_WORKFLOW_CAWL_LASTING_RULES_H_

#include <set>
#include <string>

#include "workflow/cawl/ast.h"

namespace docent::cawl {

// Variables that every solution of the rule binds, as names of SPARQL variables: "x" for ?x and $x, "x_part" for
// $x.part.
std::set<std::string> CertainVariables(const Rule& rule);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_LASTING_RULES_H_
