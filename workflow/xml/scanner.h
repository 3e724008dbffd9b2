// The tree of a text that CheckWellFormed accepted, with exact bytes. Any thread.
#ifndef DOCENT_WORKFLOW_XML_SCANNER_H_
#define DOCENT_WORKFLOW_XML_SCANNER_H_

#include <memory>
#include <string_view>

#include "workflow/xml/xml_document.h"

namespace docent::xml {

// Line and column of byte offsets that are asked for in any order, in O(log lines), however long the lines are.
class LineIndex {
 public:
  explicit LineIndex(std::string_view text);
  SourceSpan Span(size_t offset, size_t length) const;

 private:
  std::string_view text_;
  // Unicode code points that begin before `offset`.
  size_t CodePointsBefore(size_t offset) const;

  std::vector<size_t> starts_;       // of the lines
  std::vector<size_t> code_points_;  // before each block of kBlock bytes
};

// Null if the text is not what the scanner understands as well-formed XML without DTD (never for a text that
// CheckWellFormed accepts; it reads no byte outside of `text` in any case).
std::unique_ptr<Element> ScanXml(std::string_view text);

}  // namespace docent::xml

#endif  // DOCENT_WORKFLOW_XML_SCANNER_H_
