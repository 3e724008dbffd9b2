// Limits of CAWL and RSEL documents, of their versions, and of what activators keep. The rules of limits.h hold here; a
// separate header, because few files include it. They cannot be configured: all servers accept the same documents.
#ifndef DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_
#define DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_

#include <cstddef>

namespace docent {

struct WorkflowLimits {
  size_t condition_alternatives =
      256;  // alternatives of a context, case or expression after its `or`s are moved to the top
  size_t condition_parts = 10000;  // constraints and events in these alternatives together
  size_t name_bytes = 256;         // name of a workflow, flow, node, process, operation and the like

  int activator_max = 1000;        // ext:max of an activator
  size_t firings_waiting = 1000;  // firings of one activator that wait for runs of their keys to end (ext:mode="queued")
  size_t events_waiting =
      1000;  // events that stay in the graph because a condition waits with them; beyond, the oldest leave
};

inline constexpr WorkflowLimits kWorkflowLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_
