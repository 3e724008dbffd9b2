#include "kb_server/sparql/pattern_scan.h"

#include <algorithm>

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
    assign_[3] = graph.name.slot;
    ++assigns_;
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
  assigns_ = 0;
  repeats_ = false;
  assign_[3] = -1;
  QuadPattern quad;
  TermId* const positions[] = {&quad.subject, &quad.predicate, &quad.object};
  bool possible = OpenGraph(pattern.graph, row, &quad) && quad.graph.tag() != TermId::Tag::kLocal;
  for (int i = 0; i < 3; ++i) {
    assign_[i] = -1;
    same_as_[i] = -1;
    const PlanTerm& term = pattern.terms[i];
    if (term.slot < 0) {
      *positions[i] = context.constants[term.constant];
    } else if (!row[term.slot].IsNone()) {
      *positions[i] = row[term.slot];
    } else {
      for (int k = 0; k < i; ++k) {
        if (pattern.terms[k].slot == term.slot) same_as_[i] = k;
      }
      if (same_as_[i] < 0) {
        assign_[i] = term.slot;
        ++assigns_;
      } else {
        repeats_ = true;
      }
    }
    possible &= positions[i]->tag() != TermId::Tag::kLocal;
  }
  // GRAPH ?g { ?g … }: the graph's own variable may stand in a position, too
  if (assign_[3] >= 0) {
    for (int i = 0; i < 3; ++i) {
      if (assign_[i] == assign_[3]) repeats_ = true;
    }
  }
  if (!possible) return;
  if (known_) {
    context.version->Rescan(quad, &cursor_);
  } else {
    cursor_ = context.version->Scan(quad);
    known_ = true;
  }
  last_ = Quad{};
  valid_ = true;
  first_ = true;
}

bool PatternScan::Next(TermId* row) {
  while (valid_) {
    if (first_) {
      first_ = false;
    } else {
      cursor_.Next();
    }
    if (!cursor_.Valid() || !context_->Poll()) break;
    const Quad& quad = cursor_.quad();
    if ((only_ != nullptr || !except_.IsNone()) && !GraphAllowed(quad.graph)) continue;
    if (merge_) {  // copies of a triple are adjacent
      if (quad.subject == last_.subject && quad.predicate == last_.predicate && quad.object == last_.object)
        continue;
      last_ = quad;
    }
    const TermId terms[] = {quad.subject, quad.predicate, quad.object, quad.graph};
    if (repeats_) {
      bool same = true;
      for (int i = 0; i < 3; ++i) {
        if (same_as_[i] >= 0) same &= terms[i] == terms[same_as_[i]];
        if (assign_[3] >= 0 && assign_[i] == assign_[3]) same &= terms[i] == terms[3];
      }
      if (!same) continue;
    }
    if (assigns_ > 0) {
      for (int i = 0; i < 4; ++i) {
        if (assign_[i] >= 0) row[assign_[i]] = terms[i];
      }
    }
    return true;
  }
  Close(row);
  return false;
}

void PatternScan::Close(TermId* row) {
  valid_ = false;
  if (assigns_ == 0) return;
  for (int& slot : assign_) {
    if (slot >= 0) row[slot] = TermId();
    slot = -1;
  }
  assigns_ = 0;
}

}  // namespace docent::sparql
