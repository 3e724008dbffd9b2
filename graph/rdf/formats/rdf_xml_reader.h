// Reader of RDF/XML (RDF 1.1 XML Syntax, section 7.2): XML events → quads. Private to this folder. One
// thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_RDF_XML_READER_H_
#define DOCENT_GRAPH_RDF_FORMATS_RDF_XML_READER_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "graph/rdf/formats/declared_prefixes.h"
#include "graph/rdf/formats/mistake_list.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/place_recorder.h"
#include "graph/rdf/formats/quad_collector.h"
#include "graph/rdf/formats/rdf_xml_attributes.h"
#include "graph/rdf/formats/xml_literal.h"
#include "graph/rdf/formats/xml_reader.h"

namespace docent {

class RdfXmlReader : private XmlEvents {
 public:
  // `text` is UTF-8 without a byte order mark. `places` receives the places of quads; may be null.
  RdfXmlReader(std::string_view text, const ParseRdfOptions& options, PlaceRecorder* places);

  ParsedRdf Run();

 private:
  // Kind of an open element.
  enum class Kind {
    kRdf,         // rdf:RDF: nodes inside
    kNode,        // a node element, or a property with rdf:parseType="Resource": properties inside
    kProperty,    // a property element with a text or a node inside
    kEmpty,       // a property element with all content in attributes
    kCollection,  // rdf:parseType="Collection": nodes inside
    kLiteral,     // rdf:parseType="Literal"
    kSkipped,     // a mistake: its content is skipped
  };
  struct Frame {
    Kind kind = Kind::kSkipped;
    size_t at = 0;                    // offset of the start tag
    Term node;                        // kNode: the subject of the properties inside
    Term predicate;                   // of a property's triple; its subject is the node around it
    std::string statement;            // IRI of the reified triple, of rdf:ID; empty: none
    std::string datatype;             // kProperty
    std::string text;                 // kProperty
    Term last;                        // kCollection: the last cell of the list; empty: none yet
    bool has_node = false;            // kProperty: a node was inside
    bool text_refused = false;        // text in a wrong place has been reported
    uint64_t members = 0;             // rdf:li inside
    size_t bases = 0, languages = 0;  // sizes of the stacks outside this element
  };

  void OnStart(const XmlElement& element) override;
  void OnEnd(const XmlName& name) override;
  void OnText(std::string_view text) override;
  void OnComment(std::string_view text) override;
  void OnInstruction(std::string_view target, std::string_view data) override;

  // Each sets the kind of the element's frame, which is the last one; after a mistake it stays kSkipped.
  void StartElement(const XmlElement& element, const RdfXmlAttributes& attributes);
  void StartRdf(const XmlElement& element);
  void StartNode(const XmlElement& element, const RdfXmlAttributes& attributes);
  void StartProperty(const XmlElement& element, const RdfXmlAttributes& attributes);
  void StartParseType(const XmlElement& element, const RdfXmlAttributes& attributes);
  void StartEmpty(const RdfXmlAttributes& attributes);

  // xml:base and xml:lang. False: a mistake.
  bool EnterScope(const RdfXmlAttributes& attributes);
  bool ReadSubject(const RdfXmlAttributes& attributes, Term* subject);
  bool ReadPredicate(const XmlElement& element, Term* predicate);
  // The IRI of the name.
  bool ReadName(const XmlName& name, Term* iri);
  // An attribute's value: as an IRI against the base; as an IRI named once (rdf:ID); as a blank node
  // (rdf:nodeID).
  bool ReadReference(const XmlAttribute& attribute, Term* iri);
  bool ReadId(const XmlAttribute& attribute, std::string* iri);
  bool ReadNodeId(const XmlAttribute& attribute, Term* node);
  bool CheckIri(const XmlName& attribute, std::string iri, Term* to);
  void AddPropertyAttributes(const Term& subject, const RdfXmlAttributes& attributes);

  // Connects a node inside a property or a collection with the enclosing element.
  void LinkNode(const Term& node);
  void FinishProperty();
  void FinishCollection();

  // The triple of the property in frames_[property], with its reification.
  void AddTriple(size_t property, Term object);
  void Add(TermQuad quad, size_t subject_at, size_t at);
  Term Text(std::string text) const;  // with the language in scope

  void Error(size_t offset, std::string message, std::string hint = "");
  void ErrorAt(const XmlName& attribute, std::string message, std::string hint = "");
  void WarnOfUnknown(const XmlName& name, size_t offset);
  void RefuseText(std::string_view text);
  void RefuseLength();
  void BoundLiteral();

  const ParseRdfOptions& options_;
  PlaceRecorder* places_;  // may be null
  MistakeList mistakes_;
  XmlReader xml_;
  QuadCollector collector_;
  DeclaredPrefixes prefixes_;
  std::vector<Frame> frames_;
  std::vector<std::string> bases_, languages_;  // of xml:base and xml:lang in scope
  size_t base_bytes_ = 0;                       // of bases_
  XmlLiteral literal_;
  absl::flat_hash_set<std::string> ids_;            // IRIs of all rdf:ID so far
  absl::flat_hash_map<std::string, Term> renamed_;  // nodes whose rdf:nodeID other syntaxes cannot write
  bool rdf_declared_ = false;                       // the RDF namespace has a prefix somewhere
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_RDF_XML_READER_H_
