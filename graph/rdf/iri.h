// IRIs (RFC 3987) as RDF uses them: tests for absolute IRIs and allowed characters, and resolution against a
// base (RFC 3986 section 5.2). Any thread.
#ifndef DOCENT_GRAPH_RDF_IRI_H_
#define DOCENT_GRAPH_RDF_IRI_H_

#include <cstdint>
#include <string>
#include <string_view>

namespace docent {

// True if `iri` begins with a scheme: ALPHA *( ALPHA / DIGIT / "+" / "-" / "." ) ":".
bool IsAbsoluteIri(std::string_view iri);

// True if an IRI reference (Turtle production IRIREF) may not contain `c`: controls, space and <>"{}|^`\.
inline bool IsForbiddenInIri(char32_t c) {
  // of the characters up to 0x7F, by bit: 0 to 0x20, and < > " { } | ^ ` backslash
  constexpr uint64_t kForbidden[2] = {0x50000005FFFFFFFF, 0x3800000150000000};
  return c < 0x80 && (kForbidden[c >> 6] >> (c & 63) & 1) != 0;
}

// True for an absolute IRI without forbidden characters: a valid IRI of a term in the store.
bool IsValidTermIri(std::string_view iri);

// `reference` against `base`, an absolute IRI; the result is absolute. An absolute reference stays as it is
// (RDF compares IRIs as text, so nothing is normalised there).
std::string ResolveIri(std::string_view reference, std::string_view base);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_IRI_H_
