// Filter of queries for Rasqal 0.9.33. It refuses constructs that Rasqal does not know or execute, constructs
// that it answers wrongly without an error, and queries whose preparation does not end. Pure function.
//
// Measured with the W3C suites; tests/graph/redland/rasqal_differences.txt lists each with a query, and a
// test checks the list against both engines.
#ifndef DOCENT_GRAPH_REDLAND_RASQAL_GUARD_H_
#define DOCENT_GRAPH_REDLAND_RASQAL_GUARD_H_

#include "absl/status/status.h"
#include "graph/base/limits.h"
#include "graph/sparql/syntax/algebra.h"

namespace docent::redland {

// UNIMPLEMENTED naming the construct, its place and the remedy; RESOURCE_EXHAUSTED naming
// rasqal_optional_nesting.
absl::Status CheckForRasqal(const sparql::Query& query, const Limits& limits = {});

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_RASQAL_GUARD_H_
