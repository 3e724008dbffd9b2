// The encoding of an XML document (XML 1.0 section 4.3.3 and appendix F): its bytes as UTF-8. Private to this folder. Any
// thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_XML_ENCODING_H_
#define DOCENT_GRAPH_RDF_FORMATS_XML_ENCODING_H_

#include <optional>
#include <string>
#include <string_view>

#include "graph/base/diagnostic.h"

namespace docent {

// Makes *text UTF-8 without a byte order mark: a part of what it was, or in `owned`. UTF-8, UTF-16, US-ASCII, ISO-8859-x,
// Windows-125x and KOI8 are read. A byte order mark tells first, then `charset` (of the transport; may be empty), then the
// XML declaration. A mistake, with its place in the text as far as it was read: another encoding, or bytes that are none
// of its characters (of UTF-8 that is left to others).
std::optional<Diagnostic> DecodeXml(const std::string& charset, std::string_view* text, std::string* owned);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_XML_ENCODING_H_
