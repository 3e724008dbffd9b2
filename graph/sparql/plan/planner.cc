#include "graph/sparql/plan/planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "graph/sparql/plan/join_order.h"

namespace docent::sparql {

using Kind = PlanNode::Kind;

namespace {

// Operands of one join that are compared with each other at each step.
constexpr size_t kMostCompared = 64;

class Arranger {
 public:
  Arranger(const SlotSet& initial, EvaluationContext& context, const PlannerOptions& options)
      : initial_(initial), context_(context), options_(options) {}

  void Arrange(PlanNodePtr& node, const SlotSet& bound);
  void Arrange(PlanExpression& e, const SlotSet& bound) {
    for (const PlanExpressionPtr& argument : e.arguments) Arrange(*argument, bound);
    if (e.exists) Arrange(e.exists, bound);
  }

 private:
  double Estimate(PlanNode& node, const SlotSet& bound) const;
  void ArrangeJoin(PlanNodePtr& node, const SlotSet& bound);
  void SortByRows(std::vector<PlanNodePtr>* operands, const SlotSet& bound) const;
  void ArrangeBinary(PlanNode& node, const SlotSet& bound);
  void SetEstimate(PlanNode& node, const SlotSet& bound) const;

  const SlotSet& initial_;
  EvaluationContext& context_;
  const PlannerOptions& options_;
};

double Arranger::Estimate(PlanNode& node, const SlotSet& bound) const {
  if (!context_.Poll()) return 1;
  switch (node.kind) {
    case Kind::kBgp:
      return JoinOrder(node, bound, context_).Rows();
    case Kind::kValues:
      return static_cast<double>(node.rows->size());
    case Kind::kUnion: {
      double sum = 0;
      for (const PlanNodePtr& child : node.children) sum += Estimate(*child, bound);
      return sum;
    }
    case Kind::kJoin: {
      double product = 1;
      SlotSet now = bound;
      for (const PlanNodePtr& child : node.children) {
        product *= Estimate(*child, now);
        now |= child->certain;
      }
      return product;
    }
    case Kind::kPath: {
      const bool from = node.subject.slot < 0 || bound.Contains(node.subject.slot);
      const bool to = node.object.slot < 0 || bound.Contains(node.object.slot);
      double steps = 1;  // triples that the path can follow
      for (const int constant : node.path_constants) {
        const TermId predicate = context_.constants[constant];
        if (predicate == kUnknownTerm || !context_.Poll()) continue;
        steps += static_cast<double>(context_.version->Count({TermId(), predicate, TermId(), TermId()}));
      }
      return from && to ? 0.5 : from || to ? std::sqrt(steps) : steps * 2;
    }
    case Kind::kGraph:
      return 4 * Estimate(*node.children[0], bound);
    default:
      return node.children.empty() ? 1 : Estimate(*node.children[0], bound);
  }
}

void Arranger::SortByRows(std::vector<PlanNodePtr>* operands, const SlotSet& bound) const {
  for (const PlanNodePtr& operand : *operands) operand->estimate = Estimate(*operand, bound);
  std::stable_sort(operands->begin(), operands->end(),
                   [](const PlanNodePtr& a, const PlanNodePtr& b) { return a->estimate < b->estimate; });
}

void Arranger::ArrangeJoin(PlanNodePtr& node, const SlotSet& bound) {
  std::vector<PlanNodePtr> rest = std::move(node->children);
  const bool many = rest.size() > kMostCompared;
  if (many && options_.reorder) SortByRows(&rest, bound);
  PlanNodePtr done;
  SlotSet now = bound;
  for (size_t first = 0; first < rest.size(); ++first) {
    size_t best = first;
    double best_estimate = std::numeric_limits<double>::infinity();
    for (size_t i = first; i < rest.size(); ++i) {
      const double estimate = Estimate(*rest[i], now);
      if (estimate < best_estimate) {
        best = i;
        best_estimate = estimate;
      }
      if (many || !options_.reorder) break;
    }
    PlanNodePtr next = std::move(rest[best]);
    std::move_backward(rest.begin() + static_cast<std::ptrdiff_t>(first),
                       rest.begin() + static_cast<std::ptrdiff_t>(best),
                       rest.begin() + static_cast<std::ptrdiff_t>(best) + 1);
    if (!done) {
      Arrange(next, now);
      now |= next->certain;
      done = std::move(next);
      continue;
    }
    const bool loop = !next->barrier && IsSafeWithBound(*next, done->possible.Minus(initial_));
    Arrange(next, loop ? now : initial_);
    auto join = std::make_unique<PlanNode>(loop ? Kind::kJoin : Kind::kHashJoin);
    join->certain = done->certain.Or(next->certain);
    join->possible = done->possible.Or(next->possible);
    join->mentions = done->mentions.Or(next->mentions);
    join->barrier = done->barrier || next->barrier;
    join->estimate = done->estimate * best_estimate;
    context_.ChargePlan(sizeof(PlanNode) + join->certain.bytes() + join->possible.bytes() +
                        join->mentions.bytes());
    now |= next->certain;
    join->children.push_back(std::move(done));
    join->children.push_back(std::move(next));
    done = std::move(join);
  }
  node = std::move(done);
}

// OPTIONAL and MINUS
void Arranger::ArrangeBinary(PlanNode& node, const SlotSet& bound) {
  PlanNodePtr& left = node.children[0];
  PlanNodePtr& right = node.children[1];
  Arrange(left, bound);
  node.estimate = left->estimate;
  bool loop = !right->barrier && IsSafeWithBound(*right, left->possible.Minus(initial_));
  // MINUS removes rows only if a variable is shared; a variable that both sides bind for certain guarantees
  // that.
  if (node.kind == Kind::kMinus) loop = loop && left->certain.Meets(right->certain);
  Arrange(right, loop ? bound.Or(left->certain) : initial_);
  if (!loop) node.kind = node.kind == Kind::kMinus ? Kind::kHashMinus : Kind::kHashLeftJoin;
  if (node.expression) Arrange(*node.expression, bound.Or(left->certain));
}

// Estimates a node whose children have estimates.
void Arranger::SetEstimate(PlanNode& node, const SlotSet& bound) const {
  const double below = node.children.empty() ? 1 : node.children[0]->estimate;
  switch (node.kind) {
    case Kind::kValues:
    case Kind::kPath:
      node.estimate = Estimate(node, bound);
      return;
    case Kind::kUnion:
      node.estimate = 0;
      for (const PlanNodePtr& child : node.children) node.estimate += child->estimate;
      return;
    case Kind::kGraph:
      node.estimate = 4 * below;
      return;
    case Kind::kGroup:
      node.estimate = node.keys.empty() ? 1 : std::sqrt(below);
      return;
    case Kind::kFilter:
      node.estimate = below * std::pow(0.5, static_cast<double>(node.filters.size()));
      return;
    case Kind::kOrderBy:
    case Kind::kSlice:
      node.estimate = node.limit ? std::min(below, static_cast<double>(*node.limit)) : below;
      return;
    default:
      node.estimate = below;
  }
}

void Arranger::Arrange(PlanNodePtr& node, const SlotSet& bound) {
  switch (node->kind) {
    case Kind::kBgp:
      node->estimate = JoinOrder(*node, bound, context_).Arrange(options_.reorder);
      for (const PlanExpressionPtr& filter : node->filters) Arrange(*filter, bound.Or(node->certain));
      return;
    case Kind::kJoin:
      ArrangeJoin(node, bound);
      return;
    case Kind::kLeftJoin:
    case Kind::kMinus:
      ArrangeBinary(*node, bound);
      return;
    default:
      break;
  }
  for (PlanNodePtr& child : node->children) Arrange(child, bound);
  SetEstimate(*node, bound);
  SlotSet inside = bound;
  if (!node->children.empty()) inside |= node->children[0]->certain;
  for (const PlanExpressionPtr& filter : node->filters) Arrange(*filter, inside);
  if (node->expression) Arrange(*node->expression, inside);
  for (auto& [slot, key] : node->keys) Arrange(*key, inside);
  for (auto& aggregate : node->aggregates) {
    if (aggregate.expression) Arrange(*aggregate.expression, inside);
  }
  for (auto& [expression, descending] : node->order) Arrange(*expression, inside);
}

}  // namespace

void ArrangePlan(PlanNodePtr& node, const SlotSet& bound, EvaluationContext& context,
                 const PlannerOptions& options) {
  Arranger(bound, context, options).Arrange(node, bound);
}

void ArrangeExpression(PlanExpression& expression, const SlotSet& bound, EvaluationContext& context,
                       const PlannerOptions& options) {
  Arranger(bound, context, options).Arrange(expression, bound);
}

bool IsSafeWithBound(const PlanNode& node, const SlotSet& outer) {
  const SlotSet shared = outer.And(node.mentions);
  if (shared.empty()) return true;
  const auto reads_only_own = [&](const std::vector<SlotSet>& reads, const SlotSet& own) {
    return std::all_of(reads.begin(), reads.end(),
                       [&](const SlotSet& r) { return shared.And(r).Within(own); });
  };
  switch (node.kind) {
    case Kind::kBgp:
    case Kind::kValues:
    case Kind::kPath:
      return true;
    case Kind::kJoin:
    case Kind::kUnion:
      return std::all_of(node.children.begin(), node.children.end(),
                         [&](const PlanNodePtr& child) { return IsSafeWithBound(*child, shared); });
    case Kind::kHashJoin:  // the right side sees nothing from outside
    case Kind::kDistinct:
    case Kind::kGraph:
    case Kind::kProject:
      return IsSafeWithBound(*node.children[0], shared);
    case Kind::kLeftJoin:
    case Kind::kHashLeftJoin:
    case Kind::kMinus:
    case Kind::kHashMinus: {
      const PlanNode& left = *node.children[0];
      return IsSafeWithBound(left, shared) && shared.And(node.children[1]->mentions).Within(left.certain) &&
             reads_only_own(node.filter_slots, left.certain);
    }
    case Kind::kExtend:  // its own variable is compared with the bound value; its inputs must come from
                         // inside
    case Kind::kFilter:
      return IsSafeWithBound(*node.children[0], shared) &&
             reads_only_own(node.filter_slots, node.children[0]->certain);
    case Kind::kGroup:
    case Kind::kOrderBy:
    case Kind::kSlice:
      return false;
  }
  return false;
}

}  // namespace docent::sparql
