// Inconsistency reports: facts that a check (a rule without head) makes of each solution, so that queries, subscriptions and
// conditions see inconsistencies as they see everything else.
//
//   <urn:docent:inconsistency:cax-dw:6f0c…> a docent:Inconsistency ;
//       docent:rule "cax-dw" ; docent:evidence <urn:docent:inconsistency:cax-dw:6f0c…:1>, … .
//   <urn:docent:inconsistency:cax-dw:6f0c…:1> rdf:subject ex:r1 ; rdf:predicate rdf:type ; rdf:object
//   ex:Robot .
//
// Of a body that is more than triple patterns with filters (UNION, sub-SELECTs …), the evidence is what every solution
// must have matched, and its variables are told besides:
//
//   <urn:docent:inconsistency:busy:1d07…> docent:binding <urn:docent:inconsistency:busy:1d07…:variable:n> .
//   <urn:docent:inconsistency:busy:1d07…:variable:n> docent:bindingName "n" ; docent:bindingValue 2 .
//
// The IRI follows from the rule and the solution alone, so it is the same in every computation.
// Nothing but its check makes these facts: that what a report names is the same as another thing is no second
// report. Rules may match them, and say more about a report with words of their own, and call things of their own
// inconsistencies: a report is what has such an IRI, whoever asks and whenever.
// For this folder and reasoner/explain. Writer thread only: interns.
#ifndef DOCENT_REASONER_RULES_INCONSISTENCY_H_
#define DOCENT_REASONER_RULES_INCONSISTENCY_H_

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "absl/types/span.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "reasoner/rules/rule_program.h"

namespace docent::rules {

class InconsistencyFacts {
 public:
  explicit InconsistencyFacts(Dictionary& dictionary) : dictionary_(dictionary) {}
  // Appends the facts that say that the body of `rule` holds with `row`.
  void Make(const CompiledRule& rule, absl::Span<const TermId> row, std::vector<Triple>& out);
  // A fact of such a form about a report. InternWords comes first.
  bool IsOfReport(const Triple& t) const {
    const bool worded = t.predicate == type_
                            ? t.object == inconsistency_
                            : std::find(words_.begin(), words_.end(), t.predicate) != words_.end();
    return worded && t.subject.IsIri() && dictionary_.Lexical(t.subject).starts_with(kPrefix);
  }
  // Makes the words ready.
  void InternWords();
  // All such facts of `graph`.
  std::vector<Triple> FactsIn(const GraphVersion& graph) const;

 private:
  enum Word : uint8_t {
    kRule,
    kEvidence,
    kSubject,
    kPredicate,
    kObject,
    kBinding,
    kBindingName,
    kBindingValue,
    kWords
  };
  static constexpr std::string_view kPrefix = "urn:docent:inconsistency:";

  Dictionary& dictionary_;
  std::array<TermId, kWords> words_;  // none: not said yet
  TermId type_, inconsistency_;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_INCONSISTENCY_H_
