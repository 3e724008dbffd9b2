// Limits of CAWL and RSEL documents, of their versions, and of what activators keep. The rules of limits.h hold here; a
// separate header, because few files include it. They cannot be configured: all servers accept the same documents.
#ifndef DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_
#define DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_

#include <cstddef>
#include <cstdint>

namespace docent {

struct WorkflowLimits {
  size_t condition_alternatives =
      256;  // alternatives of a context, case or expression after its `or`s are moved to the top
  size_t condition_parts = 10000;   // constraints and events in these alternatives together
  size_t flow_nodes = 4000;         // nodes of one flow
  size_t name_bytes = 256;          // name of a workflow, flow, node, process, operation and the like
  int activator_max = 1000;         // ext:max of an activator
  size_t firings_per_turn = 20000;  // of activators, in one turn; not all of them start runs
  size_t firings_waiting =
      1000;  // firings of one activator that wait for runs of their keys to end (ext:mode="queued")
  size_t events_waiting =
      1000;  // events that stay in the graph because a condition waits with them; beyond, the oldest leave
  size_t facts_written_per_turn = 100000;  // facts that the runs of workflows tell and withdraw in one turn
  size_t assign_solutions = 10000;         // solutions of the SELECT of one ext:assign
  uint64_t assign_steps =
      20000000;  // steps of one ext:assign: about 0.2 seconds; they are no steps of steps_per_turn
  uint64_t assign_steps_per_turn = 200000000;  // steps of every ext:assign of one turn: about two seconds
  size_t assign_memory_bytes = 64u << 20;      // memory of one ext:assign while it is evaluated
  size_t notifications_open = 10000;           // notifications that are neither delivered nor given up
  int notify_attempts = 12;                    // times that one notification is sent before it is given up
  int notify_timeout_ms = 10000;               // time of one attempt
  int notify_first_pause_ms = 1000;            // pause after the first attempt; it doubles with each
  int notify_longest_pause_ms = 300000;        // the longest of these pauses

  size_t reserved_robots = 100;  // robots of one reservation
  size_t roadmap_ways = 2000;    // ways of docent:routeLength's roadmap

  // robot services
  size_t plan_steps = 1000;        // steps of one process, with those that it contains
  size_t all_plan_steps = 200000;  // of all registered processes together
  int process_nesting = 32;        // processes inside each other

  // imports of services
  size_t import_templates = 1000;   // operations that one import gives
  size_t import_parts = 256;        // parts of one message
  size_t import_steps = 1000000;    // elements of schemas that are looked at for them
  size_t import_files = 1000;       // descriptions (.proto) of one gRPC server
  size_t import_bytes = 16u << 20;  // of these descriptions
  int import_timeout_ms = 10000;    // time of a gRPC server or adapter to describe itself
};

inline constexpr WorkflowLimits kWorkflowLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_WORKFLOW_LIMITS_H_
