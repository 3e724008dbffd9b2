// Construction of operators from plan nodes, and the simple operators: filter, union, extend, values,
// distinct, slice.
#include "graph/sparql/run/operators.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "graph/sparql/run/expression_evaluator.h"
#include "graph/sparql/run/row_set.h"

namespace docent::sparql {

using Kind = PlanNode::Kind;

void PrepareExpression(PlanExpression& e, const BuildContext& build) {
  for (const PlanExpressionPtr& argument : e.arguments) PrepareExpression(*argument, build);
  if (!e.exists) return;
  if (!build.context->ChargePlan(2 * build.slots * sizeof(TermId))) return;
  e.exists_base.assign(build.slots, TermId());
  e.exists_row.assign(build.slots, TermId());
  e.exists_operator =
      BuildOperator(*e.exists, {build.context, build.slots, e.exists_base.data(), build.measure});
}

void ForgetExpression(PlanExpression& e) {
  for (const PlanExpressionPtr& argument : e.arguments) ForgetExpression(*argument);
  if (e.exists_operator) e.exists_operator->Forget();
}

namespace {

class FilterOperator final : public Operator {
 public:
  FilterOperator(PlanNode& node, const BuildContext& build)
      : node_(node), context_(*build.context), child_(BuildOperator(*node.children[0], build)) {
    for (const PlanExpressionPtr& filter : node.filters) PrepareExpression(*filter, build);
  }
  void Start(const TermId* in) override { child_->Start(in); }
  bool Next(TermId* out) override {
    while (child_->Next(out)) {
      if (!context_.Poll()) return false;
      const bool passes =
          std::all_of(node_.filters.begin(), node_.filters.end(),
                      [&](const PlanExpressionPtr& filter) { return Passes(*filter, out, context_); });
      if (passes) return true;
    }
    return false;
  }
  void Forget() override {
    child_->Forget();
    for (const PlanExpressionPtr& filter : node_.filters) ForgetExpression(*filter);
  }

 private:
  PlanNode& node_;
  EvaluationContext& context_;
  std::unique_ptr<Operator> child_;
};

class UnionOperator final : public Operator {
 public:
  UnionOperator(PlanNode& node, const BuildContext& build) : in_(build.slots) {
    for (const PlanNodePtr& child : node.children) children_.push_back(BuildOperator(*child, build));
  }
  void Start(const TermId* in) override {
    std::copy(in, in + in_.size(), in_.begin());
    current_ = 0;
    children_[0]->Start(in);
  }
  bool Next(TermId* out) override {
    while (current_ < children_.size()) {
      if (children_[current_]->Next(out)) return true;
      if (++current_ < children_.size()) children_[current_]->Start(in_.data());
    }
    return false;
  }
  uint64_t Count(TermId* scratch) override {
    uint64_t count = 0;
    while (current_ < children_.size()) {
      count += children_[current_]->Count(scratch);
      if (++current_ < children_.size()) children_[current_]->Start(in_.data());
    }
    return count;
  }
  void Forget() override {
    for (const auto& child : children_) child->Forget();
  }

 private:
  std::vector<std::unique_ptr<Operator>> children_;
  std::vector<TermId> in_;
  size_t current_ = 0;
};

class ExtendOperator final : public Operator {
 public:
  ExtendOperator(PlanNode& node, const BuildContext& build)
      : node_(node), context_(*build.context), child_(BuildOperator(*node.children[0], build)) {
    PrepareExpression(*node.expression, build);
  }
  void Start(const TermId* in) override { child_->Start(in); }
  bool Next(TermId* out) override {
    while (child_->Next(out)) {
      if (!context_.Poll()) return false;
      const TermId id = EvaluateToId(*node_.expression, out, context_);
      if (id.IsNone()) return true;  // an error: the variable keeps its value
      TermId& slot = out[node_.slot];
      if (!slot.IsNone() && slot != id) continue;
      slot = id;
      return true;
    }
    return false;
  }
  void Forget() override {
    child_->Forget();
    ForgetExpression(*node_.expression);
  }

 private:
  PlanNode& node_;
  EvaluationContext& context_;
  std::unique_ptr<Operator> child_;
};

class ValuesOperator final : public Operator {
 public:
  ValuesOperator(PlanNode& node, const BuildContext& build)
      : node_(node), context_(*build.context), in_(build.slots) {}
  void Start(const TermId* in) override {
    std::copy(in, in + in_.size(), in_.begin());
    next_ = 0;
    if (encoded_) return;
    encoded_ = true;
    ids_.clear();
    if (!kept_.Add(node_.rows->size() * node_.columns.size() * sizeof(TermId), context_)) return;
    ids_.reserve(node_.rows->size() * node_.columns.size());
    for (const auto& row : *node_.rows) {
      if (!context_.Poll()) return;
      for (const std::optional<Term>& term : row) ids_.push_back(term ? context_.Encode(*term) : TermId());
    }
  }
  bool Next(TermId* out) override {
    const size_t width = node_.columns.size();
    while (next_ < node_.rows->size() && context_.Poll()) {
      const TermId* row = ids_.data() + width * next_++;
      std::copy(in_.begin(), in_.end(), out);
      bool fits = true;
      for (size_t i = 0; i < width; ++i) {
        if (row[i].IsNone()) continue;
        TermId& slot = out[node_.columns[i]];
        fits &= slot.IsNone() || slot == row[i];
        slot = row[i];
      }
      if (!fits) continue;
      ++context_.row_number;
      return true;
    }
    return false;
  }
  void Forget() override {
    encoded_ = false;  // local ids end with a run
    Empty(&ids_);
  }

