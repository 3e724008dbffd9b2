// Do a document's triples fit what the vocabulary says of their words? Findings that need no reasoner: domains and
// ranges, literals, circles, missing explanations. What contradicts itself is found by following the rules:
// kb_server/cli/consistency_check.h. One thread.
#ifndef DOCENT_REASONER_ONTOLOGY_MEANING_CHECK_H_
#define DOCENT_REASONER_ONTOLOGY_MEANING_CHECK_H_

#include <set>
#include <string>

#include "graph/rdf/formats/located_parser.h"
#include "reasoner/ontology/finding.h"
#include "reasoner/ontology/vocabulary.h"

namespace docent::ontology {

//  error    range-clash         a literal for an object property or a class range; a resource for a datatype property or
//                               range; a literal of another datatype than the range; one in a class disjoint with the range
//  error    domain-clash        a subject in a class disjoint with the domain
//  error    bad-literal         a literal whose text its datatype does not allow
//  error    disjoint-types      a class below two disjoint ones
//  warning  domain-mismatch, range-mismatch   a resource with a type that is not the domain or range, nor below it: it is
//                               taken for one, too
//  warning  missing-label, missing-comment    of a class or property that this document declares; missing both is one finding
//  warning  import              owl:imports of an ontology that no document of the vocabulary declares
//  warning  cycle               classes or properties that are each below the other
//  warning  long-list           a property chain or key of more properties than rule set owl2rl follows
// `cycles`: those that were told already, for checking several documents; each is told once.
void CheckMeaning(const LocatedRdf& document, const Vocabulary& vocabulary, std::set<std::string>* cycles,
                  Findings& findings);

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_MEANING_CHECK_H_
