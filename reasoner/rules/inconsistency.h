// Inconsistency reports: facts that a check (a rule without head) makes of each solution. Queries,
// subscriptions and conditions see inconsistencies like all other facts.
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
// check makes these facts; equality of things named in a report makes no second report. Rules may match
// reports, add facts to them with other words, and type other things as inconsistencies: a report is
// recognised by its IRI. For this folder and reasoner/explain. Writer thread only: interns.
#ifndef DOCENT_REASONER_RULES_INCONSISTENCY_H_
#define DOCENT_REASONER_RULES_INCONSISTENCY_H_

#include <string>
#include <string_view>
#include <vector>

#include "absl/types/span.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "reasoner/rules/report_words.h"
#include "reasoner/rules/rule_program.h"

namespace docent::rules {

class InconsistencyFacts {
 public:
  explicit InconsistencyFacts(Dictionary& dictionary) : dictionary_(dictionary) {}
  // Appends the facts of the report that the body of `rule` holds with `row`.
  void Make(const CompiledRule& rule, absl::Span<const TermId> row, std::vector<Triple>& out);
  // True for a fact of this form about a report. Call InternWords first.
  bool IsOfReport(const Triple& t) const {
    return words_.Describe(t.predicate, t.object) && t.subject.IsIri() &&
           dictionary_.Lexical(t.subject).starts_with(kPrefix);
  }
  // True if such a fact may be about a report of the check `rule`.
  bool MayBeOf(const CompiledRule& rule, const Triple& t) const;
  // Interns the words.
  void InternWords();
  // The turn is refused: what it interned is gone.
  void ForgetWords() { words_ = {}; }
  // All such facts of `graph`.
  std::vector<Triple> FactsIn(const GraphVersion& graph) const;

 private:
  static constexpr std::string_view kPrefix = "urn:docent:inconsistency:";
  static std::string PrefixOf(const CompiledRule& rule);  // of its reports' IRIs

  Dictionary& dictionary_;
  ReportWords words_;  // kNone: not interned yet
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_INCONSISTENCY_H_
