#include "graph/rdf/formats/xml_literal.h"

#include <algorithm>
#include <tuple>

#include "graph/base/text.h"

namespace docent {
namespace {

// Canonical XML 1.0 section 2.3, text nodes and attribute nodes.
void AppendText(std::string_view text, std::string* out) {
  for (const char c : text) {
    switch (c) {
      case '&':
        *out += "&amp;";
        break;
      case '<':
        *out += "&lt;";
        break;
      case '>':
        *out += "&gt;";
        break;
      case '\r':
        *out += "&#xD;";
        break;
      default:
        *out += c;
    }
  }
}
void AppendValue(std::string_view value, std::string* out) {
  for (const char c : value) {
    switch (c) {
      case '&':
        *out += "&amp;";
        break;
      case '<':
        *out += "&lt;";
        break;
      case '"':
        *out += "&quot;";
        break;
      case '\t':
        *out += "&#x9;";
        break;
      case '\n':
        *out += "&#xA;";
        break;
      case '\r':
        *out += "&#xD;";
        break;
      default:
        *out += c;
    }
  }
}

void AppendAttribute(std::string_view name, std::string_view value, std::string* out) {
  out->append(" ").append(name).append("=\"");
  AppendValue(value, out);
  *out += '"';
}

std::string Written(const XmlName& name) {
  return name.prefix.empty() ? std::string(name.local) : Concat(name.prefix, ":", name.local);
}

}  // namespace

std::string_view XmlLiteral::Declared(std::string_view prefix) const {
  const auto known = declared_.find(ToAbsl(prefix));
  return known == declared_.end() || known->second.empty() ? std::string_view() : known->second.back();
}

void XmlLiteral::Use(const XmlName& name) {
  if (name.prefix == "xml" || Declared(name.prefix) == name.iri) return;
  declared_[ToAbsl(name.prefix)].emplace_back(name.iri);
  undo_.emplace_back(name.prefix);
  now_.emplace_back(name.prefix, name.iri);
}

void XmlLiteral::Start(const XmlElement& element) {
  marks_.push_back(undo_.size());
  now_.clear();
  Use(element.name);
  for (const XmlAttribute& attribute : element.attributes) {
    if (!attribute.name.prefix.empty()) Use(attribute.name);
  }
  std::sort(now_.begin(), now_.end());
  out_ += '<' + Written(element.name);
  for (const auto& [prefix, iri] : now_) {
    AppendAttribute(prefix.empty() ? "xmlns" : Concat("xmlns:", prefix), iri, &out_);
  }
  std::vector<const XmlAttribute*> attributes;
  for (const XmlAttribute& attribute : element.attributes) attributes.push_back(&attribute);
  std::sort(attributes.begin(), attributes.end(), [](const XmlAttribute* a, const XmlAttribute* b) {
    return std::tie(a->name.iri, a->name.local) < std::tie(b->name.iri, b->name.local);
  });
  for (const XmlAttribute* attribute : attributes) {
    AppendAttribute(Written(attribute->name), attribute->value, &out_);
  }
  out_ += '>';
}

void XmlLiteral::End(const XmlName& name) {
  out_ += "</" + Written(name) + ">";
  for (; undo_.size() > marks_.back(); undo_.pop_back()) declared_[undo_.back()].pop_back();
  marks_.pop_back();
}

void XmlLiteral::Text(std::string_view text) {
  AppendText(text, &out_);
}

void XmlLiteral::Comment(std::string_view text) {
  out_.append("<!--").append(text).append("-->");
}

void XmlLiteral::Instruction(std::string_view target, std::string_view data) {
  out_.append("<?").append(target);
  if (!data.empty()) out_.append(" ").append(data);
  out_.append("?>");
}

std::string XmlLiteral::Take() {
  declared_.clear();
  undo_.clear();
  marks_.clear();
  return std::exchange(out_, {});
}

}  // namespace docent
