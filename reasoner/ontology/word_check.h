// Check that every word of a document is in the vocabulary and used as declared. RDF, rules and queries. One
// thread.
#ifndef DOCENT_REASONER_ONTOLOGY_WORD_CHECK_H_
#define DOCENT_REASONER_ONTOLOGY_WORD_CHECK_H_

#include <vector>

#include "graph/rdf/formats/located_parser.h"
#include "graph/sparql/syntax/algebra.h"
#include "reasoner/ontology/finding.h"
#include "reasoner/ontology/vocabulary.h"
#include "reasoner/rules/rule_parser.h"

namespace docent::ontology {

// Checks only words of namespaces that the vocabulary covers; each once, at its first place.
//  error    undefined-term      a class, property or resource of such a namespace without declaration
//  error    wrong-kind          a property in place of a class, or a class in place of a property
//  warning  namespace           a covered namespace except for http/https, case or its last character
//  warning  unused-prefix       of RDF, see CheckPrefixes
void CheckWords(const LocatedRdf& document, const Vocabulary& vocabulary, Findings& findings);
void CheckWords(const rules::ParsedRules& rules, const Vocabulary& vocabulary, Findings& findings);
void CheckWords(const sparql::Query& query, const Vocabulary& vocabulary, Findings& findings);

//  warning  unused-prefix       a prefix that is declared and not used (Turtle and TriG, rules, queries)
void CheckPrefixes(const std::vector<PrefixPlace>& prefixes, Findings& findings);

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_WORD_CHECK_H_
