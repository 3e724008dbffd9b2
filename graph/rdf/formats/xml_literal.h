// The lexical form of an rdf:XMLLiteral: the content of a property element with rdf:parseType="Literal", as
// exclusive canonical XML with comments (RDF/XML section 7.2.17; Exclusive XML Canonicalization 1.0, no
// inclusive prefixes). Private to this folder. One thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_XML_LITERAL_H_
#define DOCENT_GRAPH_RDF_FORMATS_XML_LITERAL_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/rdf/formats/xml_reader.h"

namespace docent {

class XmlLiteral {
 public:
  void Start(const XmlElement& element);
  void End(const XmlName& name);
  void Text(std::string_view text);
  void Comment(std::string_view text);
  void Instruction(std::string_view target, std::string_view data);

  size_t size() const { return out_.size(); }
  // Number of open elements.
  size_t depth() const { return marks_.size(); }
  // Moves the text out; the literal is empty afterwards, and has no open elements.
  std::string Take();
  // Drops the text so far; open elements stay open.
  void DropText() { out_.clear(); }

 private:
  // Declares the prefix of a name in the current tag, unless an enclosing element has declared it.
  void Use(const XmlName& name);
  std::string_view Declared(std::string_view prefix) const;

  std::string out_;
  // Declarations written by open elements: prefix → namespaces, the innermost last.
  absl::flat_hash_map<std::string, std::vector<std::string>> declared_;
  std::vector<std::string> undo_;                                   // prefixes in order of their declaration
  std::vector<size_t> marks_;                                       // size of undo_ before each open element
  std::vector<std::pair<std::string_view, std::string_view>> now_;  // declarations of the current element
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_XML_LITERAL_H_
