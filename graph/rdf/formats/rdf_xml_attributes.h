// The attributes of an RDF/XML element, sorted by meaning (RDF/XML sections 6.1.4 and 7.2), and the rules for
// element names. Private to this folder. One thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_RDF_XML_ATTRIBUTES_H_
#define DOCENT_GRAPH_RDF_FORMATS_RDF_XML_ATTRIBUTES_H_

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/rdf/formats/xml_reader.h"

namespace docent {

// Names of the RDF namespace: those of the grammar, rdf:RDF to rdf:bagID, and those that RDF 1.2 adds as
// attributes. kOther: any other name of it; kForeign: a name of another namespace.
enum class RdfName {
  kForeign,
  kOther,
  kRdf,
  kDescription,
  kId,
  kAbout,
  kParseType,
  kResource,
  kNodeId,
  kDatatype,
  kLi,
  kType,
  kAboutEach,
  kAboutEachPrefix,
  kBagId,
  kVersion,
  kAnnotation,
};
RdfName RdfNameOf(const XmlName& name);

// RDF/XML section 5.1: a namespace that is RDF's own with more behind it is not permitted.
bool IsLongerThanRdfNs(std::string_view name_space);

// RDF/XML section 7.2.2 and following: whether a node element or a property element may have this name.
bool MayBeNode(RdfName name);
bool MayBeProperty(RdfName name);

// True for an NCName (Namespaces in XML [4]), the form of rdf:ID and rdf:nodeID.
bool IsNcName(std::string_view text);

// A property attribute: it states a triple, and its name is the predicate.
struct PropertyAttribute {
  const XmlAttribute* attribute;
  bool is_type;  // rdf:type, whose value is an IRI
};

// Null: not given. Valid as long as the element.
struct RdfXmlAttributes {
  const XmlAttribute* id = nullptr;
  const XmlAttribute* about = nullptr;
  const XmlAttribute* node_id = nullptr;
  const XmlAttribute* resource = nullptr;
  const XmlAttribute* datatype = nullptr;
  const XmlAttribute* parse_type = nullptr;
  const XmlAttribute* base = nullptr;      // xml:base
  const XmlAttribute* language = nullptr;  // xml:lang
  std::vector<PropertyAttribute> properties;
};

// Reports a mistake at an attribute.
using ReportAttribute = std::function<void(const XmlName& name, std::string message, std::string hint)>;

// False: a mistake, which is reported. Attributes whose names begin with "xml" are left out (section 6.1.2).
bool SortAttributes(const XmlElement& element, const ReportAttribute& report, RdfXmlAttributes* out);

// "e:p", for messages.
std::string WrittenName(const XmlName& name);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_RDF_XML_ATTRIBUTES_H_
