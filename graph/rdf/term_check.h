// Validation of terms from outside: allowed by RDF and within the limits. Every term that enters the store
// passes this check. Any thread.
#ifndef DOCENT_GRAPH_RDF_TERM_CHECK_H_
#define DOCENT_GRAPH_RDF_TERM_CHECK_H_

#include <cstddef>
#include <string_view>

#include "absl/status/status.h"
#include "graph/rdf/term.h"

namespace docent {

// INVALID_ARGUMENT naming the fault: an IRI that is relative or holds a forbidden character, a blank node
// label or language tag outside Turtle's grammar, a literal with both language and datatype, text that is not
// UTF-8. RESOURCE_EXHAUSTED: more than `term_bytes` bytes in one part.
absl::Status CheckTerm(const Term& term, size_t term_bytes);

// Whether a literal may have this language tag.
bool IsLanguageTag(std::string_view tag);

// CheckTerm for each position, and also: the subject is no literal, the predicate is an IRI, the graph is an
// IRI, a blank node or absent. The message names the position.
absl::Status CheckQuad(const TermQuad& quad, size_t term_bytes);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_TERM_CHECK_H_
