// File names as parts of IRIs and blank node labels. A name of allowed characters only stays
// as it is; all other characters are escaped; different names give different texts. Any
// thread.
#ifndef DOCENT_GRAPH_RDF_DOCUMENT_NAME_H_
#define DOCENT_GRAPH_RDF_DOCUMENT_NAME_H_

#include <string>
#include <string_view>

namespace docent {

// As a part of an IRI, percent-encoded (RFC 3986 section 2.1): "a b.ttl" → "a%20b.ttl".
std::string NameInIri(std::string_view name);

// The IRI of a file (RFC 8089): "a b.ttl" in /home/x → "file:///home/x/a%20b.ttl". `path` may be relative.
std::string FileIri(const std::string& path);

// As the beginning of a blank node label, where % is not allowed: "a (1).ttl" → "a℅20℅281℅29.ttl".
std::string NameInBlankLabel(std::string_view name);

// The beginning of the blank node labels of a document without a name: the same for equal texts in every
// process, and for practical purposes different for different texts.
std::string BlankLabelStart(std::string_view text);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_DOCUMENT_NAME_H_
