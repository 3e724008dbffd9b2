// Limits of explanations and what-if questions. As in limits.h, an error at a limit gives its name and
// value.
#ifndef DOCENT_GRAPH_BASE_EXPLAIN_LIMITS_H_
#define DOCENT_GRAPH_BASE_EXPLAIN_LIMITS_H_

#include <cstddef>

namespace docent {

struct ExplainLimits {
  size_t explain_steps = 200000;        // steps of the search for one explanation
  size_t explain_facts = 10000;         // facts in one proof
  int explain_changes = 6;              // facts missing or blocking, in one set of a why-not
  size_t explain_log_records = 100000;  // newest records searched for the source and time of a fact
  size_t what_if_operations = 10000;    // facts in one what-if question
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_EXPLAIN_LIMITS_H_
