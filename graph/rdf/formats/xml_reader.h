// A reader of XML 1.0 with namespaces: libxml2's SAX2 events as our own types, with places and limits.
//
// The text is handed to libxml2 in pieces of a few KiB, and between two of them deadline and cancellation are looked at.
// Nothing is fetched: the external subset and external parameter entities are skipped, an external entity that is used
// is an error. Internal entities are written out within limits, defaults of ATTLIST declarations are attributes, other
// declarations are read and have no effect. libxml2 2.9 compares each attribute of an element with all others and looks
// prefixes up one by one, which is why both are limited. Private to this folder. One thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_XML_READER_H_
#define DOCENT_GRAPH_RDF_FORMATS_XML_READER_H_

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "absl/status/status.h"
#include "graph/rdf/formats/mistake_list.h"
#include "graph/rdf/formats/parser.h"

namespace docent {

inline constexpr std::string_view kXmlNs = "http://www.w3.org/XML/1998/namespace";

// prefix:local, or local without a prefix. Good during the event that brings it, as are all views below.
struct XmlName {
  std::string_view iri;  // of the namespace; empty: none
  std::string_view prefix, local;
};

struct XmlAttribute {
  XmlName name;
  std::string_view value;  // normalised as XML 1.0 section 3.3.3 says
};

struct XmlNamespace {
  std::string_view prefix;  // empty: the default namespace
  std::string_view iri;     // empty: the default namespace is taken back
};

// <name attributes… declarations…>
struct XmlElement {
  XmlName name;
  std::vector<XmlAttribute> attributes;
  std::vector<XmlNamespace> declarations;
};

// Receives the events of a document.
class XmlEvents {
 public:
  virtual ~XmlEvents() = default;
  virtual void OnStart(const XmlElement& element) = 0;
  virtual void OnEnd(const XmlName& name) = 0;
  // A piece of text or of a CDATA section; texts may come in several pieces.
  virtual void OnText(std::string_view text) = 0;
  virtual void OnComment(std::string_view text) = 0;
  // <?target data?>
  virtual void OnInstruction(std::string_view target, std::string_view data) = 0;
};

class XmlReader {
 public:
  // `text` is UTF-8 without a byte order mark; what its XML declaration says of an encoding does not count. What is not
  // well-formed goes to `mistakes`. All must outlive the reader.
  XmlReader(std::string_view text, const ParseRdfOptions& options, XmlEvents* events, MistakeList* mistakes);

  // Reads the document. CANCELLED or DEADLINE_EXCEEDED where options.cancellation ended it.
  absl::Status Run();

  // No further events come. During an event.
  void Stop();

  // The byte of the text where the event under way begins: '<' of a tag, the first character of a text. Of what an
  // entity's text says: where the entity is used.
  size_t EventOffset() const;
  // Of an attribute of the element that begins: the first character of its name; else the element's.
  size_t AttributeOffset(const XmlName& name);

 private:
  class Parser;  // the part that knows libxml2
  void IndexAttributes(size_t start);

  Parser* parser_ = nullptr;
  std::string_view text_;
  const ParseRdfOptions& options_;
  XmlEvents* events_;
  MistakeList* mistakes_;
  size_t indexed_tag_ = std::string_view::npos;                     // where it begins
  std::unordered_map<std::string_view, size_t> attribute_offsets_;  // of the names of its attributes
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_XML_READER_H_
