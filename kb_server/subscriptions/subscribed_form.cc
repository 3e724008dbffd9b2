#include "kb_server/subscriptions/subscribed_form.h"

#include <algorithm>

#include "graph/sparql/syntax/algebra_walk.h"

namespace docent::server {
namespace {

using sparql::Algebra;

bool IsKeptOf(const Algebra& node, bool rows_count) {
  switch (node.kind) {
    case Algebra::Kind::kBgp:
    case Algebra::Kind::kJoin:
    case Algebra::Kind::kFilter:
    case Algebra::Kind::kMinus:
      return true;
    case Algebra::Kind::kUnion:
      return !rows_count;
    default:
      return false;
  }
}

// The Project and Distinct around the WHERE of a SELECT; `where` is what is left.
struct Outside {
  const Algebra* project = nullptr;
  bool distinct = false;
};

Outside OutsideOf(const Algebra& whole, const Algebra& where) {
  Outside outside;
  for (const Algebra* node = &whole; node != &where; node = node->children[0].get()) {
    if (node->kind == Algebra::Kind::kDistinct) outside.distinct = true;
    if (node->kind == Algebra::Kind::kProject) outside.project = node;
  }
  return outside;
}

}  // namespace

std::optional<SubscribedForm> SubscribedFormOf(const sparql::Query& query,
                                               const matching::TriggerAnalysis& analysis) {
  const Algebra& where = matching::WithoutModifiers(*query.algebra);
  const bool select = query.form == sparql::Query::Form::kSelect;
  if (!query.from.empty() || !query.from_named.empty() || analysis.is_volatile) return std::nullopt;
  const Outside outside = OutsideOf(*query.algebra, where);
  if (select && outside.project == nullptr) return std::nullopt;
  const bool rows_count = select && !outside.distinct;
  if (sparql::AnyNode(where, [&](const Algebra& node) { return !IsKeptOf(node, rows_count); }))
    return std::nullopt;
  SubscribedForm form;
  if (!select) return form;
  const absl::flat_hash_set<std::string> certain = matching::CertainVariables(where);
  if (rows_count) {
    form.keys.assign(certain.begin(), certain.end());
    std::sort(form.keys.begin(), form.keys.end());
  }
  for (const sparql::Variable& variable : outside.project->variables) {
    if (!certain.contains(variable.name)) return std::nullopt;
    auto place = std::find(form.keys.begin(), form.keys.end(), variable.name);
    if (place == form.keys.end()) place = form.keys.insert(place, variable.name);
    form.columns.push_back(static_cast<size_t>(place - form.keys.begin()));
  }
  if (form.keys.empty()) return std::nullopt;
  return form;
}

std::vector<SubscriptionAnswer::Row> SubscribedForm::RowsOf(
    const std::vector<conditions::Binding>& bindings) const {
  std::vector<SubscriptionAnswer::Row> rows;
  for (const conditions::Binding& binding : bindings) {
    SubscriptionAnswer::Row& row = rows.emplace_back();
    for (const size_t column : columns) row.push_back(binding[column].second);
  }
  return rows;
}

}  // namespace docent::server
