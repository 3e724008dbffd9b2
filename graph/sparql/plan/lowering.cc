#include "graph/sparql/plan/lowering.h"

#include <algorithm>
#include <utility>

#include "graph/sparql/syntax/algebra_memory.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/sparql/values/text.h"

namespace docent::sparql {

using Kind = Algebra::Kind;
using Plan = PlanNode::Kind;

namespace {

// Up to this limit ORDER BY … LIMIT keeps a heap; beyond, it sorts all rows.
constexpr uint64_t kTopRows = 100000;

PlanNodePtr Node(Plan kind) {
  return std::make_unique<PlanNode>(kind);
}

// A pattern's three terms or a path's IRI among the constants, and in the map of their numbers.
constexpr size_t kBytesOfConstants = 3 * (sizeof(Term) + 64);

// A node with one child and the child's variables.
PlanNodePtr Over(Plan kind, PlanNodePtr child) {
  PlanNodePtr node = Node(kind);
  node->certain = child->certain;
  node->possible = child->possible;
  node->mentions = child->mentions;
  node->barrier = child->barrier;
  node->children.push_back(std::move(child));
  return node;
}

// Without its children and the expressions. A node that stands for several of the algebra counts for each.
size_t MemoryOf(const PlanNode& node) {
  size_t bytes = sizeof(PlanNode) + kBytesOfAllocation + node.certain.bytes() + node.possible.bytes() +
                 node.mentions.bytes() + node.patterns.size() * (sizeof(PlanPattern) + kBytesOfConstants) +
                 node.path_constants.size() * kBytesOfConstants + node.columns.size() * 2 * sizeof(int);
  for (const SlotSet& reads : node.filter_slots) bytes += sizeof(reads) + reads.bytes();
  return bytes;
}

bool HasExists(const Expression& e) {
  if (e.pattern) return true;
  for (const ExpressionPtr& argument : e.arguments) {
    if (HasExists(*argument)) return true;
  }
  return false;
}

}  // namespace

void Lowering::Fail(absl::StatusCode code, const SourceSpan& span, const std::string& message) {
  if (!status_.ok()) return;
  std::string place;
  if (span.line > 0) {
    place = "line " + std::to_string(span.line) + ", column " + std::to_string(span.column) + ": ";
  }
  status_ = absl::Status(code, place + message);
}

int Lowering::SlotOf(const std::string& variable, Scope& scope) {
  const auto [slot, added] = scope.Add(variable, next_slot_);
  if (added) ++next_slot_;
  if (added && Variable{variable}.IsHidden()) hidden_.Add(slot);
  return slot;
}

int Lowering::ConstantOf(const Term& term) {
  constexpr size_t kFew = 16;  // up to this many, linear search is fastest
  if (constants_.size() > kFew) return ConstantOfMany(term);
  size_t place = 0;
  while (place < constants_.size() && *constants_[place] != term) ++place;
  if (place == constants_.size()) constants_.push_back(&term);
  return static_cast<int>(place);
}

int Lowering::ConstantOfMany(const Term& term) {
  if (constant_numbers_.empty()) {
    for (size_t i = 0; i < constants_.size(); ++i)
      constant_numbers_.emplace(*constants_[i], static_cast<int>(i));
  }
  const auto [it, added] = constant_numbers_.emplace(term, static_cast<int>(constants_.size()));
  if (added) constants_.push_back(&term);
  return it->second;
}

PlanTerm Lowering::TermOf(const PatternTerm& term, Scope& scope) {
  if (term.IsVariable()) return {SlotOf(term.variable().name, scope), -1};
  return {-1, ConstantOf(term.term())};
}

PlanNodePtr Lowering::LowerQuery(const Algebra& algebra) {
  PlanNodePtr node = Lower(algebra, root_, GraphRef{}, true);
  return status_.ok() ? std::move(node) : nullptr;
}

PlanExpressionPtr Lowering::LowerExpression(const Expression& expression) {
  PlanExpressionPtr e = Lower(expression, root_, GraphRef{});
  return status_.ok() ? std::move(e) : nullptr;
}

bool Lowering::Count(size_t bytes) {
  if (context_.ChargePlan(bytes) && context_.Poll()) return true;
  if (status_.ok()) status_ = context_.status;
  return false;
}

PlanNodePtr Lowering::Lower(const Algebra& a, Scope& scope, const GraphRef& graph, bool top) {
  if (!status_.ok()) return Node(Plan::kBgp);
  PlanNodePtr node = LowerNode(a, scope, graph, top);
  Count(MemoryOf(*node));
  return node;
}

PlanNodePtr Lowering::LowerNode(const Algebra& a, Scope& scope, const GraphRef& graph, bool top) {
  switch (a.kind) {
    case Kind::kBgp:
      return LowerBgp(a, scope, graph);
    case Kind::kPath:
      return LowerPath(a, scope, graph);
    case Kind::kJoin:
      return LowerJoin(a, scope, graph);
    case Kind::kLeftJoin:
    case Kind::kMinus:
      return LowerLeftJoin(a, scope, graph);
    case Kind::kFilter:
      return LowerFilter(a, scope, graph);
    case Kind::kGraph:
      return LowerGraph(a, scope);
    case Kind::kValues:
      return LowerValues(a, scope);
    case Kind::kGroup:
      return LowerGroup(a, scope, graph);
    case Kind::kProject:
      return LowerProject(a, scope, graph, top);
    case Kind::kService:
      Fail(absl::StatusCode::kUnimplemented, a.span,
           "SERVICE is not allowed here: only queries and updates may use other endpoints");
      return Node(Plan::kBgp);
    case Kind::kUnion: {
      PlanNodePtr node = Node(Plan::kUnion);
      for (const AlgebraPtr& child : a.children) {
        PlanNodePtr lowered = Lower(*child, scope, graph, false);
        node->certain = node->children.empty() ? lowered->certain : node->certain.And(lowered->certain);
        node->possible |= lowered->possible;
        node->mentions |= lowered->mentions;
        node->barrier |= lowered->barrier;
        node->children.push_back(std::move(lowered));
      }
      return node;
    }
    case Kind::kExtend: {
      PlanNodePtr node = Over(Plan::kExtend, Lower(*a.children[0], scope, graph, false));
      node->source = &a;
      node->expression = Lower(*a.expression, scope, graph);
      node->slot = SlotOf(a.variable.name, scope);
      SlotSet reads = Reads(*a.expression, scope, graph);
      node->mentions |= reads;
      node->filter_slots.push_back(std::move(reads));
      node->possible.Add(node->slot);
      node->mentions.Add(node->slot);
      return node;
    }
    case Kind::kOrderBy: {
      PlanNodePtr child = Lower(*a.children[0], scope, graph, top);
      PlanNodePtr node = Over(Plan::kOrderBy, std::move(child));
      for (const OrderCondition& o : a.order) {
        node->order.emplace_back(Lower(*o.expression, scope, graph), o.descending);
        node->mentions |= Reads(*o.expression, scope, graph);
      }
      node->barrier = true;
      return node;
    }
    case Kind::kReduced:  // duplicates may remain (section 18.5, REDUCED)
      return Lower(*a.children[0], scope, graph, top);
    case Kind::kDistinct: {
      PlanNodePtr node = Over(Plan::kDistinct, Lower(*a.children[0], scope, graph, top));
      node->columns = node->possible.List();
      node->barrier = true;
      return node;
    }
    case Kind::kSlice: {
      PlanNodePtr node = Over(Plan::kSlice, Lower(*a.children[0], scope, graph, top));
      node->offset = a.offset;
      node->limit = a.limit;
      node->barrier = true;
      // ORDER BY … LIMIT keeps the first rows only; a projection between them changes no row
      PlanNode* child = node->children[0].get();
      while (child->kind == Plan::kProject) child = child->children[0].get();
      if (child->kind == Plan::kOrderBy && a.limit && *a.limit < kTopRows && a.offset < kTopRows) {
        child->limit = *a.limit + a.offset;
      }
      return node;
    }
  }
  return Node(Plan::kBgp);
}

PlanNodePtr Lowering::LowerBgp(const Algebra& a, Scope& scope, const GraphRef& graph) {
  PlanNodePtr node = Node(Plan::kBgp);
  node->patterns.reserve(a.triples.size());
  for (const TriplePattern& t : a.triples) {
    PlanPattern& pattern = node->patterns.emplace_back();
    const PatternTerm* terms[] = {&t.subject, &t.predicate, &t.object};
    for (int i = 0; i < 3; ++i) {
      pattern.terms[i] = TermOf(*terms[i], scope);
      if (pattern.terms[i].slot >= 0) node->certain.Add(pattern.terms[i].slot);
    }
    pattern.graph = graph;
    pattern.source = &t;
  }
  node->possible = node->certain;
  node->mentions = node->certain;
  if (graph.name.slot >= 0 && !node->patterns.empty()) node->mentions.Add(graph.name.slot);
  return node;
}

PlanNodePtr Lowering::LowerPath(const Algebra& a, Scope& scope, const GraphRef& graph) {
  PlanNodePtr node = Node(Plan::kPath);
  node->source = &a;
  node->subject = TermOf(a.subject, scope);
  node->object = TermOf(a.object, scope);
  node->subject_term = a.subject.term();
  node->object_term = a.object.term();
  node->path = &a.path;
  node->graph = graph;
  const auto collect = [&](const Path& path, const auto& self) -> void {
    if (path.kind == Path::Kind::kIri) node->path_constants.push_back(ConstantOf(path.iri));
    for (const Path& child : path.children) self(child, self);
  };
  collect(a.path, collect);
  for (const PlanTerm& term : {node->subject, node->object}) {
    if (term.slot >= 0) node->certain.Add(term.slot);
  }
  node->possible = node->certain;
  node->mentions = node->certain;
  if (graph.name.slot >= 0) node->mentions.Add(graph.name.slot);
  return node;
}

PlanNodePtr Lowering::LowerJoin(const Algebra& a, Scope& scope, const GraphRef& graph) {
  PlanNodePtr join = Node(Plan::kJoin);
  PlanNode* bgp = nullptr;  // adjacent patterns form one BGP, whatever their graph
  for (const AlgebraPtr& child : a.children) {
    PlanNodePtr lowered = Lower(*child, scope, graph, false);
    join->certain |= lowered->certain;
    join->possible |= lowered->possible;
    join->mentions |= lowered->mentions;
    join->barrier |= lowered->barrier;
    if (lowered->kind != Plan::kBgp) {
      join->children.push_back(std::move(lowered));
      continue;
    }
    if (bgp == nullptr) {
      bgp = lowered.get();
      join->children.push_back(std::move(lowered));
      continue;
    }
    for (PlanPattern& p : lowered->patterns) bgp->patterns.push_back(std::move(p));
    for (PlanExpressionPtr& f : lowered->filters) bgp->filters.push_back(std::move(f));
    for (SlotSet& s : lowered->filter_slots) bgp->filter_slots.push_back(std::move(s));
    bgp->certain |= lowered->certain;
    bgp->possible |= lowered->possible;
    bgp->mentions |= lowered->mentions;
  }
  if (join->children.size() == 1) return std::move(join->children[0]);
  return join;
}

// Moves a filter to the patterns that bind its variables. This goes through joins, and through the left side
// of OPTIONAL and MINUS: their right side does not change the variables of the filter.
bool Lowering::PushFilter(PlanNode& node, PlanExpressionPtr& filter, const SlotSet& reads,
                          const SlotSet& open) {
  bool placed = false;
  if (!Count(0)) return false;
  switch (node.kind) {
    case Plan::kBgp:
      placed = open.Within(node.certain);
      if (!placed) return false;
      node.filters.push_back(std::move(filter));
      node.filter_slots.push_back(reads);
      break;
    case Plan::kJoin:
      for (const PlanNodePtr& child : node.children)
        placed = placed || PushFilter(*child, filter, reads, open);
      break;
    case Plan::kLeftJoin:
    case Plan::kMinus:
      placed = PushFilter(*node.children[0], filter, reads, open);
      break;
    default:
      break;
  }
  if (placed) node.mentions |= reads;
  return placed;
}

PlanNodePtr Lowering::LowerFilter(const Algebra& a, Scope& scope, const GraphRef& graph) {
  PlanNodePtr child = Lower(*a.children[0], scope, graph, false);
  PlanNodePtr filter;
  std::vector<std::pair<PlanExpressionPtr, SlotSet>> rest;
  std::vector<const Expression*> conjuncts;
  CollectConjuncts(*a.expression, conjuncts);
  for (const Expression* e : conjuncts) {
    SlotSet reads = Reads(*e, scope, graph);
    PlanExpressionPtr lowered = Lower(*e, scope, graph);
    if (HasExists(*e) || !PushFilter(*child, lowered, reads, reads.Minus(bound_)))
      rest.emplace_back(std::move(lowered), std::move(reads));
  }
  if (rest.empty()) return child;
  PlanNodePtr node = Over(Plan::kFilter, std::move(child));
  for (auto& [expression, reads] : rest) {
    node->mentions |= reads;
    node->filters.push_back(std::move(expression));
    node->filter_slots.push_back(std::move(reads));
  }
  return node;
}

// OPTIONAL and MINUS; the planner turns them into their hash forms where needed.
PlanNodePtr Lowering::LowerLeftJoin(const Algebra& a, Scope& scope, const GraphRef& graph) {
  const bool minus = a.kind == Kind::kMinus;
  PlanNodePtr left = Lower(*a.children[0], scope, graph, false);
  PlanNodePtr right = Lower(*a.children[1], scope, graph, false);
  PlanNodePtr node = Node(minus ? Plan::kMinus : Plan::kLeftJoin);
  node->certain = left->certain;
  node->possible = minus ? left->possible : left->possible.Or(right->possible);
  node->mentions = left->mentions.Or(right->mentions);
  node->barrier = left->barrier;
  if (a.expression) {
    node->expression = Lower(*a.expression, scope, graph);
    SlotSet reads = Reads(*a.expression, scope, graph);
    node->mentions |= reads;
    node->filter_slots.push_back(std::move(reads));
  }
  node->children.push_back(std::move(left));
  node->children.push_back(std::move(right));
  return node;
}

PlanNodePtr Lowering::LowerGraph(const Algebra& a, Scope& scope) {
  GraphRef graph;
  graph.kind = GraphRef::Kind::kNamed;
  if (!a.name.IsVariable()) {
    graph.name = TermOf(a.name, scope);
    if (NeedsTripleOfGraph(*a.children[0])) return Lower(*a.children[0], scope, graph, false);
  } else if (a.children[0]->kind == Kind::kBgp && !a.children[0]->triples.empty()) {
    // GRAPH ?g { triples }: the variable becomes the fourth position of each triple
    graph.name = TermOf(a.name, scope);
    PlanNodePtr node = LowerBgp(*a.children[0], scope, graph);
    node->certain.Add(graph.name.slot);
    node->possible.Add(graph.name.slot);
    node->mentions.Add(graph.name.slot);
    return node;
  }
  // All other patterns run once for each existing graph, with the graph in a slot of its own: ?g has no value
  // inside (section 18.6).
  PlanNodePtr node = Node(Plan::kGraph);
  node->name = TermOf(a.name, scope);
  node->graph_slot = next_slot_++;
  graph.name = {node->graph_slot, -1};
  PlanNodePtr child = Lower(*a.children[0], scope, graph, false);
  node->certain = child->certain;
  node->possible = child->possible;
  node->mentions = child->mentions;
  node->mentions.Remove(node->graph_slot);
  node->barrier = child->barrier;
  if (node->name.slot >= 0) {
    node->certain.Add(node->name.slot);
    node->possible.Add(node->name.slot);
    node->mentions.Add(node->name.slot);
  }
  node->children.push_back(std::move(child));
  return node;
}

PlanNodePtr Lowering::LowerValues(const Algebra& a, Scope& scope) {
  PlanNodePtr node = Node(Plan::kValues);
  for (size_t i = 0; i < a.variables.size(); ++i) {
    const int slot = SlotOf(a.variables[i].name, scope);
    node->columns.push_back(slot);
    node->possible.Add(slot);
    if (!Count(0)) break;
    bool always = true;
    for (const auto& row : a.rows) always &= row[i].has_value();
    if (always) node->certain.Add(slot);
  }
  node->mentions = node->possible;
  node->source = &a;
  node->rows = &a.rows;
  return node;
}

PlanNodePtr Lowering::LowerGroup(const Algebra& a, Scope& scope, const GraphRef& graph) {
  PlanNodePtr child = Lower(*a.children[0], scope, graph, false);
  PlanNodePtr node = Node(Plan::kGroup);
  node->barrier = true;
  node->mentions = child->mentions;
  for (const GroupKey& key : a.group_keys) {
    const int slot = SlotOf(key.variable.name, scope);
    node->mentions |= Reads(*key.expression, scope, graph);
    node->keys.emplace_back(slot, Lower(*key.expression, scope, graph));
    node->possible.Add(slot);
    const bool plain = key.expression->kind == Expression::Kind::kVariable;
    if (plain && child->certain.Contains(SlotOf(key.expression->variable.name, scope)))
      node->certain.Add(slot);
  }
  for (const Aggregate& aggregate : a.aggregates) {
    const int slot = SlotOf(aggregate.result.name, scope);
    if (aggregate.expression) node->mentions |= Reads(*aggregate.expression, scope, graph);
    node->aggregates.push_back({aggregate.function, aggregate.distinct,
                                aggregate.expression ? Lower(*aggregate.expression, scope, graph) : nullptr,
                                aggregate.separator, slot});
    node->possible.Add(slot);
    if (aggregate.distinct && !aggregate.expression) node->columns = child->possible.Minus(hidden_).List();
  }
  node->mentions |= node->possible;
  node->children.push_back(std::move(child));
  return node;
}

PlanNodePtr Lowering::LowerProject(const Algebra& a, Scope& scope, const GraphRef& graph, bool top) {
  std::optional<Scope> inner;  // of a sub-SELECT
  if (!top) inner.emplace();
  SlotSet columns;
  for (const Variable& v : a.variables) {
    const int slot = SlotOf(v.name, scope);
    if (inner) inner->Add(v.name, slot);
    columns.Add(slot);
  }
  PlanNodePtr node = Over(Plan::kProject, Lower(*a.children[0], inner ? *inner : scope, graph, false));
  node->columns = columns.List();
  node->certain = node->certain.And(columns);
  node->possible = node->possible.And(columns);
  return node;
}

SlotSet Lowering::Reads(const Expression& e, Scope& scope, const GraphRef& graph) {
  SlotSet out;
  if (e.arguments.empty() && e.kind != Expression::Kind::kVariable && !e.pattern) return out;
  for (const Variable* v : VariablesMentioned(e)) out.Add(SlotOf(v->name, scope));
  if (graph.name.slot >= 0 && HasExists(e)) out.Add(graph.name.slot);
  return out;
}

void Lowering::CheckFunction(const Expression& e) {
  const std::optional<CallMistake> mistake = FindCallMistake(functions_, e.term.lexical, e.arguments.size());
  if (!mistake) return;
  Fail(absl::StatusCode::kInvalidArgument, e.span,
       mistake->message + (mistake->hint.empty() ? "" : "; " + mistake->hint));
}

PlanExpressionPtr Lowering::Lower(const Expression& e, Scope& scope, const GraphRef& graph) {
  auto out = std::make_unique<PlanExpression>();
  if (!status_.ok() || !Count(sizeof(PlanExpression) + kBytesOfAllocation + 2 * TextMemory(e.term)))
    return out;
  out->source = &e;
  out->kind = e.kind;
  out->builtin = e.builtin;
  if (e.kind == Expression::Kind::kVariable) {
    out->slot = SlotOf(e.variable.name, scope);
  } else if (e.kind == Expression::Kind::kTerm) {
    out->term = e.term;
    out->constant = Value::OfTerm(e.term);
    if (const std::optional<TermId> id = dictionary_.Find(e.term)) out->constant.set_id(*id);
  } else if (e.kind == Expression::Kind::kFunction) {
    out->term = e.term;
    CheckFunction(e);
  }
  for (const ExpressionPtr& argument : e.arguments) out->arguments.push_back(Lower(*argument, scope, graph));
  if (e.pattern) out->exists = Lower(*e.pattern, scope, graph, false);
  return out;
}

}  // namespace docent::sparql
