#include "kb_server/sparql/planner.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace docent::sparql {

using Kind = PlanNode::Kind;

namespace {

// How a pattern's number of matches n shrinks, as a power of n, for a variable that is bound but whose value
// the planner does not know. A subject has few values of one property, an object is shared by more subjects,
// a predicate by most.
constexpr double kBoundSubject = 0.15, kBoundPredicate = 0.6, kBoundObject = 0.4;

class Arranger {
 public:
  Arranger(const SlotSet& initial, const EvaluationContext& context, const PlannerOptions& options)
      : initial_(initial), context_(context), options_(options) {}

  void Arrange(PlanNodePtr& node, const SlotSet& bound);
  void Arrange(PlanExpression& e, const SlotSet& bound) {
    for (const PlanExpressionPtr& argument : e.arguments) Arrange(*argument, bound);
    if (e.exists) Arrange(e.exists, bound);
  }

 private:
  TermId IdOf(const PlanTerm& term) const {
    return term.constant < 0 ? TermId() : context_.constants[term.constant];
  }
  double EstimatePattern(const PlanPattern& pattern, const SlotSet& bound) const;
  double Estimate(const PlanNode& node, const SlotSet& bound) const;
  double ArrangeBgp(std::vector<PlanPattern>& patterns, SlotSet bound) const;
  void ArrangeJoin(PlanNodePtr& node, const SlotSet& bound);
  void ArrangeBinary(PlanNode& node, const SlotSet& bound);

  const SlotSet& initial_;
  const EvaluationContext& context_;
  const PlannerOptions& options_;
};

double Arranger::EstimatePattern(const PlanPattern& pattern, const SlotSet& bound) const {
  QuadPattern quad{IdOf(pattern.terms[0]), IdOf(pattern.terms[1]), IdOf(pattern.terms[2]),
                   IdOf(pattern.graph.name)};
  for (const TermId id : {quad.subject, quad.predicate, quad.object, quad.graph}) {
    if (id.tag() == TermId::Tag::kLocal) return 0;
  }
  const double count = static_cast<double>(context_.version->Count(quad));
  if (count <= 1) return count;
  double power = 1;
  const double powers[] = {kBoundSubject, kBoundPredicate, kBoundObject};
  for (int i = 0; i < 3; ++i) {
    const int slot = pattern.terms[i].slot;
    if (slot >= 0 && bound.Contains(slot)) power *= powers[i];
  }
  return std::pow(count, power);
}

double Arranger::ArrangeBgp(std::vector<PlanPattern>& patterns, SlotSet bound) const {
  double rows = 1;
  for (size_t done = 0; done < patterns.size(); ++done) {
    size_t best = done;
    double best_estimate = std::numeric_limits<double>::infinity();
    for (size_t i = done; i < patterns.size(); ++i) {
      const double estimate = EstimatePattern(patterns[i], bound);
      if (estimate < best_estimate) {
        best = i;
        best_estimate = estimate;
      }
      if (!options_.reorder) break;
    }
    std::rotate(patterns.begin() + static_cast<std::ptrdiff_t>(done),
                patterns.begin() + static_cast<std::ptrdiff_t>(best),
                patterns.begin() + static_cast<std::ptrdiff_t>(best) + 1);
    patterns[done].estimate = best_estimate;
    rows = std::max(rows * best_estimate, 1e-3);
    for (const PlanTerm& term : patterns[done].terms) {
      if (term.slot >= 0) bound.Add(term.slot);
    }
    if (patterns[done].graph.name.slot >= 0) bound.Add(patterns[done].graph.name.slot);
  }
  return rows;
}

double Arranger::Estimate(const PlanNode& node, const SlotSet& bound) const {
  switch (node.kind) {
    case Kind::kBgp: {
      std::vector<PlanPattern> patterns = node.patterns;
      return ArrangeBgp(patterns, bound);
    }
    case Kind::kValues:
      return static_cast<double>(node.rows.size());
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
      const double size = static_cast<double>(context_.version->size()) + 1;
      return from && to ? 0.5 : from || to ? std::sqrt(size) : size * 2;
    }
    case Kind::kGraph:
      return 4 * Estimate(*node.children[0], bound);
    default:
      return node.children.empty() ? 1 : Estimate(*node.children[0], bound);
  }
}

void Arranger::ArrangeJoin(PlanNodePtr& node, const SlotSet& bound) {
  std::vector<PlanNodePtr> rest = std::move(node->children);
  PlanNodePtr done;
  SlotSet now = bound;
  while (!rest.empty()) {
    size_t best = 0;
    double best_estimate = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < rest.size(); ++i) {
      const double estimate = Estimate(*rest[i], now);
      if (estimate < best_estimate) {
        best = i;
        best_estimate = estimate;
      }
      if (!options_.reorder) break;
    }
    PlanNodePtr next = std::move(rest[best]);
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(best));
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
  // MINUS removes only where a variable is shared; one that is bound on both sides for certain settles that.
  if (node.kind == Kind::kMinus) loop = loop && left->certain.Meets(right->certain);
  Arrange(right, loop ? bound.Or(left->certain) : initial_);
  if (!loop) node.kind = node.kind == Kind::kMinus ? Kind::kHashMinus : Kind::kHashLeftJoin;
  if (node.expression) Arrange(*node.expression, bound.Or(left->certain));
}

void Arranger::Arrange(PlanNodePtr& node, const SlotSet& bound) {
  switch (node->kind) {
    case Kind::kBgp:
      node->estimate = ArrangeBgp(node->patterns, bound);
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
  node->estimate = Estimate(*node, bound);
  for (PlanNodePtr& child : node->children) Arrange(child, bound);
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

void ArrangePlan(PlanNodePtr& node, const SlotSet& bound, const EvaluationContext& context,
                 const PlannerOptions& options) {
  Arranger(bound, context, options).Arrange(node, bound);
}

void ArrangeExpression(PlanExpression& expression, const SlotSet& bound, const EvaluationContext& context,
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
    case Kind::kExtend:  // its own variable is compared with what is bound; what it reads must come from
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

namespace {

std::string Rounded(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, value < 10 ? "%.2g" : "%.0f", value);
  return buffer;
}

void Explain(const PlanNode& node, int depth, std::string* out) {
  static constexpr const char* kNames[] = {
      "patterns", "join (loop)",  "join (hash)",  "optional (loop)", "optional (hash)", "filter",
      "union",    "minus (loop)", "minus (hash)", "graph",           "extend",          "values",
      "group",    "order",        "project",      "distinct",        "slice",           "path"};
  const std::string indent(static_cast<size_t>(depth) * 2, ' ');
  *out += indent + kNames[static_cast<size_t>(node.kind)] + "  ~" + Rounded(node.estimate) + " rows";
  if (node.kind == Kind::kBgp && !node.filters.empty())
    *out += ", " + std::to_string(node.filters.size()) + " filters";
  *out += '\n';
  for (const PlanPattern& p : node.patterns)
    *out += indent + "  " + p.text + "  ~" + Rounded(p.estimate) + "\n";
  for (const PlanNodePtr& child : node.children) Explain(*child, depth + 1, out);
  for (const PlanExpressionPtr& filter : node.filters) {
    if (filter->exists) Explain(*filter->exists, depth + 2, out);
  }
}

}  // namespace

std::string ExplainPlan(const PlanNode& node) {
  std::string out;
  Explain(node, 0, &out);
  return out;
}

}  // namespace docent::sparql
