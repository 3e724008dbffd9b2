// Operators of Join, LeftJoin and Minus (SPARQL 1.1 section 18.5), each as a loop over the left rows (the
// right side is started for each) and by hash (the right side is run once, from the base row, and kept).
#include <algorithm>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/sparql/run/expression_evaluator.h"
#include "graph/sparql/run/operators.h"
#include "graph/sparql/run/row_set.h"

namespace docent::sparql {

using Kind = PlanNode::Kind;

namespace {

class LoopJoin final : public Operator {
 public:
  LoopJoin(PlanNode& node, const BuildContext& build)
      : node_(node),
        context_(*build.context),
        left_(BuildOperator(*node.children[0], build)),
        right_(BuildOperator(*node.children[1], build)),
        row_(build.slots) {
    if (node.expression) PrepareExpression(*node.expression, build);
  }
  void Start(const TermId* in) override {
    left_->Start(in);
    running_ = false;
  }
  bool Next(TermId* out) override {
    const bool optional = node_.kind == Kind::kLeftJoin;
    while (context_.Poll()) {
      if (!running_) {
        if (!left_->Next(row_.data())) return false;
        right_->Start(row_.data());
        running_ = true;
        matched_ = false;
      }
      while (right_->Next(out)) {
        if (node_.expression && !Passes(*node_.expression, out, context_)) continue;
        matched_ = true;
        return true;
      }
      running_ = false;
      if (optional && !matched_ && context_.status.ok()) {
        std::copy(row_.begin(), row_.end(), out);
        return true;
      }
    }
    return false;
  }
  void Forget() override {
    left_->Forget();
    right_->Forget();
    if (node_.expression) ForgetExpression(*node_.expression);
  }

 private:
  PlanNode& node_;
  EvaluationContext& context_;
  std::unique_ptr<Operator> left_, right_;
  std::vector<TermId> row_;
  bool running_ = false;
  bool matched_ = false;
};

class LoopMinus final : public Operator {
 public:
  LoopMinus(PlanNode& node, const BuildContext& build)
      : context_(*build.context),
        left_(BuildOperator(*node.children[0], build)),
        right_(BuildOperator(*node.children[1], build)),
        in_(build.slots),
        scratch_(build.slots),
        shared_(node.children[0]->possible.And(node.children[1]->possible).List()),
        base_(build.base) {}
  void Start(const TermId* in) override { left_->Start(in); }
  bool Next(TermId* out) override {
    while (left_->Next(out)) {
      if (!context_.Poll()) return false;
      std::copy(base_, base_ + in_.size(), in_.begin());
      for (const int slot : shared_) in_[slot] = out[slot];
      right_->Start(in_.data());
      if (!right_->Next(scratch_.data())) return context_.status.ok();
    }
    return false;
  }
  void Forget() override {
    left_->Forget();
    right_->Forget();
  }

 private:
  EvaluationContext& context_;
  std::unique_ptr<Operator> left_, right_;
  std::vector<TermId> in_, scratch_;
  std::vector<int> shared_;
  const TermId* base_;
};

// Kept rows of a plan that ran from the base row, indexed by the slots that both sides bind for certain.
class RowTable {
 public:
  RowTable(PlanNode& node, const SlotSet& left_certain, const BuildContext& build)
      : context_(*build.context),
        operator_(BuildOperator(node, build)),
        width_(build.slots),
        base_(build.base),
        columns_(node.possible.List()),
        keys_(left_certain.And(node.certain).List()),
        depends_on_(node.mentions.List()) {}

  // Runs the plan unless the rows for this base are already kept.
  void Fill() {
    std::vector<TermId> now;
    now.reserve(depends_on_.size());
    for (const int slot : depends_on_) now.push_back(base_[slot]);
    if (filled_ && now == filled_for_) return;
    filled_ = true;
    filled_for_ = std::move(now);
    Clear();
    kept_.LetGo(context_);
    std::vector<TermId> row(width_);
    operator_->Start(base_);
    while (operator_->Next(row.data()) && context_.Poll() &&
           kept_.Add(kBytesOfRow + (2 * columns_.size() + keys_.size()) * sizeof(TermId), context_)) {
      by_key_[KeyOf(row.data())].push_back(
          static_cast<uint32_t>(rows_.size() / std::max<size_t>(columns_.size(), 1)));
      for (const int slot : columns_) rows_.push_back(row[slot]);
      if (columns_.empty()) rows_.push_back(TermId());
    }
    if (!context_.status.ok()) filled_ = false;
  }
  // The numbers of the rows with the same key as `row`.
  const std::vector<uint32_t>* Find(const TermId* row) const {
    const auto it = by_key_.find(KeyOf(row));
    return it == by_key_.end() ? nullptr : &it->second;
  }
  // Merges row number `index` with `left` into `out`; false if they are not compatible.
  bool Merge(uint32_t index, const TermId* left, TermId* out) const {
    const TermId* values = RowAt(index);
    std::copy(left, left + width_, out);
    for (size_t i = 0; i < columns_.size(); ++i) {
      TermId& slot = out[columns_[i]];
      if (values[i].IsNone()) continue;
      if (!slot.IsNone() && slot != values[i]) return false;
      slot = values[i];
    }
    return true;
  }
  // True if the rows are compatible and share a variable of `dom` (section 18.5, Minus).
  bool SharesAndFits(uint32_t index, const TermId* left, const SlotSet& dom) const {
    const TermId* values = RowAt(index);
    bool shares = false;
    for (size_t i = 0; i < columns_.size(); ++i) {
      const TermId here = left[columns_[i]];
      if (values[i].IsNone() || here.IsNone() || !dom.Contains(columns_[i])) continue;
      if (here != values[i]) return false;
      shares = true;
    }
    return shares;
  }
  void Forget() {
    filled_ = false;
    Clear();
    operator_->Forget();
  }

