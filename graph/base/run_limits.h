// Limits of runs of workflows: what one turn does for them, and what is kept of their conditions. The rules of limits.h hold
// here; a separate header, because few files include it. They cannot be configured: a log is replayed under the limits under
// which it was written.
#ifndef DOCENT_GRAPH_BASE_RUN_LIMITS_H_
#define DOCENT_GRAPH_BASE_RUN_LIMITS_H_

#include <cstddef>

namespace docent {

struct RunLimits {
  size_t nodes_live =
      400000;  // nodes of all flows of live runs, and their invocations, together; beyond, a run does not start
  size_t node_invocations =
      10000;  // invocations of one node: its invokes, for each binding of ext:forEach; a node with more fails
  size_t node_changes_per_turn = 40000;  // nodes that change in one turn; their runs go on in the next turn
  size_t runs_started_per_turn =
      20000;  // runs that activators start in one turn; a deployment beyond is refused, and later a match starts no run
  int activation_rounds_per_turn =
      24;  // rounds of one turn in which one activator starts runs, which its own runs start again; beyond, as above
  size_t condition_matches =
      100000;  // matches kept of one condition, or as many as the graph has facts; beyond, it is followed no more
};

inline constexpr RunLimits kRunLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_RUN_LIMITS_H_
