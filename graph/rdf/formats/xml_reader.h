// Reader of XML 1.0 with namespaces: libxml2's SAX2 events as our own types, with places and limits.
//
// The text is passed to libxml2 in pieces of a few KiB, and deadline and cancellation are polled between two
// of them. Nothing is fetched: the external subset and external parameter entities are skipped; the use of an
// external entity is an error. Internal entities are expanded within limits, defaults of ATTLIST declarations
// become attributes, other declarations are read and have no effect. libxml2 2.9 compares each attribute of
// an element with all others and searches prefixes linearly, so both are limited. For readers of formats, as
// those of this folder. One thread.
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

// prefix:local, or local without a prefix. Valid during the current event, as all views below.
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
  std::string_view iri;     // empty: the default namespace is removed
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
  // `text` is UTF-8 without a byte order mark; an encoding in its XML declaration is ignored. Errors of
  // well-formedness go to `mistakes`. All arguments must outlive the reader.
  XmlReader(std::string_view text, const ParseRdfOptions& options, XmlEvents* events, MistakeList* mistakes);

  // Reads the document. CANCELLED or DEADLINE_EXCEEDED if options.cancellation ended it.
  absl::Status Run();

  // Ends the events. Called during an event.
  void Stop();

  // The byte offset of the current event in the text: '<' of a tag, the first character of a text. For an
  // event from an entity's text: the place where the entity is used.
  size_t EventOffset() const;
  // For an attribute of the current element: the first character of its name; else the element's offset.
  size_t AttributeOffset(const XmlName& name);

 private:
  class Parser;  // the part that knows libxml2
  void IndexAttributes(size_t start);

  Parser* parser_ = nullptr;
  std::string_view text_;
  const ParseRdfOptions& options_;
  XmlEvents* events_;
  MistakeList* mistakes_;
  size_t indexed_tag_ = std::string_view::npos;                     // offset of the indexed tag
  std::unordered_map<std::string_view, size_t> attribute_offsets_;  // of the names of its attributes
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_XML_READER_H_
