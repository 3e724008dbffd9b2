#include "reasoner/rules/report_words.h"

#include <algorithm>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::rules {

ReportWords ReportWords::Intern(Dictionary& dictionary) {
  ReportWords result;
  result.type = dictionary.InternIri(kRdfType);
  result.inconsistency = dictionary.InternIri(DocentIri("Inconsistency"));
  result.words[kRule] = dictionary.InternIri(DocentIri("rule"));
  result.words[kEvidence] = dictionary.InternIri(DocentIri("evidence"));
  result.words[kBinding] = dictionary.InternIri(DocentIri("binding"));
  result.words[kBindingName] = dictionary.InternIri(DocentIri("bindingName"));
  result.words[kBindingValue] = dictionary.InternIri(DocentIri("bindingValue"));
  const auto rdf = [&](const char* word) { return dictionary.InternIri(Concat(kRdfNs, word)); };
  result.words[kSubject] = rdf("subject");
  result.words[kPredicate] = rdf("predicate");
  result.words[kObject] = rdf("object");
  return result;
}

bool ReportWords::AreNamedBy(const QuadPattern& pattern) const {
  if (pattern.predicate == type) return pattern.object == inconsistency;
  const auto end = words.begin() + kSubject;
  return !pattern.predicate.IsNone() && std::find(words.begin(), end, pattern.predicate) != end;
}

}  // namespace docent::rules
