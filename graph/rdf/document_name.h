// Document names as parts of IRIs: a file's name, whatever characters it has, as part of the names that RDF
// has for it and for what it holds. A name of nothing but characters that may stand there is itself; different names
// give different texts. Any thread.
#ifndef DOCENT_GRAPH_RDF_DOCUMENT_NAME_H_
#define DOCENT_GRAPH_RDF_DOCUMENT_NAME_H_

#include <string>
#include <string_view>

namespace docent {

// As a part of an IRI, percent-encoded (RFC 3986 section 2.1): "a b.ttl" → "a%20b.ttl".
std::string NameInIri(std::string_view name);

// The IRI of a file (RFC 8089): "a b.ttl" in /home/x → "file:///home/x/a%20b.ttl". `path` may be relative.
std::string FileIri(const std::string& path);

// As the beginning of a blank node label, which knows no percent sign: "a (1).ttl" → "a℅20℅281℅29.ttl".
std::string NameInBlankLabel(std::string_view name);

// The beginning of the blank node labels of a document that has no name of its own: equal for equal texts, here and in
// any other process, and for practical purposes different for different ones.
std::string BlankLabelStart(std::string_view text);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_DOCUMENT_NAME_H_
