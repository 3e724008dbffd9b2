// Formatter of CAWL and RSEL documents: changes nothing but layout. Function without state; any thread.
//
// What changes: the indentation (two blanks a level), blanks between elements and inside of tags, empty lines (one at most
// between two pieces), lines of more than kFormatWidth characters (an element of them is written over several lines, a start
// tag is broken before an attribute). What stays: names, attributes with their order and quotes, all text, comments and
// processing instructions, which line ends an author put between attributes, and an element on one line that fits there.
// Left exactly as written: <documentation>, elements of foreign namespaces, elements that hold text beside elements or
// comments, and xml:space="preserve". Formatting what is formatted changes nothing.
#ifndef DOCENT_WORKFLOW_XML_FORMATTER_H_
#define DOCENT_WORKFLOW_XML_FORMATTER_H_

#include <string>
#include <string_view>

#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"

namespace docent::xml {

inline constexpr size_t kFormatWidth = 120;  // characters of a line

struct FormattedXml {
  std::string text;         // with a line end behind it; empty where the document cannot be read
  std::string root;         // local name of the root element
  Diagnostics diagnostics;  // as ParseXml's
  bool ok() const { return diagnostics.empty(); }
};

FormattedXml FormatXml(std::string_view text, const std::string& file, const Limits& limits = {});

}  // namespace docent::xml

#endif  // DOCENT_WORKFLOW_XML_FORMATTER_H_
