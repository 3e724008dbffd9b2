#include "graph/rdf/formats/rdf_xml_reader.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

constexpr std::string_view kSpace = " \t\r\n";
constexpr std::string_view kSchemaInstanceNs = "http://www.w3.org/2001/XMLSchema-instance";
constexpr size_t kBytesOfPlaces = 300;  // of a quad
constexpr size_t kShown = 40;           // bytes of a stray text in its message

std::string RdfIri(std::string_view local) {
  return Concat(kRdfNs, local);
}

// The beginning of a text, cut at a character boundary.
std::string Beginning(std::string_view text) {
  size_t end = std::min(text.find_first_of("\r\n"), text.size());
  if (end <= kShown) return std::string(text.substr(0, end));
  end = kShown;
  while ((static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return Concat(text.substr(0, end), "…");
}

}  // namespace

RdfXmlReader::RdfXmlReader(std::string_view text, const ParseRdfOptions& options, PlaceRecorder* places)
    : options_(options),
      places_(places),
      mistakes_(text, options),
      xml_(text, options, this, &mistakes_),
      collector_(options.blank_node_scope, options.limits, options.memory),
      bases_{options.base_iri},
      languages_{""} {}

ParsedRdf RdfXmlReader::Run() {
  ParsedRdf parsed;
  parsed.stopped = xml_.Run();
  if (parsed.stopped.ok()) parsed.stopped = collector_.stopped();
  parsed.prefixes = prefixes_.Take();
  parsed.diagnostics = mistakes_.Take();
  if (parsed.ok()) parsed.quads = collector_.TakeQuads();
  return parsed;
}

void RdfXmlReader::Error(size_t offset, std::string message, std::string hint) {
  mistakes_.Error(offset, std::move(message), std::move(hint));
  if (mistakes_.full()) xml_.Stop();
}

void RdfXmlReader::ErrorAt(const XmlName& attribute, std::string message, std::string hint) {
  Error(xml_.AttributeOffset(attribute), std::move(message), std::move(hint));
}

void RdfXmlReader::OnStart(const XmlElement& element) {
  for (const XmlNamespace& declared : element.declarations) {
    if (!declared.iri.empty()) prefixes_.Declare(declared.prefix, std::string(declared.iri));
    rdf_declared_ = rdf_declared_ || declared.iri == kRdfNs;
    if (IsLongerThanRdfNs(declared.iri)) {
      Error(xml_.EventOffset(), Concat("the namespace <", declared.iri, "> only begins like that of RDF"),
            Concat("RDF/XML does not permit it; RDF's own is ", kRdfNs));
    }
  }
  if (!frames_.empty() && frames_.back().kind == Kind::kLiteral) {
    literal_.Start(element);
    return BoundLiteral();
  }
  Frame& frame = frames_.emplace_back();
  frame.bases = bases_.size();
  frame.languages = languages_.size();
  if (frames_.size() > 1 && frames_[frames_.size() - 2].kind == Kind::kSkipped) return;
  frame.at = xml_.EventOffset();
  RdfXmlAttributes attributes;
  const auto report = [this](const XmlName& name, std::string message, std::string hint) {
    ErrorAt(name, std::move(message), std::move(hint));
  };
  if (!SortAttributes(element, report, &attributes) || !EnterScope(attributes)) return;
  StartElement(element, attributes);
}

void RdfXmlReader::StartElement(const XmlElement& element, const RdfXmlAttributes& attributes) {
  const size_t at = frames_.back().at;
  if (frames_.size() == 1) {
    if (RdfNameOf(element.name) == RdfName::kRdf) return StartRdf(element);
    if (!rdf_declared_) {
      mistakes_.Warning(at, "no element here is of the RDF namespace", "is this document RDF/XML?");
    }
    return StartNode(element, attributes);
  }
  Frame& around = frames_[frames_.size() - 2];
  switch (around.kind) {
    case Kind::kNode:
      return StartProperty(element, attributes);
    case Kind::kEmpty:
      return Error(at, "an element inside of a property that its attributes give its value",
                   "take the attribute or the element away");
    case Kind::kProperty:
      if (around.has_node) {
        return Error(at, "a second node inside of a property element",
                     "write the property once for each, or rdf:parseType=\"Collection\" for a list");
      }
      if (!around.datatype.empty()) {
        return Error(at, "an element inside of a property with rdf:datatype", "a literal is a text");
      }
      if (around.text.find_first_not_of(kSpace) != std::string::npos) {
        return Error(at, Concat("an element after the text '", Beginning(around.text), "' in one property"),
                     "write one of them alone, or rdf:parseType=\"Literal\" for a text with markup");
      }
      return StartNode(element, attributes);
    default:
      return StartNode(element, attributes);
  }
}

// Section 7.2.9: rdf:RDF has no attributes except xml: ones and the schema hints of editors.
void RdfXmlReader::StartRdf(const XmlElement& element) {
  for (const XmlAttribute& attribute : element.attributes) {
    const XmlName& name = attribute.name;
    if (name.prefix == "xml" || name.iri == kSchemaInstanceNs) continue;
    if (name.iri == kRdfNs && name.local == "version") continue;  // CheckVersion
    return ErrorAt(
        name,
        Concat(WrittenName(name), " is an attribute of rdf:RDF, which is not a node and has no properties"),
        "write it on the node that it describes");
  }
  frames_.back().kind = Kind::kRdf;
}

void RdfXmlReader::StartNode(const XmlElement& element, const RdfXmlAttributes& attributes) {
  const RdfName name = RdfNameOf(element.name);
  const size_t at = frames_.back().at;
  if (!MayBeNode(name)) {
    return Error(at, Concat(WrittenName(element.name), " may not be a node element"),
                 name == RdfName::kRdf ? "rdf:RDF encloses the whole document" : "");
  }
  Term type, node;
  if (!ReadName(element.name, &type) || !ReadSubject(attributes, &node)) return;
  if (name == RdfName::kOther) WarnOfUnknown(element.name, at);
  LinkNode(node);
  if (name != RdfName::kDescription)
    Add({node, Term::Iri(std::string(kRdfType)), std::move(type), {}}, at, at);
  AddPropertyAttributes(node, attributes);
  frames_.back().kind = Kind::kNode;
  frames_.back().node = std::move(node);
}

void RdfXmlReader::AddPropertyAttributes(const Term& subject, const RdfXmlAttributes& attributes) {
  for (const PropertyAttribute& property : attributes.properties) {
    const XmlAttribute& attribute = *property.attribute;
    const size_t at = places_ == nullptr ? frames_.back().at : xml_.AttributeOffset(attribute.name);
    std::string predicate =
        property.is_type ? std::string(kRdfType) : Concat(attribute.name.iri, attribute.name.local);
    Term object, checked;
    if (!CheckIri(attribute.name, std::move(predicate), &checked)) continue;
    if (!property.is_type && RdfNameOf(attribute.name) == RdfName::kOther) {
      WarnOfUnknown(attribute.name, xml_.AttributeOffset(attribute.name));
    }
    if (property.is_type && !ReadReference(attribute, &object)) continue;
    if (!property.is_type) object = Text(std::string(attribute.value));
    Add({subject, std::move(checked), std::move(object), {}}, frames_.back().at, at);
  }
}

void RdfXmlReader::LinkNode(const Term& node) {
  if (frames_.size() < 2) return;
  const size_t property = frames_.size() - 2;
  Frame& around = frames_[property];
  if (around.kind == Kind::kProperty) {
    around.has_node = true;
    AddTriple(property, node);
  } else if (around.kind == Kind::kCollection) {  // section 7.2.19
    Term cell = collector_.NewBlank();
    const size_t at = frames_.back().at;
    if (around.last.lexical.empty()) {
      AddTriple(property, cell);
    } else {
      Add({around.last, Term::Iri(RdfIri("rest")), cell, {}}, at, at);
    }
    Add({cell, Term::Iri(RdfIri("first")), node, {}}, at, at);
    around.last = std::move(cell);
  }
}

// Section 7.2.14: the attributes decide among the seven productions, and for two of them the content.
void RdfXmlReader::StartProperty(const XmlElement& element, const RdfXmlAttributes& attributes) {
  Frame& frame = frames_.back();
  if (!ReadPredicate(element, &frame.predicate)) return;
  if (attributes.about != nullptr) {
    return ErrorAt(attributes.about->name, "rdf:about is an attribute of nodes, not of property elements",
                   "did you mean rdf:resource?");
  }
  if (attributes.id != nullptr && !ReadId(*attributes.id, &frame.statement)) return;
  if (attributes.parse_type != nullptr) return StartParseType(element, attributes);
  if (attributes.resource != nullptr || attributes.node_id != nullptr || !attributes.properties.empty()) {
    return StartEmpty(attributes);
  }
  Term datatype;
  if (attributes.datatype != nullptr && !ReadReference(*attributes.datatype, &datatype)) return;
  if (datatype.lexical == kRdfLangString) {
    return ErrorAt(attributes.datatype->name, "a literal of datatype rdf:langString has a language instead",
                   "write xml:lang=\"en\"");
  }
  frame.datatype = std::move(datatype.lexical);
  frame.kind = Kind::kProperty;
}

// Sections 7.2.17 to 7.2.20.
void RdfXmlReader::StartParseType(const XmlElement& element, const RdfXmlAttributes& attributes) {
  const XmlAttribute* others[] = {attributes.resource, attributes.node_id, attributes.datatype};
  const XmlAttribute* odd = attributes.properties.empty() ? nullptr : attributes.properties[0].attribute;
  for (const XmlAttribute* other : others) odd = other != nullptr ? other : odd;
  if (odd != nullptr) {
    return ErrorAt(odd->name, Concat(WrittenName(odd->name), " and rdf:parseType on one property element"),
                   "only rdf:ID is allowed together with rdf:parseType");
  }
  const std::string_view type = attributes.parse_type->value;
  if (type == "Triple") {
    return ErrorAt(attributes.parse_type->name, "triple terms are of RDF 1.2, which is not read",
                   "RDF 1.1 is: describe the triple with rdf:ID or rdf:Statement");
  }
  const size_t last = frames_.size() - 1;
  if (type == "Collection") {
    frames_[last].kind = Kind::kCollection;
    return;
  }
  if (type == "Resource") {
    const Term node = collector_.NewBlank();
    AddTriple(last, node);
    frames_[last].kind = Kind::kNode;
    frames_[last].node = node;
    return;
  }
  if (type != "Literal") {
    mistakes_.Warning(xml_.AttributeOffset(attributes.parse_type->name),
                      Concat("rdf:parseType=\"", type, "\" is read as \"Literal\": what is inside ",
                             WrittenName(element.name), " is an XML literal"),
                      "RDF/XML knows Literal, Resource and Collection");
  }
  frames_[last].kind = Kind::kLiteral;
}

// Section 7.2.21, with attributes other than rdf:ID.
void RdfXmlReader::StartEmpty(const RdfXmlAttributes& attributes) {
  if (attributes.datatype != nullptr) {
    return ErrorAt(attributes.datatype->name,
                   "rdf:datatype is not allowed together with attributes that make the value a resource",
                   "write the value as the text of the element");
  }
  if (attributes.resource != nullptr && attributes.node_id != nullptr) {
    return ErrorAt(attributes.node_id->name, "rdf:nodeID and rdf:resource on one property element",
                   "leave one of them");
  }
  Term object;
  if (attributes.resource != nullptr) {
    if (!ReadReference(*attributes.resource, &object)) return;
  } else if (attributes.node_id != nullptr) {
    if (!ReadNodeId(*attributes.node_id, &object)) return;
  } else {
    object = collector_.NewBlank();
  }
  AddTriple(frames_.size() - 1, object);
  AddPropertyAttributes(object, attributes);
  frames_.back().kind = Kind::kEmpty;
}

void RdfXmlReader::OnEnd(const XmlName& name) {
  if (frames_.back().kind == Kind::kLiteral && literal_.depth() > 0) return literal_.End(name);
  if (frames_.back().kind == Kind::kProperty) FinishProperty();
  if (frames_.back().kind == Kind::kCollection) FinishCollection();
  if (frames_.back().kind == Kind::kLiteral && !frames_.back().text_refused) {
    AddTriple(frames_.size() - 1, Term::Literal(literal_.Take(), RdfIri("XMLLiteral")));
  }
  for (; bases_.size() > frames_.back().bases; bases_.pop_back()) base_bytes_ -= bases_.back().size();
  languages_.resize(frames_.back().languages);
  frames_.pop_back();
}

Term RdfXmlReader::Text(std::string text) const {
  const std::string& language = languages_.back();
  return language.empty() ? Term::Literal(std::move(text)) : Term::LangString(std::move(text), language);
}

void RdfXmlReader::FinishProperty() {
  Frame& frame = frames_.back();
  if (frame.has_node) return;
  Term object = frame.datatype.empty() ? Text(std::move(frame.text))
                                       : Term::Literal(std::move(frame.text), std::move(frame.datatype));
  AddTriple(frames_.size() - 1, std::move(object));
}

void RdfXmlReader::FinishCollection() {
  const Frame& frame = frames_.back();
  Term nil = Term::Iri(RdfIri("nil"));
  if (frame.last.lexical.empty()) return AddTriple(frames_.size() - 1, std::move(nil));
  Add({frame.last, Term::Iri(RdfIri("rest")), std::move(nil), {}}, frame.at, frame.at);
}

void RdfXmlReader::AddTriple(size_t property, Term object) {
  const Frame& frame = frames_[property];
  const Frame& node = frames_[property - 1];
  if (frame.statement.empty())
    return Add({node.node, frame.predicate, std::move(object), {}}, node.at, frame.at);
  Add({node.node, frame.predicate, object, {}}, node.at, frame.at);
  const Term statement = Term::Iri(frame.statement);  // section 7.3
  Add({statement, Term::Iri(std::string(kRdfType)), Term::Iri(RdfIri("Statement")), {}}, frame.at, frame.at);
  Add({statement, Term::Iri(RdfIri("subject")), node.node, {}}, frame.at, frame.at);
  Add({statement, Term::Iri(RdfIri("predicate")), frame.predicate, {}}, frame.at, frame.at);
  Add({statement, Term::Iri(RdfIri("object")), std::move(object), {}}, frame.at, frame.at);
}

void RdfXmlReader::Add(TermQuad quad, size_t subject_at, size_t at) {
  for (const Term* term : {&quad.subject, &quad.predicate, &quad.object}) {
    if (term->lexical.size() <= options_.limits.term_bytes &&
        term->datatype.size() <= options_.limits.term_bytes)
      continue;
    return Error(at, absl::StrCat("this term has ", std::max(term->lexical.size(), term->datatype.size()),
                                  " bytes, the limit term_bytes is ", options_.limits.term_bytes));
  }
  if (!collector_.Add(std::move(quad))) {
    Error(at, collector_.Refusal(), "split the document");
    return xml_.Stop();
  }
  if (places_ == nullptr) return;
  collector_.Charge(0, kBytesOfPlaces);  // what is too much ends with the next quad
  places_->AddQuad(subject_at, at, at);
}

void RdfXmlReader::RefuseText(std::string_view text) {
  const size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos || frames_.back().text_refused) return;
  frames_.back().text_refused = true;
  const Kind kind = frames_.back().kind;
  std::string message =
      Concat("the text '", Beginning(text.substr(first)), "' is at a place where no text is allowed: ");
  if (kind == Kind::kEmpty) {
    Error(xml_.EventOffset() + first, message + "the attributes of this property give its value",
          "take the text away, or write the value as the text alone");
  } else if (kind == Kind::kProperty) {
    Error(xml_.EventOffset() + first, message + "after the node that is the property's value",
          "write one of them alone, or rdf:parseType=\"Literal\" for a text with markup");
  } else {
    Error(xml_.EventOffset() + first,
          message + (kind == Kind::kNode ? "between the properties of a node" : "between nodes"),
          "write it inside of a property element; is this document RDF/XML?");
  }
}

