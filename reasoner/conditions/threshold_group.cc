#include "reasoner/conditions/threshold_group.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "reasoner/matching/comparison_form.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent::conditions {
namespace {

using sparql::Algebra;
using sparql::Expression;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Expression::Kind KindOf(matching::Comparison op) {
  switch (op) {
    case matching::Comparison::kLess:
      return Expression::Kind::kLess;
    case matching::Comparison::kLessOrEqual:
      return Expression::Kind::kLessOrEqual;
    case matching::Comparison::kGreater:
      return Expression::Kind::kGreater;
    case matching::Comparison::kGreaterOrEqual:
      return Expression::Kind::kGreaterOrEqual;
  }
  return Expression::Kind::kLess;
}

// ?variable op number, in either order.
bool ReadThreshold(const Expression& expression, ThresholdForm& form) {
  const std::optional<matching::NumberComparison> comparison = matching::ReadNumberComparison(expression);
  if (!comparison || !comparison->op) return false;
  form.variable = comparison->variable->name;
  form.op = *comparison->op;
  form.constant = *comparison->number;
  return true;
}

bool MayBeNumber(const Term& term) {
  return term.IsLiteral() && term.language.empty() && !term.datatype.empty() &&
         term.datatype != kXsdBoolean && term.datatype != kXsdDate && term.datatype != kXsdDateTime;
}

}  // namespace

std::optional<ThresholdForm> SplitThreshold(const sparql::Query& query) {
  if (!query.from.empty() || !query.from_named.empty()) return std::nullopt;
  std::vector<const Expression*> conjuncts;
  const Algebra* base = &matching::WithoutModifiers(*query.algebra);
  for (; base->kind == Algebra::Kind::kFilter; base = base->children[0].get()) {
    sparql::CollectConjuncts(*base->expression, conjuncts);
  }
  ThresholdForm form;
  std::vector<const Expression*> others;
  for (const Expression* conjunct : conjuncts) {
    if (!ReadThreshold(*conjunct, form)) others.push_back(conjunct);
  }
  if (conjuncts.size() != others.size() + 1) return std::nullopt;
  if (form.variable.starts_with('.') || !matching::CertainVariables(*base).contains(form.variable))
    return std::nullopt;
  form.shared.form = sparql::Query::Form::kAsk;
  form.shared.algebra = base->Clone();
  for (const Expression* other : others) {
    auto filter = std::make_unique<Algebra>(Algebra::Kind::kFilter);
    filter->children.push_back(std::move(form.shared.algebra));
    filter->expression = other->Clone();
    form.shared.algebra = std::move(filter);
  }
  return form;
}

absl::StatusOr<bool> NumberComparer::Compare(TermId left, matching::Comparison op, TermId right,
                                             const sparql::RunOptions& run) {
  if (const std::optional<bool> decided = matching::CompareNumbers(left, op, right)) return *decided;
  auto& prepared = expressions_[static_cast<size_t>(op)];
  if (!prepared) {
    Expression expression(KindOf(op), {});
    for (const char* name : {"a", "b"}) {
      expression.arguments.push_back(std::make_unique<Expression>(Expression::Kind::kVariable, SourceSpan{}));
      expression.arguments.back()->variable.name = name;
    }
    auto made = sparql::PreparedExpression::Prepare(expression, {"a", "b"}, dictionary_);
    if (!made.ok()) return made.status();
    prepared = *std::move(made);
  }
  const std::array<TermId, 2> row = {left, right};
  return prepared->Test(run, row);
}

ThresholdGroup::ThresholdGroup(bool above, const Dictionary& dictionary, NumberComparer& comparer)
    : above_(above),
      dictionary_(dictionary),
      comparer_(comparer),
      settled_extreme_(above ? -kInfinity : kInfinity) {}

