// What a check (a rule without head) says of each of its solutions: facts, so that queries, subscriptions and
// conditions see inconsistencies as they see everything else.
//
//   <urn:docent:inconsistency:cax-dw:6f0c…> a docent:Inconsistency ;
//       docent:rule "cax-dw" ; docent:evidence <urn:docent:inconsistency:cax-dw:6f0c…:1>, … .
//   <urn:docent:inconsistency:cax-dw:6f0c…:1> rdf:subject ex:r1 ; rdf:predicate rdf:type ; rdf:object
//   ex:Robot .
//
// The IRI follows from the rule's name and the matched triples alone, so it is the same in every computation.
// Private to this folder. Writer thread only: interns.
#ifndef DOCENT_REASONER_RULES_INCONSISTENCY_H_
#define DOCENT_REASONER_RULES_INCONSISTENCY_H_

#include <vector>

#include "absl/types/span.h"
#include "kb_server/rdf/dictionary.h"
#include "reasoner/rules/rule_program.h"

namespace docent {

class InconsistencyFacts {
 public:
  explicit InconsistencyFacts(Dictionary& dictionary) : dictionary_(dictionary) {}
  // Appends the facts that say that the body of `rule` holds with `row`.
  void Make(const CompiledRule& rule, absl::Span<const TermId> row, std::vector<Triple>& out) const;

 private:
  Dictionary& dictionary_;
};

}  // namespace docent

#endif  // DOCENT_REASONER_RULES_INCONSISTENCY_H_
