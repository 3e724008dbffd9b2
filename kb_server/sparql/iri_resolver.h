// Relative IRI references against a base (RFC 3986 section 5.2). Pure functions.
#ifndef DOCENT_KB_SERVER_SPARQL_IRI_RESOLVER_H_
#define DOCENT_KB_SERVER_SPARQL_IRI_RESOLVER_H_

#include <string>
#include <string_view>

namespace docent::sparql {

// True if `iri` begins with a scheme ("http:", "urn:").
bool IsAbsoluteIri(std::string_view iri);
// `reference` resolved against `base`, which must be absolute. An absolute reference comes back as it is.
std::string ResolveIri(std::string_view base, std::string_view reference);

}  // namespace docent::sparql

#endif  // DOCENT_KB_SERVER_SPARQL_IRI_RESOLVER_H_
