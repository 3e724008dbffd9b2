// A query that is followed, as Subscriptions keeps it. Private to this folder.
#ifndef DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIBED_QUERY_H_
#define DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIBED_QUERY_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kb_server/subscriptions/subscribed_form.h"
#include "kb_server/subscriptions/subscriptions.h"

namespace docent::server {

struct Subscriptions::Subscription {
  uint32_t number = 0;
  SubscribedQuery followed;
  sparql::Query query;
  size_t query_bytes = 0;              // text, query, and what is made of it
  std::optional<SubscribedForm> form;  // nullopt: always asked whole
  matching::TriggerAnalysis analysis;
  std::vector<Term> unknown;  // constants that the dictionary did not know when it was prepared
  std::unique_ptr<sparql::PreparedQuery> prepared;  // null while it is kept
  std::optional<conditions::ConditionId> kept;
  std::vector<matching::PatternIndex::Handle> watches;
  SubscriptionAnswerPtr answer;
  const Client* payer = nullptr;                   // whose share it is part of: the first who followed it
  size_t charged = 0;                              // bytes
  std::optional<TimeMicros> ripens_at_us;          // its place in ripening_
  absl::Time idle_since = absl::InfiniteFuture();  // its place in idle_
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIBED_QUERY_H_
