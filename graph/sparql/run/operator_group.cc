// GROUP BY with aggregates (SPARQL 1.1 section 18.5.1).
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "graph/sparql/run/expression_evaluator.h"
#include "graph/sparql/run/operators.h"
#include "graph/sparql/run/row_set.h"
#include "graph/sparql/values/decimal_sum.h"
#include "graph/sparql/values/exact_sum.h"

namespace docent::sparql {

using Function = Aggregate::Function;

namespace {

// One aggregate of one group. COUNT, SUM, AVG, MIN and MAX give the same term for any order of rows: the
// rules retract a total by computing it again.
class Accumulator {
 public:
  void Add(PlanNode::AggregatePlan& plan, const TermId* row, const std::vector<TermId>& whole_row,
           EvaluationContext& context, KeptMemory& kept) {
    if (!plan.expression) {  // COUNT(*)
      if (plan.distinct && !Unseen(whole_row.data(), whole_row.size(), context, kept)) return;
      ++count_;
      return;
    }
    const bool variable = plan.expression->kind == Expression::Kind::kVariable;
    if (variable && AddId(plan, row[plan.expression->slot], context, kept)) return;
    Value value = Evaluate(*plan.expression, row, context);
    if (value.IsError()) {  // of an unbound or wrong value: the aggregate is an error, but for COUNT and
                            // SAMPLE
      error_ |= plan.function != Function::kCount && plan.function != Function::kSample;
      return;
    }
    if (plan.distinct) {
      const TermId id = context.Encode(value);
      if (!Unseen(&id, 1, context, kept)) return;
    }
    ++count_;
    switch (plan.function) {
      case Function::kCount:
        break;
      case Function::kSum:
      case Function::kAvg:
        if (value.type() == Value::Type::kFloat || value.type() == Value::Type::kDouble) {
          inexact_.Add(value.number());
          widest_ = std::max(widest_, value.type());
        } else {
          AddExact(value);
        }
        break;
      case Function::kMin:
        if (best_.IsError() || Order(value, best_) < 0) TakeBest(std::move(value), context, kept);
        break;
      case Function::kMax:
        if (best_.IsError() || Order(value, best_) > 0) TakeBest(std::move(value), context, kept);
        break;
      case Function::kSample:
        if (best_.IsError()) TakeBest(std::move(value), context, kept);
        break;
      case Function::kGroupConcat: {
        if (value.type() == Value::Type::kBlank) {
          error_ = true;
          return;
        }
        std::string scratch;
        const std::string_view text = context.LexicalOf(value, &scratch);
        if (!context.Worked(text.size()) || !GrowText(plan.separator.size() + text.size(), context, kept))
          break;
        if (count_ > 1) text_ += plan.separator;
        text_ += text;
        break;
      }
    }
  }

  // Adds `rows` rows, for an aggregate of CountsRows.
  void AddRows(uint64_t rows) { count_ += static_cast<int64_t>(rows); }

  // Bytes of the text of a GROUP_CONCAT that are counted. Once.
  size_t TakeTextBytes() { return std::exchange(text_bytes_, 0); }
  // Once.
  Value TakeResult(const PlanNode::AggregatePlan& plan) {
    if (plan.function == Function::kCount) return Value::Integer(count_);
    if (error_) return Value::Error();
    switch (plan.function) {
      case Function::kSum:
        return Sum();
      case Function::kAvg:
        return count_ == 0 ? Value::Integer(0) : Compute(Arithmetic::kDivide, Sum(), Value::Integer(count_));
      case Function::kGroupConcat:
        return Value::String(std::move(text_));
      default:
        return best_;
    }
  }

