// The limits of what CAWL and RSEL documents say. As limits.h, whose rules hold here; apart, because workflow alone includes
// it. Fixed: what one server takes, every other one and its log take.
#ifndef DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_
#define DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_

#include <cstddef>

namespace docent {

struct WorkflowLimits {
  // Of a context, a case, an expression or what stands under a `not`, when its `or`s are carried to the outside.
  static constexpr size_t condition_alternatives = 256;
  static constexpr size_t condition_parts = 10000;  // constraints and events in these alternatives together
  static constexpr size_t name_bytes = 256;  // of a workflow, flow, node, process, operation and the like
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_
