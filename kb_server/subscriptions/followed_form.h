// Which queries a ConstraintSet can keep the answer of, and how the rows are had from what it tells.
//
// Conjunctions of triple patterns with filters, EXISTS, NOT EXISTS and MINUS; where rows are not counted (ASK, SELECT
// DISTINCT) also UNION. A SELECT without DISTINCT counts rows: there every variable is followed, and each
// solution is one row. Pure functions.
#ifndef DOCENT_KB_SERVER_SUBSCRIPTIONS_FOLLOWED_FORM_H_
#define DOCENT_KB_SERVER_SUBSCRIPTIONS_FOLLOWED_FORM_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "graph/sparql/syntax/algebra.h"
#include "kb_server/subscriptions/standing_answer.h"
#include "reasoner/conditions/constraint_set.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent {

struct FollowedForm {
  std::vector<std::string> keys;  // for RegisterOptions::key_variables; none for an ASK
  std::vector<size_t> columns;    // for each variable of the answer its place among `keys`

  std::vector<StandingAnswer::Row> RowsOf(const std::vector<Binding>& bindings) const;
};

// nullopt: the query has to be asked whole. `analysis`: of its WHERE. Matching is in the union of all graphs.
std::optional<FollowedForm> FollowedFormOf(const sparql::Query& query, const TriggerAnalysis& analysis);

}  // namespace docent

#endif  // DOCENT_KB_SERVER_SUBSCRIPTIONS_FOLLOWED_FORM_H_