// Reports that the text of the innermost property is longer than a term may be.
void RdfXmlReader::RefuseLength() {
  if (frames_.back().text_refused) return;
  frames_.back().text_refused = true;
  Error(frames_.back().at,
        absl::StrCat("the text of this property has more bytes than the limit term_bytes = ",
                     options_.limits.term_bytes));
}

void RdfXmlReader::BoundLiteral() {
  if (literal_.size() <= options_.limits.term_bytes) return;
  RefuseLength();
  literal_.DropText();
}

void RdfXmlReader::OnText(std::string_view text) {
  if (frames_.empty() || frames_.back().kind == Kind::kSkipped) return;
  Frame& frame = frames_.back();
  if (frame.kind == Kind::kLiteral) {
    literal_.Text(text);
    return BoundLiteral();
  }
  if (frame.kind != Kind::kProperty || frame.has_node) return RefuseText(text);
  if (frame.text.size() + text.size() > options_.limits.term_bytes) return RefuseLength();
  frame.text.append(text);
}

void RdfXmlReader::OnComment(std::string_view text) {
  if (frames_.back().kind != Kind::kLiteral) return;
  literal_.Comment(text);
  BoundLiteral();
}

void RdfXmlReader::OnInstruction(std::string_view target, std::string_view data) {
  if (frames_.back().kind != Kind::kLiteral) return;
  literal_.Instruction(target, data);
  BoundLiteral();
}

}  // namespace docent
