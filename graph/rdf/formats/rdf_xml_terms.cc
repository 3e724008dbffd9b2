// Names and attributes of RDF/XML as terms, and the scopes of xml:base and xml:lang.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/rdf_xml_reader.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/term_check.h"
#include "graph/rdf/vocabulary.h"

namespace docent {

void RdfXmlReader::WarnOfUnknown(const XmlName& name, size_t offset) {
  static const std::vector<std::string> known = {"Alt",        "Bag",        "Description",
                                                 "ID",         "List",       "Property",
                                                 "RDF",        "Seq",        "Statement",
                                                 "about",      "datatype",   "first",
                                                 "li",         "nodeID",     "object",
                                                 "parseType",  "predicate",  "resource",
                                                 "rest",       "subject",    "type",
                                                 "value",      "nil",        "XMLLiteral",
                                                 "langString", "HTML",       "PlainLiteral",
                                                 "direction",  "language",   "CompoundLiteral",
                                                 "JSON",       "annotation", "annotationNodeID",
                                                 "reifies",    "version"};
  const std::string_view local = name.local;
  const bool member = local.starts_with("_") && local.size() > 1 &&
                      local.find_first_not_of("0123456789", 1) == std::string_view::npos;
  if (member || std::find(known.begin(), known.end(), local) != known.end()) return;
  const std::string nearest = Nearest(local, known);
  mistakes_.Warning(offset, Concat("the RDF namespace has no name '", local, "'"),
                    nearest.empty() ? "" : Concat("did you mean rdf:", nearest, "?"));
}

bool RdfXmlReader::EnterScope(const RdfXmlAttributes& attributes) {
  Frame& frame = frames_.back();
  frame.bases = bases_.size();
  frame.languages = languages_.size();
  if (attributes.language != nullptr) {
    const XmlAttribute& language = *attributes.language;
    if (!language.value.empty() && !IsLanguageTag(language.value)) {
      ErrorAt(language.name, Concat("'", language.value, "' is not a language tag"),
              "write, for example, en or en-GB");
      return false;
    }
    languages_.emplace_back(language.value);
  }
  if (attributes.base == nullptr) return true;
  const std::string_view value = attributes.base->value;
  if (!IsAbsoluteIri(value) && bases_.back().empty()) {
    ErrorAt(attributes.base->name,
            Concat("xml:base is the relative IRI <", value, ">, and the document has no base IRI"),
            "write the whole IRI");
    return false;
  }
  std::string base = ResolveIri(value, bases_.back());
  base_bytes_ += base.size();
  if (base.size() > options_.limits.term_bytes || base_bytes_ > options_.limits.document_bytes) {
    ErrorAt(attributes.base->name,
            absl::StrCat("xml:base has ", base.size(), " bytes here; the limit term_bytes is ",
                         options_.limits.term_bytes, ", and all that are in scope may have document_bytes = ",
                         options_.limits.document_bytes));
    base_bytes_ -= base.size();
    return false;
  }
  bases_.push_back(std::move(base));
  return true;
}

bool RdfXmlReader::ReadName(const XmlName& name, Term* iri) {
  const size_t at = frames_.back().at;
  if (name.iri.empty()) {
    if (name.prefix.empty()) {
      Error(at, Concat("the element <", name.local, "> has no namespace, so it names nothing in RDF"),
            "declare xmlns=\"…\" or give it a prefix; is this document RDF/XML?");
    }
    return false;  // a prefix that is not declared has been reported
  }
  std::string whole = Concat(name.iri, name.local);
  if (!IsValidTermIri(whole)) {
    Error(at, Concat("the name ", WrittenName(name), " is <", whole, ">, which is not an absolute IRI"),
          "correct the declaration of its prefix");
    return false;
  }
  *iri = Term::Iri(std::move(whole));
  return true;
}

bool RdfXmlReader::CheckIri(const XmlName& attribute, std::string iri, Term* to) {
  if (!IsValidTermIri(iri)) {
    ErrorAt(attribute, Concat("<", iri, "> holds a character that is not allowed in an IRI"),
            "write it percent-encoded, a space as %20");
    return false;
  }
  *to = Term::Iri(std::move(iri));
  return true;
}

bool RdfXmlReader::ReadReference(const XmlAttribute& attribute, Term* iri) {
  if (bases_.back().empty() && !IsAbsoluteIri(attribute.value)) {
    ErrorAt(attribute.name, Concat("<", attribute.value, "> is relative and the document has no base IRI"),
            "write the whole IRI, or give xml:base on the first element");
    return false;
  }
  return CheckIri(attribute.name, ResolveIri(attribute.value, bases_.back()), iri);
}

bool RdfXmlReader::ReadId(const XmlAttribute& attribute, std::string* iri) {
  if (!IsNcName(attribute.value)) {
    ErrorAt(
        attribute.name, Concat("rdf:ID is '", attribute.value, "', which is not an XML name"),
        "a letter or '_', and then letters, digits, '.', '-' and '_'; use rdf:about=\"#…\" for any other");
    return false;
  }
  const std::string reference = Concat("#", attribute.value);
  if (bases_.back().empty()) {
    ErrorAt(attribute.name,
            Concat("rdf:ID='", attribute.value, "' is relative and the document has no base IRI"),
            "give xml:base on the first element, or write rdf:about with the whole IRI");
    return false;
  }
  Term named;
  if (!CheckIri(attribute.name, ResolveIri(reference, bases_.back()), &named)) return false;
  if (!collector_.Charge(named.lexical.size())) {
    ErrorAt(attribute.name, collector_.Refusal());
    xml_.Stop();
    return false;
  }
  if (!ids_.insert(named.lexical).second) {
    ErrorAt(attribute.name, Concat("rdf:ID='", attribute.value, "' occurs twice in this document"),
            "an ID names one thing once; say rdf:about=\"#…\" the second time");
    return false;
  }
  *iri = std::move(named.lexical);
  return true;
}

bool RdfXmlReader::ReadNodeId(const XmlAttribute& attribute, Term* node) {
  if (!IsNcName(attribute.value)) {
    ErrorAt(attribute.name, Concat("rdf:nodeID is '", attribute.value, "', which is not an XML name"),
            "a letter or '_', and then letters, digits, '.', '-' and '_'");
    return false;
  }
  *node = collector_.NamedBlank(attribute.value);
  // A label that is too long is reported as too long.
  if (node->lexical.size() > options_.limits.term_bytes || CheckTerm(*node, options_.limits.term_bytes).ok())
    return true;
  // An XML name may end with a dot; a label in RDF's other syntaxes may not.
  const auto [place, is_new] = renamed_.try_emplace(std::string(attribute.value));
  if (is_new) place->second = collector_.NewBlank();
  *node = place->second;
  return true;
}

// Section 7.2.11: at most one of rdf:ID, rdf:nodeID and rdf:about.
bool RdfXmlReader::ReadSubject(const RdfXmlAttributes& attributes, Term* subject) {
  const XmlAttribute* given[] = {attributes.id, attributes.node_id, attributes.about};
  if (3 - std::count(std::begin(given), std::end(given), nullptr) > 1) {
    Error(frames_.back().at, "a node element with more than one of rdf:about, rdf:ID and rdf:nodeID",
          "leave one of them");
    return false;
  }
  for (const XmlAttribute* odd : {attributes.resource, attributes.datatype, attributes.parse_type}) {
    if (odd == nullptr) continue;
    ErrorAt(odd->name, Concat(WrittenName(odd->name), " is an attribute of property elements, not of nodes"),
            odd == attributes.resource ? "did you mean rdf:about?" : "");
    return false;
  }
  if (attributes.about != nullptr) return ReadReference(*attributes.about, subject);
  if (attributes.node_id != nullptr) return ReadNodeId(*attributes.node_id, subject);
  if (attributes.id == nullptr) {
    *subject = collector_.NewBlank();
    return true;
  }
  subject->kind = TermKind::kIri;
  return ReadId(*attributes.id, &subject->lexical);
}

bool RdfXmlReader::ReadPredicate(const XmlElement& element, Term* predicate) {
  const RdfName name = RdfNameOf(element.name);
  const size_t at = frames_.back().at;
  if (!MayBeProperty(name)) {
    Error(at, Concat(WrittenName(element.name), " may not be a property element"),
          name == RdfName::kDescription
              ? "a node stands inside of a property: nodes and properties must alternate"
              : "");
    return false;
  }
  if (name == RdfName::kLi) {  // section 7.4
    *predicate = Term::Iri(absl::StrCat(ToAbsl(kRdfNs), "_", ++frames_[frames_.size() - 2].members));
    return true;
  }
  if (name == RdfName::kOther) WarnOfUnknown(element.name, at);
  return ReadName(element.name, predicate);
}

}  // namespace docent
