// Words of the reports of checks (inconsistency.h). Private to this folder. Value; Intern: writer thread only.
#ifndef DOCENT_REASONER_RULES_REPORT_WORDS_H_
#define DOCENT_REASONER_RULES_REPORT_WORDS_H_

#include <algorithm>
#include <array>
#include <cstdint>

#include "graph/rdf/dictionary.h"
#include "graph/store/quad.h"

namespace docent::rules {

struct ReportWords {
  enum Word : uint8_t {
    kRule,
    kEvidence,
    kBinding,
    kBindingName,
    kBindingValue,
    kSubject,  // from here on words of RDF
    kPredicate,
    kObject,
    kWords
  };
  std::array<TermId, kWords> words;  // kNone: not interned yet
  TermId type, inconsistency;

  static ReportWords Intern(Dictionary& dictionary);

  // True if a fact with these terms has the form of a report's fact.
  bool Describe(TermId predicate, TermId object) const {
    return predicate == type ? object == inconsistency
                             : std::find(words.begin(), words.end(), predicate) != words.end();
  }
  // True for a pattern that matches hardly anything else: it has a word of Docent.
  bool AreNamedBy(const QuadPattern& pattern) const;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_REPORT_WORDS_H_
