// The limits of what CAWL and RSEL documents say. As limits.h, whose rules hold here; apart, because few include it. They
// cannot be set: what one server takes, every other one takes.
#ifndef DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_
#define DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_

#include <cstddef>

namespace docent {

struct WorkflowLimits {
  size_t condition_alternatives =
      256;  // alternatives of a context, case or expression when its `or`s are carried outside
  size_t condition_parts = 10000;  // constraints and events in these alternatives together
  size_t name_bytes = 256;         // name of a workflow, flow, node, process, operation and the like
};

inline constexpr WorkflowLimits kWorkflowLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_
