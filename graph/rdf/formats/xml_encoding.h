// Decoder of XML documents: detects the encoding (XML 1.0 section 4.3.3 and appendix F) and converts to
// UTF-8. Private to this folder. Any thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_XML_ENCODING_H_
#define DOCENT_GRAPH_RDF_FORMATS_XML_ENCODING_H_

#include <optional>
#include <string>
#include <string_view>

#include "graph/base/diagnostic.h"

namespace docent {

// Makes *text UTF-8 without a byte order mark: a part of the old text, or in `owned`. Reads UTF-8, UTF-16,
// US-ASCII, ISO-8859-x, Windows-125x and KOI8. The encoding is given by a byte order mark, else by `charset`
// (of the transport; may be empty), else by the XML declaration. Returns a mistake, with its place, for
// another encoding, or for bytes that are invalid in it (invalid UTF-8 is checked elsewhere).
std::optional<Diagnostic> DecodeXml(const std::string& charset, std::string_view* text, std::string* owned);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_XML_ENCODING_H_
