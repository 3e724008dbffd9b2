#include "workflow/templates/wsdl_schema.h"

#include "absl/strings/ascii.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/vocabulary.h"

namespace docent::templates {
namespace {

constexpr std::string_view kSchemaNs = "http://www.w3.org/2001/XMLSchema";
constexpr std::string_view kSoapEncodingNs = "http://schemas.xmlsoap.org/soap/encoding/";
constexpr int kMostDepth = 16;  // types derived from each other, groups inside each other

bool IsSchema(const xml::Element& element, std::string_view name) {
  return element.namespace_iri == kSchemaNs && element.name == name;
}

}  // namespace

std::string AttributeOf(const xml::Element& element, std::string_view name) {
  const xml::Attribute* attribute = element.Find(name);
  if (attribute == nullptr) return "";
  return std::string(FromAbsl(absl::StripAsciiWhitespace(attribute->value.value)));
}

QName ResolveName(const xml::Element& at, std::string_view text, const std::string& default_ns) {
  const size_t colon = text.find(':');
  const std::string prefix(colon == std::string_view::npos ? std::string_view() : text.substr(0, colon));
  const std::string local(colon == std::string_view::npos ? text : text.substr(colon + 1));
  if (at.namespaces != nullptr) {
    const auto found = at.namespaces->find(prefix);
    if (found != at.namespaces->end()) return {found->second, local};
  }
  return {default_ns, local};
}

void WsdlSchema::Add(const xml::Element& schema) {
  const std::string name_space = AttributeOf(schema, "targetNamespace");
  for (const auto& child : schema.children) {
    const QName name{name_space, AttributeOf(*child, "name")};
    if (IsSchema(*child, "element")) elements_.Add(name, {child.get(), name_space});
    if (IsSchema(*child, "simpleType")) simple_types_.Add(name, {child.get(), name_space});
    if (IsSchema(*child, "complexType")) complex_types_.Add(name, {child.get(), name_space});
    if (IsSchema(*child, "import") || IsSchema(*child, "include") || IsSchema(*child, "redefine")) {
      const std::string location = AttributeOf(*child, "schemaLocation");
      if (location.empty()) continue;
      report_(*child, Concat("the schema ", location, " is not read"),
              "parts of its elements and types are missing; put them into this document");
    }
  }
}

void WsdlSchema::AddPartsOfElement(const xml::Element& at, const QName& name,
                                   std::vector<TemplatePart>* parts) {
  const Declared* declared = elements_.Find(name);
  if (declared == nullptr) {
    report_(at, Concat("element ", name.second, " is not defined here"), "it is one part without a type");
    AddPart(name.second, "", parts);
    return;
  }
  if (!AddDeclared(*declared, 0, parts))
    report_(at, Concat("element ", name.second, " has too many parts"),
            "those after the limit import_parts are left out");
}

bool WsdlSchema::AddDeclared(const Declared& declared, int depth, std::vector<TemplatePart>* parts) {
  const xml::Element& element = *declared.element;
  const std::string type = AttributeOf(element, "type");
  if (!type.empty()) {
    const QName name = ResolveName(element, type, declared.name_space);
    const Declared* complex = name.first == kSchemaNs ? nullptr : complex_types_.Find(name);
    if (complex != nullptr) return AddContent(*complex, AttributeOf(element, "name"), depth + 1, parts);
    return AddPart(AttributeOf(element, "name"), TypeOfName(name, 0), parts);
  }
  for (const auto& child : element.children) {
    if (IsSchema(*child, "complexType"))
      return AddContent({child.get(), declared.name_space}, AttributeOf(element, "name"), depth + 1, parts);
    if (IsSchema(*child, "simpleType"))
      return AddPart(AttributeOf(element, "name"), TypeOfSimple({child.get(), declared.name_space}, 0),
                     parts);
  }
  return true;
}

// Of a complex type, or of something inside of one. `own_name`: of the element, which is a part where the content is simple.
bool WsdlSchema::AddContent(const Declared& type, const std::string& own_name, int depth,
                            std::vector<TemplatePart>* parts) {
  if (depth > kMostDepth) return true;
  for (const auto& child : type.element->children) {
    if (++steps_ > kWorkflowLimits.import_steps) return false;
    const Declared inside{child.get(), type.name_space};
    bool more = true;
    if (IsSchema(*child, "element")) {
      more = AddChild(inside, parts);
    } else if (IsSchema(*child, "attribute")) {
      const std::string name = AttributeOf(*child, "name");
      if (!name.empty()) more = AddPart(name, TypeOfElement(inside, 0), parts);
    } else if (IsSchema(*child, "extension") || IsSchema(*child, "restriction")) {
      const QName base = ResolveName(*child, AttributeOf(*child, "base"), type.name_space);
      const Declared* complex = base.first == kSchemaNs ? nullptr : complex_types_.Find(base);
      if (IsSchema(*type.element, "simpleContent") && complex == nullptr)
        more = AddPart(own_name, TypeOfName(base, 0), parts);
      else if (complex != nullptr && IsSchema(*child, "extension"))
        more = AddContent(*complex, own_name, depth + 1, parts);
      more = more && AddContent(inside, own_name, depth + 1, parts);
    } else if (IsSchema(*child, "sequence") || IsSchema(*child, "all") || IsSchema(*child, "choice") ||
               IsSchema(*child, "complexContent") || IsSchema(*child, "simpleContent")) {
      more = AddContent(inside, own_name, depth + 1, parts);
    }
    if (!more) return false;
  }
  return true;
}

bool WsdlSchema::AddChild(const Declared& child, std::vector<TemplatePart>* parts) {
  const xml::Element& element = *child.element;
  Declared declared = child;
  std::string name = AttributeOf(element, "name");
  if (const std::string ref = AttributeOf(element, "ref"); !ref.empty()) {
    const QName target = ResolveName(element, ref, child.name_space);
    name = target.second;
    if (const Declared* found = elements_.Find(target))
      declared = *found;
    else
      report_(element, Concat("element ", target.second, " is not defined here"), "the part has no type");
  }
  const std::string most = AttributeOf(element, "maxOccurs");
  if (!most.empty() && most != "0" && most != "1")
    report_(element, Concat("element ", name, " may stand several times"), "a node gives one value for it");
  return AddPart(name, TypeOfElement(declared, 0), parts);
}

std::string WsdlSchema::TypeOfElement(const Declared& declared, int depth) const {
  const xml::Element& element = *declared.element;
  const std::string type = AttributeOf(element, "type");
  if (!type.empty()) return TypeOfName(ResolveName(element, type, declared.name_space), depth);
  for (const auto& child : element.children) {
    if (IsSchema(*child, "simpleType")) return TypeOfSimple({child.get(), declared.name_space}, depth);
  }
  return "";
}

std::string WsdlSchema::TypeOfName(const QName& name, int depth) const {
  if (name.second.empty() || depth > kMostDepth) return "";
  if (name.first == kSchemaNs || name.first == kSoapEncodingNs) {
    const bool any = name.second == "anyType" || name.second == "anySimpleType" || name.second == "Array";
    const std::string iri = Concat(kXsdNs, name.second);
    return any || !IsValidTermIri(iri) ? std::string() : iri;
  }
  if (const Declared* simple = simple_types_.Find(name)) return TypeOfSimple(*simple, depth + 1);
  const bool ends = name.first.ends_with("#") || name.first.ends_with("/");
  const std::string iri = Concat(name.first, ends ? "" : "#", name.second);
  return !name.first.empty() && IsValidTermIri(iri) ? iri : std::string();
}

std::string WsdlSchema::TypeOfSimple(const Declared& simple, int depth) const {
  if (depth > kMostDepth) return "";
  for (const auto& child : simple.element->children) {
    if (!IsSchema(*child, "restriction")) continue;
    const std::string base = AttributeOf(*child, "base");
    if (!base.empty()) return TypeOfName(ResolveName(*child, base, simple.name_space), depth + 1);
    for (const auto& inside : child->children) {
      if (IsSchema(*inside, "simpleType")) return TypeOfSimple({inside.get(), simple.name_space}, depth + 1);
    }
  }
  return "";
}

}  // namespace docent::templates
