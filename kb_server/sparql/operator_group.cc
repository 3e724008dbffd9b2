// GROUP BY with aggregates (SPARQL 1.1 section 18.5.1) and ORDER BY (section 15.1).
#include <algorithm>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "kb_server/sparql/expression_evaluator.h"
#include "kb_server/sparql/operators.h"

namespace docent::sparql {

using Function = Aggregate::Function;

namespace {

// One aggregate of one group.
class Accumulator {
 public:
  void Add(PlanNode::AggregatePlan& plan, const TermId* row, const std::vector<TermId>& whole_row,
           EvaluationContext& context) {
    if (!plan.expression) {  // COUNT(*)
      if (plan.distinct && !Unseen(whole_row, context)) return;
      ++count_;
      return;
    }
    Value value = Evaluate(*plan.expression, row, context);
    if (value.IsError()) {  // of an unbound or wrong value: the aggregate is an error, but for COUNT and
                            // SAMPLE
      error_ |= plan.function != Function::kCount && plan.function != Function::kSample;
      return;
    }
    if (plan.distinct && !Unseen({context.Encode(value)}, context)) return;
    ++count_;
    switch (plan.function) {
      case Function::kCount:
        break;
      case Function::kSum:
      case Function::kAvg:
        sum_ = Compute(Arithmetic::kAdd, sum_, value);
        break;
      case Function::kMin:
        if (best_.IsError() || CompareForOrder(value, best_) < 0) best_ = std::move(value);
        break;
      case Function::kMax:
        if (best_.IsError() || CompareForOrder(value, best_) > 0) best_ = std::move(value);
        break;
      case Function::kSample:
        if (best_.IsError()) best_ = std::move(value);
        break;
      case Function::kGroupConcat: {
        if (value.type() == Value::Type::kBlank) {
          error_ = true;
          return;
        }
        if (count_ > 1) text_ += plan.separator;
        const std::string text = context.LexicalOf(value);
        context.Charge(text.size() + plan.separator.size());
        text_ += text;
        break;
      }
    }
  }

  Value Result(const PlanNode::AggregatePlan& plan) const {
    if (plan.function == Function::kCount) return Value::Integer(count_);
    if (error_) return Value::Error();
    switch (plan.function) {
      case Function::kSum:
        return sum_;
      case Function::kAvg:
        return count_ == 0 ? Value::Integer(0) : Compute(Arithmetic::kDivide, sum_, Value::Integer(count_));
      case Function::kGroupConcat:
        return Value::String(text_);
      default:
        return best_;
    }
  }

 private:
  bool Unseen(std::vector<TermId> key, EvaluationContext& context) {
    if (!seen_.insert(std::move(key)).second) return false;
    context.Charge(64);
    return true;
  }

  int64_t count_ = 0;
  bool error_ = false;
  Value sum_ = Value::Integer(0);
  Value best_;
  std::string text_;
  absl::flat_hash_set<std::vector<TermId>> seen_;
};

class GroupOperator final : public Operator {
 public:
  GroupOperator(PlanNode& node, const BuildContext& build)
      : node_(node),
        context_(*build.context),
        in_(build.slots),
        child_(BuildOperator(*node.children[0], build)),
        all_(node.children[0]->possible.List()) {
    for (auto& [slot, key] : node.keys) PrepareExpression(*key, build);
    for (auto& aggregate : node.aggregates) {
      if (aggregate.expression) PrepareExpression(*aggregate.expression, build);
    }
  }
  void Start(const TermId* in) override {
    std::copy(in, in + in_.size(), in_.begin());
    groups_.clear();
    index_.clear();
    next_ = 0;
    collected_ = false;
  }
  bool Next(TermId* out) override {
    if (!collected_) Collect();
    while (next_ < groups_.size() && context_.Poll()) {
      Group& group = groups_[next_++];
      std::copy(in_.begin(), in_.end(), out);
      for (size_t i = 0; i < node_.keys.size(); ++i) out[node_.keys[i].first] = group.key[i];
      for (size_t i = 0; i < node_.aggregates.size(); ++i) {
        const Value value = group.accumulators[i].Result(node_.aggregates[i]);
        if (!value.IsError()) out[node_.aggregates[i].result] = context_.Encode(value);
      }
      ++context_.row_number;
      return context_.status.ok();
    }
    return false;
  }
  void Forget() override {
    child_->Forget();
    for (auto& [slot, key] : node_.keys) ForgetExpression(*key);
    for (auto& aggregate : node_.aggregates) {
      if (aggregate.expression) ForgetExpression(*aggregate.expression);
    }
  }

