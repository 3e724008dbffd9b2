// How a quad is laid out as a key in each index order. Included only by files of this folder.
#ifndef DOCENT_KB_SERVER_STORE_INDEX_ORDER_H_
#define DOCENT_KB_SERVER_STORE_INDEX_ORDER_H_

#include "kb_server/store/graph_version.h"

namespace docent {

// Positions of a quad, in the sequence of its fields.
inline QuadTree::Key KeyOf(const Quad& q, IndexOrder order) {
  uint64_t s = q.subject.bits(), p = q.predicate.bits(), o = q.object.bits(), g = q.graph.bits();
  switch (order) {
    case IndexOrder::kSpog:
      return {s, p, o, g};
    case IndexOrder::kPosg:
      return {p, o, s, g};
    case IndexOrder::kOspg:
      return {o, s, p, g};
    case IndexOrder::kGspo:
      break;
  }
  return {g, s, p, o};
}

inline Quad QuadOf(const QuadTree::Key& k, IndexOrder order) {
  switch (order) {
    case IndexOrder::kSpog:
      return {TermId(k[0]), TermId(k[1]), TermId(k[2]), TermId(k[3])};
    case IndexOrder::kPosg:
      return {TermId(k[2]), TermId(k[0]), TermId(k[1]), TermId(k[3])};
    case IndexOrder::kOspg:
      return {TermId(k[1]), TermId(k[2]), TermId(k[0]), TermId(k[3])};
    case IndexOrder::kGspo:
      break;
  }
  return {TermId(k[1]), TermId(k[2]), TermId(k[3]), TermId(k[0])};
}

// The keys of `order` that agree with the pattern's bound words up to the first unbound one.
struct KeyRange {
  QuadTree::Key first;
  QuadTree::Key last;
  bool exact;  // no word after the first unbound one is bound
};

inline KeyRange RangeOf(const QuadPattern& p, IndexOrder order) {
  KeyRange range{KeyOf(Quad{p.subject, p.predicate, p.object, p.graph}, order), {}, true};
  range.last = range.first;
  bool open = false;
  for (int i = 0; i < 4; ++i) {
    if (open && range.first[i] != 0) range.exact = false;
    if (range.first[i] == 0) open = true;
    if (open) {
      range.first[i] = 0;
      range.last[i] = ~uint64_t{0};
    }
  }
  return range;
}

}  // namespace docent

#endif  // DOCENT_KB_SERVER_STORE_INDEX_ORDER_H_