void ThresholdGroup::SetKey(TermId key, bool present) {
  const matching::NumberView view = matching::ViewNumber(key);
  if (view.kind == matching::NumberView::Kind::kNumber) {
    if (present) {
      numbers_.emplace(view.value, key);
    } else {
      numbers_.erase({view.value, key});
    }
  } else if (view.kind == matching::NumberView::Kind::kUnknown && !key.IsNone() &&
             MayBeNumber(dictionary_.Decode(key))) {
    const bool changed = present ? irregular_.insert(key).second : irregular_.erase(key) > 0;
    irregular_changed_ = irregular_changed_ || changed;
  }
}

double ThresholdGroup::Extreme() const {
  if (numbers_.empty()) return above_ ? -kInfinity : kInfinity;
  return above_ ? numbers_.rbegin()->first : numbers_.begin()->first;
}

absl::StatusOr<bool> ThresholdGroup::LevelOf(const Place& place, const Member& member, double extreme,
                                             const sparql::RunOptions& run) const {
  if (above_ ? extreme > place.first : extreme < place.first) return true;
  if (extreme == place.first) {
    // Equal as doubles: each such value is compared exactly.
    for (auto it = numbers_.lower_bound({extreme, TermId()}); it != numbers_.end() && it->first == extreme;
         ++it) {
      const absl::StatusOr<bool> holds = comparer_.Compare(it->second, member.op, member.constant, run);
      if (!holds.ok() || *holds) return holds;
    }
  }
  for (const TermId key : irregular_) {
    const absl::StatusOr<bool> holds = comparer_.Compare(key, member.op, member.constant, run);
    if (!holds.ok() || *holds) return holds;
  }
  return false;
}

absl::Status ThresholdGroup::AddMember(ConditionId id, matching::Comparison op, TermId constant,
                                       const sparql::RunOptions& run) {
  const Place place = PlaceOf(id, constant);
  Member member{op, constant, false};
  const absl::StatusOr<bool> level = LevelOf(place, member, Extreme(), run);
  if (!level.ok()) return level.status();
  member.level = *level;
  members_.emplace(place, member);
  settled_at_.reset();
  return absl::OkStatus();
}

void ThresholdGroup::RemoveMember(ConditionId id, TermId constant) {
  members_.erase(PlaceOf(id, constant));
  settled_at_.reset();
}

bool ThresholdGroup::Holds(ConditionId id, TermId constant) const {
  const auto found = members_.find(PlaceOf(id, constant));
  return found != members_.end() && found->second.level;
}

absl::StatusOr<bool> ThresholdGroup::Admits(ConditionId id, TermId constant, TermId value,
                                            const sparql::RunOptions& run) const {
  const auto found = members_.find(PlaceOf(id, constant));
  if (found == members_.end()) return false;
  return comparer_.Compare(value, found->second.op, constant, run);
}

ThresholdGroup::Members::iterator ThresholdGroup::FirstFrom(double low) {
  if (!settled_at_ || low == -kInfinity) return members_.lower_bound({low, ConditionId()});
  Members::iterator it = *settled_at_;
  while (low < settled_extreme_ && it != members_.begin()) {
    const Members::iterator before = std::prev(it);
    if (before->first.first < low) break;
    it = before;
  }
  return it;
}

absl::Status ThresholdGroup::Relevel(const sparql::RunOptions& run,
                                     absl::FunctionRef<void(ConditionId, bool level)> visit) {
  const double extreme = Extreme();
  const double low = irregular_changed_ ? -kInfinity : std::min(extreme, settled_extreme_);
  const double high = irregular_changed_ ? kInfinity : std::max(extreme, settled_extreme_);
  Members::iterator it = FirstFrom(low);
  Members::iterator settled_at = it;
  while (it != members_.end() && it->first.first <= high) {
    auto& [place, member] = *it++;
    if (place.first < extreme) settled_at = it;
    const absl::StatusOr<bool> level = LevelOf(place, member, extreme, run);
    if (!level.ok()) return level.status();
    if (*level == member.level) continue;
    member.level = *level;
    visit(place.second, *level);
  }
  settled_extreme_ = extreme;
  settled_at_ = settled_at;
  irregular_changed_ = false;
  return absl::OkStatus();
}

}  // namespace docent::conditions
