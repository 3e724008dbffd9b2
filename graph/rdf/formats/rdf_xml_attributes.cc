#include "graph/rdf/formats/rdf_xml_attributes.h"

#include <array>
#include <utility>

#include "absl/strings/match.h"
#include "graph/base/text.h"
#include "graph/rdf/turtle_scanner.h"
#include "graph/rdf/utf8.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

constexpr std::array<std::pair<std::string_view, RdfName>, 16> kNames = {{
    {"RDF", RdfName::kRdf},
    {"Description", RdfName::kDescription},
    {"ID", RdfName::kId},
    {"about", RdfName::kAbout},
    {"parseType", RdfName::kParseType},
    {"resource", RdfName::kResource},
    {"nodeID", RdfName::kNodeId},
    {"datatype", RdfName::kDatatype},
    {"li", RdfName::kLi},
    {"type", RdfName::kType},
    {"aboutEach", RdfName::kAboutEach},
    {"aboutEachPrefix", RdfName::kAboutEachPrefix},
    {"bagID", RdfName::kBagId},
    {"version", RdfName::kVersion},
    {"annotation", RdfName::kAnnotation},
    {"annotationNodeID", RdfName::kAnnotation},
}};

RdfName NameOfRdf(std::string_view local) {
  for (const auto& [text, name] : kNames) {
    if (text == local) return name;
  }
  return RdfName::kOther;
}

// Section 6.1.4: these may be written without their namespace, as in documents of 1999.
bool NeedsNoNamespace(RdfName name) {
  return name == RdfName::kId || name == RdfName::kAbout || name == RdfName::kResource ||
         name == RdfName::kParseType || name == RdfName::kType;
}

bool IsReserved(const XmlName& name) {
  const std::string_view first = name.prefix.empty() ? name.local : name.prefix;
  return absl::StartsWithIgnoreCase(ToAbsl(first), "xml");
}

bool IsOld(RdfName name) {
  return name == RdfName::kAboutEach || name == RdfName::kAboutEachPrefix || name == RdfName::kBagId;
}

// The field of `out` for the attribute `name`; null: not an attribute of the syntax.
const XmlAttribute** PlaceOf(RdfName name, RdfXmlAttributes* out) {
  switch (name) {
    case RdfName::kId:
      return &out->id;
    case RdfName::kAbout:
      return &out->about;
    case RdfName::kNodeId:
      return &out->node_id;
    case RdfName::kResource:
      return &out->resource;
    case RdfName::kDatatype:
      return &out->datatype;
    case RdfName::kParseType:
      return &out->parse_type;
    default:
      return nullptr;
  }
}

}  // namespace

RdfName RdfNameOf(const XmlName& name) {
  return name.iri == kRdfNs ? NameOfRdf(name.local) : RdfName::kForeign;
}

bool IsLongerThanRdfNs(std::string_view name_space) {
  return name_space.size() > kRdfNs.size() && name_space.starts_with(kRdfNs);
}

bool MayBeNode(RdfName name) {
  return name == RdfName::kForeign || name == RdfName::kOther || name == RdfName::kDescription ||
         name == RdfName::kType || name >= RdfName::kVersion;
}

bool MayBeProperty(RdfName name) {
  return name == RdfName::kForeign || name == RdfName::kOther || name == RdfName::kLi ||
         name == RdfName::kType || name >= RdfName::kVersion;
}

bool IsNcName(std::string_view text) {
  for (size_t at = 0; at < text.size();) {
    const bool first = at == 0;
    const char32_t c = NextCodePoint(text, &at);
    if (!(first ? IsNameStart(c) : IsNameChar(c) || c == '.')) return false;
  }
  return !text.empty();
}

std::string WrittenName(const XmlName& name) {
  return name.prefix.empty() ? std::string(name.local) : Concat(name.prefix, ":", name.local);
}

bool SortAttributes(const XmlElement& element, const ReportAttribute& report, RdfXmlAttributes* out) {
  bool good = true;
  const auto refuse = [&](const XmlName& name, std::string message, std::string hint) {
    report(name, std::move(message), std::move(hint));
    good = false;
  };
  for (const XmlAttribute& attribute : element.attributes) {
    const XmlName& name = attribute.name;
    if (name.iri == kXmlNs && name.local == "lang") out->language = &attribute;
    if (name.iri == kXmlNs && name.local == "base") out->base = &attribute;
    if (IsReserved(name)) continue;
    RdfName known = RdfNameOf(name);
    if (name.iri.empty()) {
      if (!name.prefix.empty()) {  // it is not declared: the XML reader has reported it
        good = false;
        continue;
      }
      known = NameOfRdf(name.local);
      if (!NeedsNoNamespace(known)) {
        refuse(name, Concat("the attribute ", name.local, " has no namespace, so it names no property"),
               "give it a prefix; is this document RDF/XML?");
        continue;
      }
    }
    if (const XmlAttribute** place = PlaceOf(known, out); place != nullptr) {
      if (*place != nullptr) refuse(name, Concat("rdf:", name.local, " is given twice"), "");
      *place = &attribute;
    } else if (IsOld(known)) {
      refuse(name, Concat("rdf:", name.local, " is not part of RDF/XML any more"),
             "RDF/XML of 2004 took it away; write the triples out");
    } else if (known == RdfName::kVersion) {
      if (attribute.value != "1.1") {
        refuse(name, Concat("RDF ", attribute.value, " is not read"), "RDF 1.1 is");
      }
    } else if (known == RdfName::kAnnotation) {
      refuse(name, Concat(WrittenName(name), " is of RDF 1.2, which is not read"),
             "RDF 1.1 is: describe the triple with rdf:ID or rdf:Statement");
    } else if (known == RdfName::kForeign || known == RdfName::kOther || known == RdfName::kType) {
      out->properties.push_back({&attribute, known == RdfName::kType});
    } else {
      refuse(name, Concat(WrittenName(name), " may not be an attribute"), "");
    }
  }
  return good;
}

}  // namespace docent
