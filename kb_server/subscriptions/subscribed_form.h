// Queries whose answer StandingConditions can keep, and how rows are derived from its changes.
//
// Conjunctions of triple patterns with filters, EXISTS, NOT EXISTS and MINUS; where rows are not counted (ASK, SELECT
// DISTINCT) also UNION. A SELECT without DISTINCT counts rows: there every variable is followed, and each
// solution is one row. Pure functions.
#ifndef DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIBED_FORM_H_
#define DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIBED_FORM_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "graph/sparql/syntax/algebra.h"
#include "kb_server/subscriptions/subscription_answer.h"
#include "reasoner/conditions/standing_conditions.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent::server {

struct SubscribedForm {
  std::vector<std::string> keys;  // for RegisterOptions::key_variables; none for an ASK
  std::vector<size_t> columns;    // for each variable of the answer its place among `keys`

  std::vector<SubscriptionAnswer::Row> RowsOf(const std::vector<conditions::Binding>& bindings) const;
};

// nullopt: the query has to be asked whole. `analysis`: of its WHERE. Matching is in the union of all graphs.
std::optional<SubscribedForm> SubscribedFormOf(const sparql::Query& query,
                                               const matching::TriggerAnalysis& analysis);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIBED_FORM_H_
