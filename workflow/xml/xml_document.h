// XML text → a tree of elements whose every name, attribute value and text knows its bytes in the source.
//
// libxml2 decides whether the text is well-formed (no network, no DTD: a document type definition is refused with
// its line); a small scanner over the accepted text then builds the tree, because libxml2 tells reliable lines but
// neither columns nor byte offsets of attribute values. A property test holds the two against each other.
//
// Values and functions without state; any thread.
#ifndef DOCENT_WORKFLOW_XML_XML_DOCUMENT_H_
#define DOCENT_WORKFLOW_XML_XML_DOCUMENT_H_

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"

namespace docent::xml {

// Decoded text and the bytes that it came from: `span` covers the raw text between the quotes or tags (with
// references such as &lt; as written). A default Text (`given()` false) was not in the document.
struct Text {
  std::string value;
  SourceSpan span;

  bool given() const { return span.line > 0; }
  bool empty() const { return value.empty(); }
};

// name="value", prefix:name='value'. Namespace declarations are not attributes (see Element::namespaces).
struct Attribute {
  std::string prefix;         // as written; empty: none
  std::string name;           // local name
  std::string namespace_iri;  // of the prefix; empty: no prefix, or a prefix that is not declared
  SourceSpan name_span;
  Text value;
};

// <prefix:name attributes…> text and children </prefix:name>
struct Element {
  std::string prefix;
  std::string name;  // local name
  std::string namespace_iri;
  SourceSpan span;       // from "<" to the end of the closing tag: what an editor removes with the element
  SourceSpan name_span;  // the name in the start tag
  SourceSpan start_tag;  // "<name …>"
  std::vector<Attribute> attributes;
  std::vector<std::unique_ptr<Element>> children;
  Text text;  // the character data of this element itself, trimmed; given() only where it is not blank
  // Offset of the source byte of each byte of text.value; for carets inside of texts that hold references.
  std::vector<size_t> text_offsets;
  // Prefixes in scope ("" is the default namespace), innermost declaration. Shared with the parent where equal.
  std::shared_ptr<const std::map<std::string, std::string>> namespaces;

  // The attribute without namespace of this name; nullptr if there is none.
  const Attribute* Find(std::string_view attribute_name) const;
};

struct ParsedXml {
  std::unique_ptr<Element> root;  // null after an error
  Diagnostics diagnostics;
};

// UTF-8 only. Refused, each with its place: text over limits.document_bytes, a document type definition,
// elements deeper than limits.xml_nesting or more than limits.xml_elements, an encoding other than UTF-8, whatever is not well-formed.
ParsedXml ParseXml(std::string_view text, const std::string& file, const Limits& limits = {});

// "30s", "500ms", "5min", "1.5h" (a number and a unit; blanks between them allowed) → milliseconds.
// False for anything else, for 0, and beyond 30 days.
bool ParseDurationMs(std::string_view text, int64_t* out_ms);

}  // namespace docent::xml

#endif  // DOCENT_WORKFLOW_XML_XML_DOCUMENT_H_
