// ORDER BY (SPARQL 1.1 section 15.1). Keys that are variables are compared by their ids where these tell the order; with a
// limit, some more rows than the first ones are kept, then all but the first cut off, so that a row costs a few comparisons
// in whatever order they come, and one that comes after the first little more than a look at its first key.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "graph/sparql/run/expression_evaluator.h"
#include "graph/sparql/run/operators.h"
#include "graph/sparql/run/row_set.h"
#include "graph/sparql/values/number.h"
#include "graph/sparql/values/value.h"

namespace docent::sparql {
namespace {

// What may be kept beyond the first rows before these are chosen: so many rows and so many bytes of keys, or half of what the
// first have, so that what a cut costs is shared by rows in proportion.
constexpr size_t kSurplusRows = 64;
constexpr size_t kSurplusBytes = 64 << 10;

class OrderByOperator final : public Operator {
 public:
  OrderByOperator(PlanNode& node, const BuildContext& build)
      : node_(node),
        context_(*build.context),
        width_(build.slots),
        child_(BuildOperator(*node.children[0], build)) {
    for (auto& [expression, descending] : node.order) {
      PrepareExpression(*expression, build);
      const bool variable = expression->kind == Expression::Kind::kVariable;
      keys_.push_back({expression.get(), variable ? expression->slot : -1, descending});
    }
  }
  void Start(const TermId* in) override {
    Clear();
    kept_.LetGo(context_);
    next_ = 0;
    sorted_ = false;
    child_->Start(in);
  }
  bool Next(TermId* out) override {
    if (!sorted_) Sort();
    if (next_ >= rows_.size() || !context_.Poll()) return false;
    const Row& row = *rows_[next_++];
    std::copy(row.slots.begin(), row.slots.end(), out);
    return true;
  }
  void Forget() override {
    Clear();
    child_->Forget();
    for (auto& [expression, descending] : node_.order) ForgetExpression(*expression);
  }

 private:
  struct Key {
    PlanExpression* expression;
    int slot;  // negative: no variable
    bool descending;
  };
  struct Row {
    std::vector<TermId> slots;
    // Empty until one is needed. Those of variables are evaluated when their ids do not tell the order.
    std::vector<Value> keys;
    uint64_t number = 0;  // rows that are equal keep their order
    size_t counted = 0;   // bytes of keys, in kept_
    bool stays = false;   // it is in rows_
  };

  void Clear() {
    Empty(&rows_);
    Empty(&spare_);
    memory_.clear();
    surplus_bytes_ = first_bytes_ = 0;
  }

  void Sort() {
    sorted_ = true;
    if (node_.limit == uint64_t{0}) return;
    const size_t most =
        node_.limit ? *node_.limit + std::max<size_t>(kSurplusRows, *node_.limit / 2) : ~size_t{0};
    Row* last = nullptr;  // of the first rows; those that come after it need not be kept
    Row* row = NewRow();
    for (uint64_t number = 0; child_->Next(row->slots.data()) && context_.Poll(); ++number) {
      row->number = number;
      if (last != nullptr && !GoesBefore(*row, *last)) {
        ForgetKeys(*row);
        continue;
      }
      if (last == nullptr) EvaluateKeys(*row, 0);
      if (!CountKeys(*row)) return;
      row->stays = true;
      rows_.push_back(row);
      const bool full = rows_.size() >= most || surplus_bytes_ > std::max(kSurplusBytes, first_bytes_ / 2);
      if (node_.limit && rows_.size() > *node_.limit && full) last = Cut();
      row = NewRow();
    }
    if (node_.limit && rows_.size() > *node_.limit) Cut();
    // A cancelled sort goes on with "all equal", which ends it soon and is safe for a merge sort.
    std::stable_sort(rows_.begin(), rows_.end(),
                     [&](Row* a, Row* b) { return context_.Poll() && Before(*a, *b); });
  }

  // Only the first rows, as many as are asked for, stay. Their last.
  Row* Cut() {
    const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(*node_.limit);
    std::nth_element(rows_.begin(), end - 1, rows_.end(), [this](Row* a, Row* b) { return Before(*a, *b); });
    for (auto it = end; it != rows_.end(); ++it) {
      ForgetKeys(**it);
      (*it)->stays = false;
      spare_.push_back(*it);
    }
    rows_.erase(end, rows_.end());
    surplus_bytes_ = 0;
    first_bytes_ = 0;
    for (const Row* row : rows_) first_bytes_ += row->counted;
    return rows_.back();
  }

