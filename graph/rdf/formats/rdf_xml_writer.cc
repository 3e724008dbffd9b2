// RDF/XML, written flat: an rdf:Description for each run of triples with one subject. Whatever is written is read back as the
// same triples by rdf_xml_reader.h; what cannot be said so is refused.
#include <algorithm>
#include <array>
#include <cstdint>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/rdf_xml.h"
#include "graph/rdf/formats/rdf_xml_attributes.h"
#include "graph/rdf/turtle_scanner.h"
#include "graph/rdf/utf8.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

// Names of the RDF namespace that have another meaning than a property as elements (RDF/XML 1.1 sections 7.2.2 to 7.2.4);
// rdf:li would be read as rdf:_1.
constexpr std::array<std::string_view, 12> kSyntaxNames = {
    "RDF",      "ID",          "about", "parseType", "resource",  "nodeID",
    "datatype", "Description", "li",    "bagID",     "aboutEach", "aboutEachPrefix"};
// Namespaces that XML keeps for itself (Namespaces in XML 1.0 section 3).
constexpr std::string_view kXmlNs = "http://www.w3.org/XML/1998/namespace";
constexpr std::string_view kXmlnsNs = "http://www.w3.org/2000/xmlns/";

// XML 1.0 section 2.2, Char: the characters that a document can hold, escaped or not.
bool IsXmlChar(char32_t c) {
  return c == '\t' || c == '\n' || c == '\r' || (c >= 0x20 && c != 0xFFFE && c != 0xFFFF);
}

absl::Status CheckCharacters(std::string_view text) {
  for (size_t at = 0; at < text.size();) {
    const char32_t c = NextCodePoint(text, &at);
    if (IsXmlChar(c)) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("XML can't hold the character U+%04X; use Turtle", static_cast<uint32_t>(c)));
  }
  return absl::OkStatus();
}

