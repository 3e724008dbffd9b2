// Limits of subscriptions; beside limits.h, with the same rules: an error at a limit says its name and value.
#ifndef DOCENT_GRAPH_BASE_SUBSCRIPTION_LIMITS_H_
#define DOCENT_GRAPH_BASE_SUBSCRIPTION_LIMITS_H_

#include <cstddef>

namespace docent {

struct SubscriptionLimits {
  size_t subscriptions_open = 20000;        // queries that clients follow
  size_t subscription_rows = 100000;        // rows of one answer that is followed
  size_t subscription_changes_kept = 1024;  // newest changes of one answer, for a client that comes back
  size_t subscription_backlog = 4096;  // turns that wait to be looked at; beyond, they are looked at together
  int subscription_evaluation_ms = 1000;  // evaluation of one query after one turn
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_SUBSCRIPTION_LIMITS_H_