 private:
  static constexpr size_t kBytesOfRow = 192;  // in the table, with a key of its own

  void Clear() {
    Empty(&rows_);
    by_key_.clear();
  }
  const TermId* RowAt(uint32_t index) const {
    return rows_.data() + index * std::max<size_t>(columns_.size(), 1);
  }
  std::vector<TermId> KeyOf(const TermId* row) const {
    std::vector<TermId> key;
    key.reserve(keys_.size());
    for (const int slot : keys_) key.push_back(row[slot]);
    return key;
  }

  EvaluationContext& context_;
  std::unique_ptr<Operator> operator_;
  size_t width_;
  const TermId* base_;
  std::vector<int> columns_, keys_, depends_on_;
  std::vector<TermId> rows_;  // columns_.size() (at least 1) each
  absl::flat_hash_map<std::vector<TermId>, std::vector<uint32_t>> by_key_;
  std::vector<TermId> filled_for_;
  KeptMemory kept_;
  bool filled_ = false;
};

class HashJoin final : public Operator {
 public:
  HashJoin(PlanNode& node, const BuildContext& build)
      : node_(node),
        context_(*build.context),
        left_(BuildOperator(*node.children[0], build)),
        table_(*node.children[1], node.children[0]->certain, build),
        row_(build.slots) {
    if (node.expression) PrepareExpression(*node.expression, build);
  }
  void Start(const TermId* in) override {
    left_->Start(in);
    running_ = false;
    filled_ = false;
  }
  bool Next(TermId* out) override {
    const bool optional = node_.kind == Kind::kHashLeftJoin;
    while (context_.Poll()) {
      if (!running_) {
        if (!left_->Next(row_.data())) return false;
        if (!filled_) {
          table_.Fill();
          filled_ = true;
          if (!context_.status.ok()) return false;
        }
        candidates_ = table_.Find(row_.data());
        next_ = 0;
        running_ = true;
        matched_ = false;
      }
      while (candidates_ != nullptr && next_ < candidates_->size() && context_.Poll()) {
        if (!table_.Merge((*candidates_)[next_++], row_.data(), out)) continue;
        if (node_.expression && !Passes(*node_.expression, out, context_)) continue;
        matched_ = true;
        ++context_.row_number;
        return true;
      }
      running_ = false;
      if (optional && !matched_ && context_.status.ok()) {
        std::copy(row_.begin(), row_.end(), out);
        return true;
      }
    }
    return false;
  }
  void Forget() override {
    left_->Forget();
    table_.Forget();
    if (node_.expression) ForgetExpression(*node_.expression);
  }

 private:
  PlanNode& node_;
  EvaluationContext& context_;
  std::unique_ptr<Operator> left_;
  RowTable table_;
  std::vector<TermId> row_;
  const std::vector<uint32_t>* candidates_ = nullptr;
  size_t next_ = 0;
  bool running_ = false, matched_ = false, filled_ = false;
};

class HashMinus final : public Operator {
 public:
  HashMinus(PlanNode& node, const BuildContext& build)
      : context_(*build.context),
        left_(BuildOperator(*node.children[0], build)),
        table_(*node.children[1], node.children[0]->certain, build),
        dom_(node.children[0]->possible) {}
  void Start(const TermId* in) override {
    left_->Start(in);
    filled_ = false;
  }
  bool Next(TermId* out) override {
    while (left_->Next(out) && context_.Poll()) {
      if (!filled_) {
        table_.Fill();
        filled_ = true;
        if (!context_.status.ok()) return false;
      }
      const std::vector<uint32_t>* candidates = table_.Find(out);
      bool removed = false;
      for (size_t i = 0; candidates != nullptr && !removed && i < candidates->size() && context_.Poll();
           ++i) {
        removed = table_.SharesAndFits((*candidates)[i], out, dom_);
      }
      if (!removed) return context_.status.ok();
    }
    return false;
  }
  void Forget() override {
    left_->Forget();
    table_.Forget();
  }

 private:
  EvaluationContext& context_;
  std::unique_ptr<Operator> left_;
  RowTable table_;
  SlotSet dom_;
  bool filled_ = false;
};

}  // namespace

std::unique_ptr<Operator> BuildJoin(PlanNode& node, const BuildContext& build) {
  return std::make_unique<LoopJoin>(node, build);
}

std::unique_ptr<Operator> BuildHashJoin(PlanNode& node, const BuildContext& build) {
  return std::make_unique<HashJoin>(node, build);
}

std::unique_ptr<Operator> BuildMinus(PlanNode& node, const BuildContext& build) {
  if (node.kind == Kind::kMinus) return std::make_unique<LoopMinus>(node, build);
  return std::make_unique<HashMinus>(node, build);
}

}  // namespace docent::sparql