// As the text of an element or the value of an attribute: white space of values stays as it is.
std::string Escaped(std::string_view text, bool attribute) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '\r' || (attribute && (c == '\t' || c == '\n'))) {
      absl::StrAppend(&out, "&#x", absl::Hex(c, absl::kNoPad), ";");
    } else if (attribute && c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

// Where the longest XML name at the end of an IRI begins; its length if there is none.
size_t NameAtEnd(std::string_view iri) {
  size_t begin = iri.size(), at = iri.size();
  while (at > 0) {
    size_t before = at - 1;
    while (before > 0 && (static_cast<unsigned char>(iri[before]) & 0xC0) == 0x80) --before;
    size_t next = before;
    const char32_t c = NextCodePoint(iri, &next);
    if (IsNameStart(c)) begin = before;
    if (!IsNameStart(c) && !IsNameChar(c) && c != '.') break;
    at = before;
  }
  return begin;
}

class RdfXmlWriter {
 public:
  explicit RdfXmlWriter(const std::vector<std::pair<std::string, std::string>>& prefixes) {
    Declare("rdf", std::string(kRdfNs));
    for (const auto& [name, iri] : prefixes) {
      const bool usable = name.empty() || (IsNcName(name) && !absl::StartsWithIgnoreCase(name, "xml"));
      if (usable && !iri.empty() && iri != kXmlNs && iri != kXmlnsNs) Declare(name, iri);
    }
  }

  absl::StatusOr<std::string> Write(const std::vector<TermQuad>& quads) {
    std::string body;
    const Term* subject = nullptr;
    for (const TermQuad& quad : quads) {
      if (subject == nullptr || quad.subject != *subject) {
        if (subject != nullptr) body += "  </rdf:Description>\n";
        subject = &quad.subject;
        if (absl::Status s = CheckCharacters(subject->lexical); !s.ok()) return s;
        absl::StrAppend(&body, "  <rdf:Description ", Reference(*subject, "about"), ">\n");
      }
      if (absl::Status s = WriteProperty(quad, &body); !s.ok()) return s;
    }
    if (subject != nullptr) body += "  </rdf:Description>\n";
    std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<rdf:RDF";
    for (const auto& [name, iri] : declared_) {
      if (!used_[name] && name != "rdf") continue;
      absl::StrAppend(&out, " xmlns", name.empty() ? "" : ":", name, "=\"", Escaped(iri, true), "\"");
    }
    return absl::StrCat(out, ">\n", body, "</rdf:RDF>\n");
  }

 private:
  // The first declaration of a name or a namespace counts.
  void Declare(const std::string& name, const std::string& iri) {
    const bool taken = std::any_of(declared_.begin(), declared_.end(),
                                   [&](const auto& other) { return other.first == name; });
    if (!taken && names_.emplace(iri, name).second) declared_.emplace_back(name, iri);
  }

  absl::Status WriteProperty(const TermQuad& quad, std::string* out) {
    absl::StatusOr<std::string> element = ElementOf(quad.predicate.lexical);
    if (!element.ok()) return element.status();
    if (absl::Status s = CheckCharacters(quad.object.lexical); !s.ok()) return s;
    const Term& object = quad.object;
    if (!object.IsLiteral()) {
      absl::StrAppend(out, "    <", *element, " ", Reference(object, "resource"), "/>\n");
      return absl::OkStatus();
    }
    std::string attribute;
    if (!object.language.empty()) {
      attribute = Concat(" xml:lang=\"", Escaped(object.language, true), "\"");
    } else if (!object.datatype.empty() && object.datatype != kXsdString) {
      if (absl::Status s = CheckCharacters(object.datatype); !s.ok()) return s;
      attribute = Concat(" rdf:datatype=\"", Escaped(object.datatype, true), "\"");
    }
    absl::StrAppend(out, "    <", *element, attribute, ">", Escaped(object.lexical, false), "</", *element,
                    ">\n");
    return absl::OkStatus();
  }

  // The qualified name of a property element.
  absl::StatusOr<std::string> ElementOf(const std::string& predicate) {
    if (absl::Status s = CheckCharacters(predicate); !s.ok()) return s;
    const auto refused = [&](std::string_view why) {
      return absl::InvalidArgumentError(
          Concat("RDF/XML can't say the predicate <", predicate, ">: ", why, "; use Turtle"));
    };
    const size_t at = NameAtEnd(predicate);
    if (at == predicate.size()) return refused("no XML name stands at its end");
    if (at == 0) return refused("it is an XML name without a namespace");
    const std::string name_space = predicate.substr(0, at), local = predicate.substr(at);
    if (name_space == kXmlNs || name_space == kXmlnsNs) return refused("XML keeps its namespace for itself");
    if (IsLongerThanRdfNs(name_space)) return refused("its namespace only begins like that of RDF");
    if (name_space == kRdfNs &&
        std::find(kSyntaxNames.begin(), kSyntaxNames.end(), local) != kSyntaxNames.end()) {
      return refused("it is a word of RDF/XML's own syntax");
    }
    while (!names_.contains(name_space)) Declare(absl::StrCat("ns", next_++), name_space);
    const std::string& prefix = names_[name_space];
    used_[prefix] = true;
    return prefix.empty() ? local : absl::StrCat(prefix, ":", local);
  }

  // An IRI or blank node as an attribute: rdf:about or rdf:resource, or rdf:nodeID.
  std::string Reference(const Term& term, std::string_view iri_attribute) {
    if (!term.IsBlank()) return Concat("rdf:", iri_attribute, "=\"", Escaped(term.lexical, true), "\"");
    // A generated XML name: labels of RDF may begin with a digit.
    std::string& name = blanks_[term.lexical];
    if (name.empty()) name = absl::StrCat("b", blanks_.size());
    return Concat("rdf:nodeID=\"", name, "\"");
  }

  std::vector<std::pair<std::string, std::string>> declared_;  // prefix, namespace
  absl::flat_hash_map<std::string, std::string> names_;        // namespace → prefix
  absl::flat_hash_map<std::string, bool> used_;                // by prefix
  absl::flat_hash_map<std::string, std::string> blanks_;       // label → name in the document
  int next_ = 0;                                               // of generated prefixes
};

}  // namespace

absl::StatusOr<std::string> WriteRdfXml(const std::vector<TermQuad>& quads,
                                        const std::vector<std::pair<std::string, std::string>>& prefixes) {
  return RdfXmlWriter(prefixes).Write(quads);
}

}  // namespace docent
