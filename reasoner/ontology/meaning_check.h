// Check of a document's triples against the declarations of their words. It finds what needs no reasoner:
// wrong domains and ranges, bad literals, cycles, missing documentation. Contradictions are found by applying
// the rules: kb_server/cli/consistency_check.h. One thread.
#ifndef DOCENT_REASONER_ONTOLOGY_MEANING_CHECK_H_
#define DOCENT_REASONER_ONTOLOGY_MEANING_CHECK_H_

#include <set>
#include <string>

#include "graph/rdf/formats/located_parser.h"
#include "reasoner/ontology/finding.h"
#include "reasoner/ontology/vocabulary.h"

namespace docent::ontology {

//  error    range-clash         a literal for an object property or a class range; a resource for a datatype
//                               property or range; a literal of another datatype than the range; one in a
//                               class disjoint with the range
//  error    domain-clash        a subject in a class disjoint with the domain
//  error    bad-literal         a literal whose text its datatype does not allow
//  error    disjoint-types      a class below two disjoint ones
//  warning  domain-mismatch, range-mismatch     a resource whose type is neither the domain or range nor below
//                               it: it is inferred to be in that class, too
//  warning  missing-label, missing-comment      of a class or property that this document declares;
//                               missing both is one finding
//  warning  import              owl:imports of an ontology that no document of the vocabulary declares
//  warning  cycle               classes or properties that are each below the other
//  warning  long-list           a property chain or key with more properties than rule set owl2rl supports
// `cycles`: those reported already, for checks of several documents; each is reported once.
void CheckMeaning(const LocatedRdf& document, const Vocabulary& vocabulary, std::set<std::string>* cycles,
                  Findings& findings);

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_MEANING_CHECK_H_