 private:
  struct Group {
    std::vector<TermId> key;
    std::vector<Accumulator> accumulators;
  };

  void Collect() {
    collected_ = true;
    std::vector<TermId> row(in_.size()), key(node_.keys.size()), whole;
    child_->Start(in_.data());
    while (child_->Next(row.data()) && context_.Poll()) {
      for (size_t i = 0; i < key.size(); ++i) {
        const Value value = Evaluate(*node_.keys[i].second, row.data(), context_);
        key[i] = value.IsError() ? TermId() : context_.Encode(value);
      }
      whole.clear();
      for (const int slot : all_) whole.push_back(row[slot]);
      Group& group = GroupOf(key);
      for (size_t i = 0; i < node_.aggregates.size(); ++i) {
        group.accumulators[i].Add(node_.aggregates[i], row.data(), whole, context_);
      }
    }
    // Without GROUP BY there is one group even of nothing (section 18.5.1, Group with a constant key).
    if (groups_.empty() && node_.keys.empty()) GroupOf({});
  }

  Group& GroupOf(const std::vector<TermId>& key) {
    const auto [it, added] = index_.emplace(key, groups_.size());
    if (added) {
      context_.Charge(128 + key.size() * 2 * sizeof(TermId) + node_.aggregates.size() * sizeof(Accumulator));
      groups_.push_back({key, std::vector<Accumulator>(node_.aggregates.size())});
    }
    return groups_[it->second];
  }

  PlanNode& node_;
  EvaluationContext& context_;
  std::vector<TermId> in_;
  std::unique_ptr<Operator> child_;
  std::vector<int> all_;
  std::vector<Group> groups_;
  absl::flat_hash_map<std::vector<TermId>, size_t> index_;
  size_t next_ = 0;
  bool collected_ = false;
};

class OrderByOperator final : public Operator {
 public:
  OrderByOperator(PlanNode& node, const BuildContext& build)
      : node_(node),
        context_(*build.context),
        width_(build.slots),
        child_(BuildOperator(*node.children[0], build)) {
    for (auto& [expression, descending] : node.order) PrepareExpression(*expression, build);
  }
  void Start(const TermId* in) override {
    rows_.clear();
    next_ = 0;
    sorted_ = false;
    child_->Start(in);
  }
  bool Next(TermId* out) override {
    if (!sorted_) Sort();
    if (next_ >= rows_.size() || !context_.Poll()) return false;
    const Row& row = rows_[next_++];
    std::copy(row.slots.begin(), row.slots.end(), out);
    return true;
  }
  void Forget() override {
    child_->Forget();
    for (auto& [expression, descending] : node_.order) ForgetExpression(*expression);
  }

 private:
  struct Row {
    std::vector<TermId> slots;
    std::vector<Value> keys;
  };

  void Sort() {
    sorted_ = true;
    Row row;
    row.slots.resize(width_);
    while (child_->Next(row.slots.data()) && context_.Poll()) {
      Row copy = row;
      for (auto& [expression, descending] : node_.order) {
        copy.keys.push_back(Evaluate(*expression, row.slots.data(), context_));
      }
      if (!context_.Charge(sizeof(Row) + width_ * sizeof(TermId) + copy.keys.size() * sizeof(Value))) return;
      rows_.push_back(std::move(copy));
    }
    // A cancelled sort goes on with "all equal", which ends it soon and is safe for the algorithm.
    std::stable_sort(rows_.begin(), rows_.end(), [this](const Row& a, const Row& b) {
      if (!context_.Poll()) return false;
      for (size_t i = 0; i < node_.order.size(); ++i) {
        const int order = CompareForOrder(a.keys[i], b.keys[i]);
        if (order != 0) return node_.order[i].second ? order > 0 : order < 0;
      }
      return false;
    });
  }

  PlanNode& node_;
  EvaluationContext& context_;
  size_t width_;
  std::unique_ptr<Operator> child_;
  std::vector<Row> rows_;
  size_t next_ = 0;
  bool sorted_ = false;
};

}  // namespace

std::unique_ptr<Operator> BuildGroup(PlanNode& node, const BuildContext& build) {
  return std::make_unique<GroupOperator>(node, build);
}

std::unique_ptr<Operator> BuildOrderBy(PlanNode& node, const BuildContext& build) {
  return std::make_unique<OrderByOperator>(node, build);
}

}  // namespace docent::sparql
