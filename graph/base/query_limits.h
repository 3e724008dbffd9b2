// Limits of the parts of a SPARQL text, beside those of limits.h. As there, an error at a limit gives its name and value.
#ifndef DOCENT_GRAPH_BASE_QUERY_LIMITS_H_
#define DOCENT_GRAPH_BASE_QUERY_LIMITS_H_

#include <cstddef>

namespace docent {

struct QueryLimits {
  // of one query, or one operation of an update
  size_t query_patterns = 10000;        // triple patterns, branches of UNION and GRAPH
  size_t query_path_steps = 10000;      // steps of all property paths
  size_t query_list_elements = 100000;  // arguments of functions, and members of IN, && and ||
  size_t query_values = 1000000;        // values in VALUES

  // of an update
  size_t update_operations = 50000;  // operations in one update
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_QUERY_LIMITS_H_
