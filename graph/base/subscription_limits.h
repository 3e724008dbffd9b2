// Limits of subscriptions. As in limits.h, an error at a limit gives its name and value.
#ifndef DOCENT_GRAPH_BASE_SUBSCRIPTION_LIMITS_H_
#define DOCENT_GRAPH_BASE_SUBSCRIPTION_LIMITS_H_

#include <cstddef>

namespace docent {

struct SubscriptionLimits {
  size_t subscriptions_open = 20000;          // open subscriptions of all clients
  size_t subscription_rows = 100000;          // rows of the answer of one subscription
  size_t subscription_changes_kept = 1024;    // newest changes of one answer, for a client that reconnects
  size_t subscription_kept_bytes = 4u << 20;  // texts of these changes of one answer
  size_t subscriptions_kept_bytes =
      256u << 20;  // the same of all answers; beyond, an answer keeps its newest alone
  size_t subscriptions_bytes =
      512u << 20;  // followed queries and their answers; one eighth for clients that come back
  size_t subscription_backlog = 4096;     // turns not yet processed; beyond, they are processed together
  int subscription_evaluation_ms = 1000;  // evaluation of one query after one turn
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_SUBSCRIPTION_LIMITS_H_
