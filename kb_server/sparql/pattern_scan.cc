#include "kb_server/sparql/pattern_scan.h"

#include <algorithm>
#include <bit>

namespace docent::sparql {

bool PatternScan::OpenGraph(const GraphRef& graph, const TermId* row, QuadPattern* quad) {
  const DatasetIds& dataset = context_->dataset;
  only_ = nullptr;
  except_ = TermId();
  merge_ = false;
  if (graph.kind == GraphRef::Kind::kDefault) {
    if (dataset.is_explicit) {
      if (dataset.default_graphs.empty()) return false;
      if (dataset.default_graphs.size() == 1) {
        quad->graph = dataset.default_graphs[0];
        return true;
      }
      only_ = &dataset.default_graphs;
    } else if (dataset.strict) {
      quad->graph = dataset.default_graph;
      return true;
    }
    merge_ = true;
    return true;
  }
  if (dataset.is_explicit) {
    only_ = &dataset.named_graphs;
  } else if (dataset.strict) {
    except_ = dataset.unnamed_graph;
  }
  const TermId bound =
      graph.name.constant >= 0 ? context_->constants[graph.name.constant] : row[graph.name.slot];
  if (bound.IsNone()) {
    assigns_[assigned_++] = {graph.name.slot, 3};
    return true;
  }
  quad->graph = bound;
  return GraphAllowed(bound);
}

bool PatternScan::GraphAllowed(TermId graph) const {
  if (only_ != nullptr) return std::find(only_->begin(), only_->end(), graph) != only_->end();
  return graph != except_;
}

void PatternScan::Open(const PlanPattern& pattern, const TermId* row, EvaluationContext& context) {
  context_ = &context;
  valid_ = false;
  assigned_ = 0;
  equals_ = 0;
  QuadPattern quad;
  if (!OpenGraph(pattern.graph, row, &quad) || quad.graph.tag() == TermId::Tag::kLocal) return;
  TermId* const positions[] = {&quad.subject, &quad.predicate, &quad.object};
  for (int i = 0; i < 3; ++i) {
    const PlanTerm& term = pattern.terms[i];
    const TermId id = term.slot < 0 ? context.constants[term.constant] : row[term.slot];
    if (id.IsNone()) {
      AssignTo(term.slot, i);
    } else if (id.tag() == TermId::Tag::kLocal) {
      return;  // the store knows no such term
    } else {
      *positions[i] = id;
    }
  }
  context.version->Rescan(quad, &cursor_);
  checks_ = only_ != nullptr || !except_.IsNone() || equals_ > 0;
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
    if (quad.subject == last_.subject && quad.predicate == last_.predicate && quad.object == last_.object) return false;
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
  valid_ = false;
  for (int k = 0; k < assigned_; ++k) row[assigns_[k].slot] = TermId();
  assigned_ = 0;
}

}  // namespace docent::sparql
