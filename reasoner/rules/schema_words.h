// Tests of patterns and facts: are they about the schema (classes, properties, lists of axioms, equality) or
// about things? Pure; any thread.
#ifndef DOCENT_REASONER_RULES_SCHEMA_WORDS_H_
#define DOCENT_REASONER_RULES_SCHEMA_WORDS_H_

#include <string_view>

namespace docent::rules {

// True for patterns whose predicate is a word of RDFS or OWL about classes and properties, of lists, or
// owl:sameAs; and for patterns with a class of RDF, RDFS or OWL as type. Each IRI: the text of a constant,
// empty for a variable.
bool IsSchemaPattern(std::string_view predicate_iri, std::string_view object_iri);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_SCHEMA_WORDS_H_