 private:
  // Makes room for more text: while it grows, the old one is there, too. False: beyond the memory of the query.
  bool GrowText(size_t bytes, EvaluationContext& context, KeptMemory& kept) {
    const size_t old = text_.capacity();
    if (text_.size() + bytes <= old) return true;
    const size_t grown = std::max(text_.size() + bytes, 2 * old);
    if (!kept.Add(grown, context)) return false;
    text_.reserve(grown);
    kept.LetGo(std::exchange(text_bytes_, grown), context);
    return true;
  }
  void TakeBest(Value value, EvaluationContext& context, KeptMemory& kept) {
    if (best_.owned_bytes() > 0) kept.LetGo(best_.owned_bytes(), context);
    if (value.owned_bytes() > 0) kept.Add(value.owned_bytes(), context);
    best_ = std::move(value);
  }
  // Counts and sums of ids need no value. False: this aggregate needs the value.
  bool AddId(const PlanNode::AggregatePlan& plan, TermId id, EvaluationContext& context, KeptMemory& kept) {
    const bool counts = plan.function == Function::kCount && !id.IsNone();
    const bool sums = (plan.function == Function::kSum || plan.function == Function::kAvg) &&
                      id.tag() == TermId::Tag::kInteger;
    if (!counts && !sums) return false;
    int64_t sum = 0;
    if (sums && __builtin_add_overflow(integers_, InlineInteger(id), &sum)) return false;
    if (plan.distinct && !Unseen(&id, 1, context, kept)) return true;
    if (sums) integers_ = sum;
    ++count_;
    return true;
  }
  // A sum that does not fit into a value may do so again with the numbers that follow.
  void AddExact(const Value& value) {
    Value sum = Compute(Arithmetic::kAdd, sum_, value);
    if (sum.IsError() && sum_.IsExact() && value.IsExact()) {
      if (!beyond_) beyond_.emplace();
      beyond_->Add(sum_.decimal());
      const bool whole = sum_.type() == Value::Type::kInteger && value.type() == Value::Type::kInteger;
      sum = whole ? Value::Integer(value.decimal()) : Value::OfDecimal(value.decimal());
    }
    sum_ = std::move(sum);
  }
  Value ExactTotal() const {
    if (!beyond_ || sum_.IsError())
      return integers_ == 0 ? sum_ : Compute(Arithmetic::kAdd, sum_, Value::Integer(integers_));
    DecimalSum all = *beyond_;
    all.Add(sum_.decimal());
    all.Add(Decimal::Of(integers_));
    const std::optional<Decimal> total = all.Result();
    if (!total) return Value::Error();
    return sum_.type() == Value::Type::kInteger ? Value::Integer(*total) : Value::OfDecimal(*total);
  }
  Value Sum() const {
    const Value exact = ExactTotal();
    if (exact.IsError() || widest_ == Value::Type::kError) return exact;
    ExactSum all = inexact_;
    all.Add(exact.AsDouble());
    return widest_ == Value::Type::kFloat ? Value::Float(all.Result()) : Value::Double(all.Result());
  }
  // Orders equal values of different terms (1 and 1.0) by term.
  static int Order(const Value& a, const Value& b) {
    const int order = CompareForOrder(a, b);
    if (order != 0 || (!a.id().IsNone() && a.id() == b.id())) return order;
    if (a.type() == Value::Type::kString && b.type() == Value::Type::kString) return 0;
    const Term x = a.ToTerm(), y = b.ToTerm();
    return x < y ? -1 : y < x ? 1 : 0;
  }
  bool Unseen(const TermId* key, size_t width, EvaluationContext& context, KeptMemory& kept) {
    if (!seen_) seen_.emplace(width);
    if (!seen_->Insert(key).second) return false;
    kept.Add(2 * seen_->bytes_a_row(), context);
    return true;
  }

