// ORDER BY (SPARQL 1.1 section 15.1). Variable keys are compared by id if that decides the order. With a
// limit, somewhat more rows than needed are kept and then cut to the first ones. A row thus costs a few
// comparisons in any input order, and a row after the last kept one little more than a look at its first key.
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

// Surplus that may be kept before a cut: this many rows and bytes of keys, or half of the size of the first
// rows, so that the cost of a cut is shared by a proportional number of rows.
constexpr size_t kSurplusRows = 64;
constexpr size_t kSurplusBytes = 64 << 10;
constexpr size_t kBytesOfPlace = 48;  // of a row in the lists of rows, and of its allocation

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
    // Empty until one is needed. Values of variables are computed only if their ids do not decide the order.
    std::vector<Value> keys;
    uint64_t number = 0;  // equal rows keep their order
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
    Row* last = nullptr;  // of the first rows; rows after it are not kept
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
    // A cancelled sort continues with "all equal", which ends it soon and is safe for a merge sort.
    std::stable_sort(rows_.begin(), rows_.end(),
                     [&](Row* a, Row* b) { return context_.Poll() && Before(*a, *b); });
  }

  // Keeps only the first rows, as many as are needed. Returns the last of them.
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

  // Counts the keys that a kept row has got since.
  bool CountKeys(Row& row) {
    if (row.keys.empty()) return true;
    size_t bytes = row.keys.size() * sizeof(Value);
    for (const Value& key : row.keys) bytes += key.owned_bytes();
    surplus_bytes_ += bytes - row.counted;
    return kept_.Add(bytes - std::exchange(row.counted, bytes), context_);
  }

  // Drops the keys of a row and releases their memory; the key slots themselves stay with the row.
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
    kept_.Add(sizeof(Row) + kBytesOfPlace + width_ * sizeof(TermId),
              context_);  // beyond the limit: the next Poll fails
    return &row;
  }

  void EvaluateKey(Row& row, size_t i) {
    if (row.keys.empty()) row.keys.resize(keys_.size());
    row.keys[i] = Evaluate(*keys_[i].expression, row.slots.data(), context_);
  }

  // Evaluates all keys except those of variables.
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

  // Compares one key: negative if `a` comes first.
  int CompareKeys(Row& a, Row& b, size_t i) {
    const Key& key = keys_[i];
    const auto by_ids = key.slot >= 0
                            ? CompareForOrder(a.slots[key.slot], b.slots[key.slot], context_.dictionary)
                            : std::nullopt;
    const int order = by_ids ? *by_ids : CompareForOrder(KeyOf(a, i), KeyOf(b, i));
    return key.descending ? -order : order;
  }

  // As Before, for a row without keys that usually comes after `last`; evaluates its keys if it comes before.
  // Mostly the first key decides.
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
  // Compares the further keys if the first does not decide.
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
  std::vector<Row*> spare_;   // unused rows of memory_
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