  // Of a row that stays, the keys that it has got since.
  bool CountKeys(Row& row) {
    if (row.keys.empty()) return true;
    size_t bytes = row.keys.size() * sizeof(Value);
    for (const Value& key : row.keys) bytes += key.owned_bytes();
    surplus_bytes_ += bytes - row.counted;
    return kept_.Add(bytes - std::exchange(row.counted, bytes), context_);
  }

  // A row whose keys go, and with them what was counted of them but for their places, which stay with the row.
  void ForgetKeys(Row& row) {
    for (Value& key : row.keys) key = Value();
    const size_t places = std::min(row.counted, row.keys.size() * sizeof(Value));
    if (row.counted > places) kept_.LetGo(row.counted - places, context_);
    row.counted = places;
  }

  Row* NewRow() {
    if (!spare_.empty()) {
      Row* const row = spare_.back();
      spare_.pop_back();
      return row;
    }
    Row& row = memory_.emplace_back();
    row.slots.resize(width_);
    kept_.Add(sizeof(Row) + width_ * sizeof(TermId), context_);  // beyond the limit, the next Poll tells
    return &row;
  }

  void EvaluateKey(Row& row, size_t i) {
    if (row.keys.empty()) row.keys.resize(keys_.size());
    row.keys[i] = Evaluate(*keys_[i].expression, row.slots.data(), context_);
  }

  // All but those of variables.
  void EvaluateKeys(Row& row, size_t from) {
    for (size_t i = from; i < keys_.size(); ++i) {
      if (keys_[i].slot < 0) EvaluateKey(row, i);
    }
  }

  const Value& KeyOf(Row& row, size_t i) {
    if (keys_[i].slot >= 0 && (row.keys.empty() || row.keys[i].IsError())) {
      EvaluateKey(row, i);
      if (row.stays) CountKeys(row);
    }
    return row.keys[i];
  }

  // By one key: negative where `a` stands first.
  int CompareKeys(Row& a, Row& b, size_t i) {
    const Key& key = keys_[i];
    const auto by_ids = key.slot >= 0
                            ? CompareForOrder(a.slots[key.slot], b.slots[key.slot], context_.dictionary)
                            : std::nullopt;
    const int order = by_ids ? *by_ids : CompareForOrder(KeyOf(a, i), KeyOf(b, i));
    return key.descending ? -order : order;
  }

  // The same as Before, of a row without keys that comes after `last`; it gets them if it goes before. Most do not, and the
  // first key tells.
  bool GoesBefore(Row& row, Row& last) {
    for (size_t i = 0; i < keys_.size(); ++i) {
      if (keys_[i].slot < 0) EvaluateKey(row, i);
      const int order = CompareKeys(row, last, i);
      if (order == 0) continue;
      if (order < 0) EvaluateKeys(row, i + 1);
      return order < 0;
    }
    return false;
  }

  bool Before(Row& a, Row& b) {
    const int order = CompareKeys(a, b, 0);
    return order != 0 ? order < 0 : BeforeByMore(a, b);
  }
  // Where the first key does not tell.
  bool BeforeByMore(Row& a, Row& b) {
    for (size_t i = 1; i < keys_.size(); ++i) {
      if (const int order = CompareKeys(a, b, i)) return order < 0;
    }
    return a.number < b.number;
  }

  PlanNode& node_;
  EvaluationContext& context_;
  std::vector<Key> keys_;
  size_t width_;
  std::unique_ptr<Operator> child_;
  std::deque<Row> memory_;
  KeptMemory kept_;
  std::vector<Row*> rows_;
  std::vector<Row*> spare_;   // rows of memory_ to be used again
  size_t surplus_bytes_ = 0;  // of keys, counted since the last cut
  size_t first_bytes_ = 0;    // of the keys of the first rows, at the last cut
  size_t next_ = 0;
  bool sorted_ = false;
};

}  // namespace

std::unique_ptr<Operator> BuildOrderBy(PlanNode& node, const BuildContext& build) {
  return std::make_unique<OrderByOperator>(node, build);
}

}  // namespace docent::sparql