  int64_t count_ = 0;
  int64_t integers_ = 0;  // the sum of the inline integers
  bool error_ = false;
  Value sum_ = Value::Integer(0);             // of integers and decimals, without `beyond_`
  std::optional<DecimalSum> beyond_;          // where a sum on the way had too many digits
  ExactSum inexact_;                          // of floats and doubles
  Value::Type widest_ = Value::Type::kError;  // of these
  Value best_;
  std::string text_;
  size_t text_bytes_ = 0;  // counted
  std::optional<RowSet> seen_;
};

// True for COUNT(*), and for COUNT(?x) if ?x is bound in every row of `child`.
bool CountsRows(const PlanNode::AggregatePlan& plan, const PlanNode& child) {
  if (plan.function != Function::kCount || plan.distinct) return false;
  return !plan.expression || (plan.expression->kind == Expression::Kind::kVariable &&
                              child.certain.Contains(plan.expression->slot));
}

class GroupOperator final : public Operator {
 public:
  GroupOperator(PlanNode& node, const BuildContext& build)
      : node_(node),
        context_(*build.context),
        in_(build.slots),
        child_(BuildOperator(*node.children[0], build)),
        keys_(node.keys.size()),
        counts_(node.keys.empty() &&
                std::all_of(node.aggregates.begin(), node.aggregates.end(),
                            [&node](const auto& a) { return CountsRows(a, *node.children[0]); })) {
    for (auto& [slot, key] : node.keys) PrepareExpression(*key, build);
    for (auto& aggregate : node.aggregates) {
      if (aggregate.expression) PrepareExpression(*aggregate.expression, build);
      counts_rows_.push_back(CountsRows(aggregate, *node.children[0]));
    }
  }
  void Start(const TermId* in) override {
    std::copy(in, in + in_.size(), in_.begin());
    Clear();
    kept_.LetGo(context_);
    next_ = 0;
    collected_ = false;
  }
  bool Next(TermId* out) override {
    if (!collected_) Collect();
    while (next_ < groups_.size() && context_.Poll()) {
      std::copy(in_.begin(), in_.end(), out);
      const TermId* key = keys_.Row(static_cast<uint32_t>(next_));
      for (size_t i = 0; i < node_.keys.size(); ++i) out[node_.keys[i].first] = key[i];
      std::vector<Accumulator>& group = groups_[next_++];
      for (size_t i = 0; i < node_.aggregates.size(); ++i) {
        const Value value = group[i].TakeResult(node_.aggregates[i]);
        if (!value.IsError()) out[node_.aggregates[i].result] = context_.Encode(value);
        kept_.LetGo(group[i].TakeTextBytes(), context_);  // the text is a term now
      }
      ++context_.row_number;
      return context_.status.ok();
    }
    return false;
  }
  void Forget() override {
    Clear();
    child_->Forget();
    for (auto& [slot, key] : node_.keys) ForgetExpression(*key);
    for (auto& aggregate : node_.aggregates) {
      if (aggregate.expression) ForgetExpression(*aggregate.expression);
    }
  }

 private:
  void Clear() {
    Empty(&groups_);
    keys_.Clear();
  }

  void Collect() {
    collected_ = true;
    std::vector<TermId> row(in_.size()), key(node_.keys.size()), whole;
    child_->Start(in_.data());
    if (counts_) {
      const uint64_t rows = child_->Count(row.data());
      Accumulator* const totals = GroupOf(key);
      for (size_t i = 0; i < counts_rows_.size(); ++i) totals[i].AddRows(rows);
      return;
    }
    Accumulator* group = nullptr;  // of the row before: rows of a group are often adjacent in the index
    while (child_->Next(row.data()) && context_.Poll()) {
      for (size_t i = 0; i < key.size(); ++i)
        key[i] = EvaluateToId(*node_.keys[i].second, row.data(), context_);
      whole.clear();
      for (const int slot : node_.columns) whole.push_back(row[slot]);
      if (group == nullptr || !keys_.Is(last_, key.data())) group = GroupOf(key);
      for (size_t i = 0; i < counts_rows_.size(); ++i) {
        if (counts_rows_[i] != 0) {
          group[i].AddRows(1);
        } else {
          group[i].Add(node_.aggregates[i], row.data(), whole, context_, kept_);
        }
      }
    }
    // Without GROUP BY there is one group even for no rows (section 18.5.1, Group with a constant key).
    if (groups_.empty() && node_.keys.empty()) GroupOf(key);
  }

  // The group's accumulators, one for each aggregate.
  Accumulator* GroupOf(const std::vector<TermId>& key) {
    const auto [number, added] = keys_.Insert(key.data());
    last_ = number;
    if (added) {
      kept_.Add(64 + 2 * keys_.bytes_a_row() + node_.aggregates.size() * sizeof(Accumulator), context_);
      groups_.emplace_back(node_.aggregates.size());
    }
    return groups_[number].data();
  }

  PlanNode& node_;
  EvaluationContext& context_;
  std::vector<TermId> in_;
  std::unique_ptr<Operator> child_;
  RowSet keys_;                    // of the groups, by number
  std::vector<char> counts_rows_;  // each aggregate: CountsRows
  const bool counts_;              // only the number of rows matters
  std::vector<std::vector<Accumulator>> groups_;
  KeptMemory kept_;
  uint32_t last_ = 0;  // group of the last row
  size_t next_ = 0;
  bool collected_ = false;
};

}  // namespace

std::unique_ptr<Operator> BuildGroup(PlanNode& node, const BuildContext& build) {
  return std::make_unique<GroupOperator>(node, build);
}

}  // namespace docent::sparql
