// Pattern of a set of facts, for the order of rules with negation (negation_order.h). Private to this folder.
// Pure; any thread.
#ifndef DOCENT_REASONER_RULES_FACT_PATTERN_H_
#define DOCENT_REASONER_RULES_FACT_PATTERN_H_

#include <utility>

#include "graph/rdf/term_id.h"

namespace docent::rules {

// kNone: any term. `reflexive`: subject and object are equal; always true if both are known and equal.
struct FactPattern {
  TermId subject, predicate, object;
  bool reflexive = false;

  bool KnowsSubject() const { return !subject.IsNone() || reflexive; }
  friend bool operator==(const FactPattern&, const FactPattern&) = default;
  template <typename H>
  friend H AbslHashValue(H h, const FactPattern& p) {
    return H::combine(std::move(h), p.subject, p.predicate, p.object, p.reflexive);
  }
};

// Calls `visit` with each pattern that all facts of `p` match (a fact has all of its terms), until it returns
// true; returns whether it did. Patterns with a predicate and a subject, or reflexive ones, only with
// `also_subjects`.
template <typename Visit>
bool AnyWider(const FactPattern& p, bool also_subjects, Visit visit) {
  const TermId any;
  if (visit({any, p.predicate, p.object}) || visit({any, p.predicate, any})) return true;
  if (visit({any, any, p.object}) || visit({any, any, any})) return true;
  if (!also_subjects) return false;
  if (!p.subject.IsNone() && (visit(p) || visit({p.subject, p.predicate, any}))) return true;
  return p.reflexive && visit({any, p.predicate, any, true});
}

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_FACT_PATTERN_H_
