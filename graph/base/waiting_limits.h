// Limits of requests that wait for something else than a processor. As in limits.h, an error at a limit gives its name and value.
#ifndef DOCENT_GRAPH_BASE_WAITING_LIMITS_H_
#define DOCENT_GRAPH_BASE_WAITING_LIMITS_H_

#include <cstddef>
#include <cstdint>

namespace docent {

struct WaitingLimits {
  size_t revisions_waiting = 1024;   // requests that wait for a revision; beyond: RESOURCE_EXHAUSTED
  uint64_t revisions_ahead = 65536;  // a revision further ahead of the newest is refused, not waited for
  int queries_first = 768;           // queries begun beyond queries_open, of clients that have none begun
  int queries_stalled = 64;  // queries, updates and imports that wait for other servers or a past graph
  int notify_retry_after_ms =
      3600000;                  // the longest pause that a receiver of notifications asks for and gets
  size_t replays_waiting = 64;  // replays and simulations that wait for the one that runs
};
inline constexpr WaitingLimits kWaitingLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_WAITING_LIMITS_H_