 private:
  PlanNode& node_;
  EvaluationContext& context_;
  std::vector<TermId> in_, ids_;
  KeptMemory kept_;
  size_t next_ = 0;
  bool encoded_ = false;
};

class DistinctOperator final : public Operator {
 public:
  DistinctOperator(PlanNode& node, const BuildContext& build)
      : node_(node),
        context_(*build.context),
        child_(BuildOperator(*node.children[0], build)),
        key_(node.columns.size()),
        seen_(node.columns.size()) {}
  void Start(const TermId* in) override {
    seen_.Clear();
    kept_.LetGo(context_);
    child_->Start(in);
  }
  void Forget() override {
    seen_.Clear();
    child_->Forget();
  }
  bool Next(TermId* out) override {
    while (child_->Next(out)) {
      if (!context_.Poll()) return false;
      for (size_t i = 0; i < key_.size(); ++i) key_[i] = out[node_.columns[i]];
      if (!seen_.Insert(key_.data()).second) continue;
      return kept_.Add(2 * seen_.bytes_a_row(), context_);
    }
    return false;
  }

 private:
  PlanNode& node_;
  EvaluationContext& context_;
  std::unique_ptr<Operator> child_;
  std::vector<TermId> key_;
  RowSet seen_;
  KeptMemory kept_;
};

class SliceOperator final : public Operator {
 public:
  SliceOperator(PlanNode& node, const BuildContext& build)
      : node_(node), child_(BuildOperator(*node.children[0], build)) {}
  void Start(const TermId* in) override {
    skip_ = node_.offset;
    left_ = node_.limit;
    child_->Start(in);
  }
  bool Next(TermId* out) override {
    if (left_ && *left_ == 0) return false;
    for (; skip_ > 0; --skip_) {
      if (!child_->Next(out)) return false;
    }
    if (!child_->Next(out)) return false;
    if (left_) --*left_;
    return true;
  }
  void Forget() override { child_->Forget(); }

 private:
  PlanNode& node_;
  std::unique_ptr<Operator> child_;
  uint64_t skip_ = 0;
  std::optional<uint64_t> left_;
};

// In place of one that was not built, as the evaluation has to end.
class NoOperator final : public Operator {
 public:
  void Start(const TermId*) override {}
  bool Next(TermId*) override { return false; }
};

// Wrapper of any operator that counts its rows and measures its time.
class MeasuredOperator final : public Operator {
 public:
  MeasuredOperator(PlanNode& node, std::unique_ptr<Operator> inner) : node_(node), inner_(std::move(inner)) {}
  void Start(const TermId* in) override {
    const Timer timer(node_);
    ++node_.starts;
    inner_->Start(in);
  }
  bool Next(TermId* out) override {
    const Timer timer(node_);
    if (!inner_->Next(out)) return false;
    ++node_.rows_made;
    return true;
  }
  uint64_t Count(TermId* scratch) override {
    const Timer timer(node_);
    const uint64_t count = inner_->Count(scratch);
    node_.rows_made += count;
    return count;
  }
  void Forget() override { inner_->Forget(); }

 private:
  struct Timer {
    explicit Timer(PlanNode& node) : node(node), since(std::chrono::steady_clock::now()) {}
    ~Timer() {
      node.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
    }
    PlanNode& node;
    std::chrono::steady_clock::time_point since;
  };

  PlanNode& node_;
  std::unique_ptr<Operator> inner_;
};

std::unique_ptr<Operator> BuildPlain(PlanNode& node, const BuildContext& build) {
  switch (node.kind) {
    case Kind::kBgp:
      return BuildBgp(node, build);
    case Kind::kJoin:
    case Kind::kLeftJoin:
      return BuildJoin(node, build);
    case Kind::kHashJoin:
    case Kind::kHashLeftJoin:
      return BuildHashJoin(node, build);
    case Kind::kMinus:
    case Kind::kHashMinus:
      return BuildMinus(node, build);
    case Kind::kGraph:
      return BuildGraph(node, build);
    case Kind::kGroup:
      return BuildGroup(node, build);
    case Kind::kOrderBy:
      return BuildOrderBy(node, build);
    case Kind::kPath:
      return BuildPath(node, build);
    default:
      return BuildSimple(node, build);
  }
}

}  // namespace

std::unique_ptr<Operator> BuildSimple(PlanNode& node, const BuildContext& build) {
  switch (node.kind) {
    case Kind::kFilter:
      return std::make_unique<FilterOperator>(node, build);
    case Kind::kUnion:
      return std::make_unique<UnionOperator>(node, build);
    case Kind::kExtend:
      return std::make_unique<ExtendOperator>(node, build);
    case Kind::kValues:
      return std::make_unique<ValuesOperator>(node, build);
    case Kind::kDistinct:
      return std::make_unique<DistinctOperator>(node, build);
    case Kind::kSlice:
      return std::make_unique<SliceOperator>(node, build);
    default:
      return BuildOperator(*node.children[0], build);  // kProject: hidden variables have slots of their own
  }
}

std::unique_ptr<Operator> BuildOperator(PlanNode& node, const BuildContext& build) {
  // Few operators keep more than three rows; of levels, filters and children each has a share.
  constexpr size_t kBytesOfOperator = 512, kBytesOfPattern = 512;
  const size_t bytes = kBytesOfOperator + 3 * build.slots * sizeof(TermId) +
                       node.patterns.size() * kBytesOfPattern + node.filters.size() * 4 * sizeof(void*);
  if (!build.context->ChargePlan(bytes) || !build.context->Poll()) return std::make_unique<NoOperator>();
  std::unique_ptr<Operator> plain = BuildPlain(node, build);
  if (!build.measure) return plain;
  return std::make_unique<MeasuredOperator>(node, std::move(plain));
}

}  // namespace docent::sparql
