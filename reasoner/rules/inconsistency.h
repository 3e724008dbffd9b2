// Inconsistency reports: facts that a check (a rule without head) makes of each solution. Queries,
// subscriptions and conditions see inconsistencies like all other facts. No rule sees them (InconsistencyFacts hides
// them from all bodies): what follows from facts does not depend on what is said about them.
//
//   <urn:docent:inconsistency:cax-dw:6f0c…> a docent:Inconsistency ;
//       docent:rule "cax-dw" ; docent:evidence <urn:docent:inconsistency:cax-dw:6f0c…:1>, … .
//   <urn:docent:inconsistency:cax-dw:6f0c…:1> rdf:subject ex:r1 ; rdf:predicate rdf:type ;
//       rdf:object ex:Robot .
//
// For a body with more than triple patterns and filters (UNION, sub-SELECTs …), the evidence is the
// triples that every solution must have matched, and its variables are reported as well:
//
//   <urn:docent:inconsistency:busy:1d07…> docent:binding
//       <urn:docent:inconsistency:busy:1d07…:variable:n> .
//   <urn:docent:inconsistency:busy:1d07…:variable:n> docent:bindingName "n" ; docent:bindingValue 2 .
//
// The IRI depends only on the rule and the solution, so every computation gives the same IRI. Only its
// check makes these facts, in docent:inferred, also if they are told; equality of things named in a report makes no second
// report. Facts about a report with other words, and other things of the type docent:Inconsistency, are ordinary facts: a
// report is recognised by these words and its IRI. For this folder and reasoner/explain. Writer thread only: interns.
#ifndef DOCENT_REASONER_RULES_INCONSISTENCY_H_
#define DOCENT_REASONER_RULES_INCONSISTENCY_H_

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "absl/types/span.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/hidden_triples.h"
#include "reasoner/rules/rule_program.h"

namespace docent::rules {

class InconsistencyFacts final : public HiddenTriples {
 public:
  explicit InconsistencyFacts(Dictionary& dictionary) : dictionary_(dictionary) {}
  // Appends the facts of the report that the body of `rule` holds with `row`.
  void Make(const CompiledRule& rule, absl::Span<const TermId> row, std::vector<Triple>& out);
  // True for a fact of this form about a report. Call InternWords first.
  bool IsOfReport(const Triple& t) const {
    return IsWorded(t.predicate, t.object) && t.subject.IsIri() &&
           dictionary_.Lexical(t.subject).starts_with(kPrefix);
  }
  bool MayHide(const QuadPattern& pattern) const override {
    return pattern.predicate.IsNone() || IsWorded(pattern.predicate, pattern.object);
  }
  bool Hides(const Quad& quad) const override {
    return IsOfReport({quad.subject, quad.predicate, quad.object});
  }
  // True for a pattern of these words (empty: a variable) that only reports are expected to match.
  static bool AreNamedBy(std::string_view predicate, std::string_view object);
  // Interns the words.
  void InternWords();
  // The turn is refused: what it interned is gone.
  void ForgetWords() {
    type_ = inconsistency_ = TermId();
    words_.fill(TermId());
  }

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

  // True if a fact of a report may have this predicate and object (kNone: any).
  bool IsWorded(TermId predicate, TermId object) const {
    if (predicate == type_) return object.IsNone() || object == inconsistency_;
    return std::find(words_.begin(), words_.end(), predicate) != words_.end();
  }

  Dictionary& dictionary_;
  std::array<TermId, kWords> words_;  // kNone: not interned yet
  TermId type_, inconsistency_;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_INCONSISTENCY_H_
