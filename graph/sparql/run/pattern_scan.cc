#include "graph/sparql/run/pattern_scan.h"

#include <algorithm>
#include <bit>

#include "graph/base/step_costs.h"

namespace docent::sparql {

void PatternScan::PrepareGraph(const GraphRef& graph, bool bound) {
  const DatasetIds& dataset = context_->dataset;
  sees_ = true;
  only_ = nullptr;
  except_ = TermId();
  graph_ = TermId();
  merge_ = false;
  if (graph.kind == GraphRef::Kind::kNamed) {
    if (dataset.is_explicit) {
      only_ = &dataset.named_graphs;
    } else if (dataset.strict) {
      except_ = dataset.unnamed_graph;
    }
    if (!bound) AssignTo(graph.name.slot, 3);
    return;
  }
  if (dataset.is_explicit ? dataset.default_graphs.size() == 1 : dataset.strict) {
    graph_ = dataset.is_explicit ? dataset.default_graphs[0] : dataset.default_graph;
    sees_ = graph_.tag() != TermId::Tag::kLocal;
    return;
  }
  if (dataset.is_explicit) only_ = &dataset.default_graphs;
  sees_ = !dataset.is_explicit || !only_->empty();
  merge_ = true;
}

bool PatternScan::GraphAllowed(TermId graph) const {
  if (only_ != nullptr) return std::find(only_->begin(), only_->end(), graph) != only_->end();
  return graph != except_;
}

void PatternScan::Prepare(const PlanPattern& pattern, unsigned bound) {
  bound_ = bound;
  assigned_ = 0;
  equals_ = 0;
  PrepareGraph(pattern.graph, (bound & 8) != 0);
  for (int i = 0; i < 3; ++i) {
    if ((bound & 1u << i) == 0) AssignTo(pattern.terms[i].slot, i);
  }
  checks_ = only_ != nullptr || !except_.IsNone() || equals_ > 0;
  path_ = GraphVersion::PathFor(bound | (graph_.IsNone() ? 0 : 8));
}

void PatternScan::Open(const PlanPattern& pattern, const TermId* row, EvaluationContext& context) {
  context_ = &context;
  valid_ = false;
  unsigned bound = 0;
  bool known = true;  // all terms are known to the store
  const auto value = [&](const PlanTerm& term, unsigned bit) {
    const TermId id = term.slot < 0 ? context.constants[term.constant] : row[term.slot];
    bound |= id.IsNone() ? 0 : bit;
    known &= id.tag() != TermId::Tag::kLocal;
    return id;
  };
  QuadPattern quad = {value(pattern.terms[0], 1), value(pattern.terms[1], 2), value(pattern.terms[2], 4),
                      TermId()};
  const bool named = pattern.graph.kind == GraphRef::Kind::kNamed;
  if (named) quad.graph = value(pattern.graph.name, 8);
  if (bound != bound_) Prepare(pattern, bound);
  if (!known || !sees_) return;
  if (!named) {
    quad.graph = graph_;
  } else if (!quad.graph.IsNone() && !GraphAllowed(quad.graph)) {
    return;
  }
  context.WorkedSteps(kStepsOfLookup);
  if (path_) {
    context.version->Rescan(quad, *path_, &cursor_);
  } else {
    context.version->Rescan(quad, &cursor_);
  }
  if (checks_) last_ = Quad{};
  valid_ = true;
  first_ = true;
}

void PatternScan::AssignTo(int slot, int position) {
  for (int k = 0; k < assigned_; ++k) {  // ?x ?p ?x, or GRAPH ?g { ?g … }
    if (assigns_[k].slot != slot) continue;
    equal_[equals_++] = {assigns_[k].position, position};
    return;
  }
  assigns_[assigned_++] = {slot, position};
}

bool PatternScan::Next(TermId* row) {
  while (valid_) {
    if (first_) {
      first_ = false;
    } else if (merge_ && !checks_) {
      cursor_.NextTriple();
    } else {
      cursor_.Next();
    }
    if (!cursor_.Valid() || !context_->Poll()) break;
    if (checks_ && !Passes()) continue;
    for (int k = 0; k < assigned_; ++k) row[assigns_[k].slot] = cursor_.term(assigns_[k].position);
    return true;
  }
  Close(row);
  return false;
}

bool PatternScan::Passes() {
  const Quad quad = cursor_.quad();
  if (!GraphAllowed(quad.graph)) return false;
  if (merge_) {  // copies of a triple are adjacent
    if (quad.subject == last_.subject && quad.predicate == last_.predicate && quad.object == last_.object)
      return false;
    last_ = quad;
  }
  const auto terms = std::bit_cast<std::array<TermId, 4>>(quad);
  for (int k = 0; k < equals_; ++k) {
    if (terms[equal_[k].first] != terms[equal_[k].second]) return false;
  }
  return true;
}

uint64_t PatternScan::Count(TermId* row) {
  uint64_t count = 0;
  if (checks_ || cursor_.filters()) {
    while (Next(row)) ++count;
    return count;
  }
  if (valid_ && context_->Poll()) count = cursor_.CountRest(merge_);
  context_->Counted(count);
  Close(row);
  return count;
}

void PatternScan::Close(TermId* row) {
  if (!valid_) return;
  valid_ = false;
  for (int k = 0; k < assigned_; ++k) row[assigns_[k].slot] = TermId();
}

}  // namespace docent::sparql
