#include "workflow/xml/element_reader.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"

namespace docent::xml {
namespace {

constexpr std::string_view kOurNamespaces = "https://w3id.org/docent";
constexpr int kMaxRetry = 100;

// One of Docent's namespaces: "https://w3id.org/docent#", "https://w3id.org/docent/cawl-ext#" …
bool IsOurs(std::string_view name_space) {
  if (!name_space.starts_with(kOurNamespaces)) return false;
  name_space.remove_prefix(kOurNamespaces.size());
  return name_space.empty() || name_space[0] == '#' || name_space[0] == '/';
}

// What to say where no known word is near.
std::string Otherwise(const std::vector<std::string>& known, std::string_view what) {
  return known.empty() ? Concat("it has no ", what) : Concat("known here: ", ListOf(known));
}

}  // namespace

std::string ListOf(const std::vector<std::string>& words) {
  std::string out;
  for (size_t i = 0; i < words.size(); ++i) {
    if (i > 0) out += i + 1 == words.size() ? " and " : ", ";
    out += words[i];
  }
  return out;
}

void ElementReader::Add(Diagnostic::Severity severity, const SourceSpan& span, std::string message,
                        std::string hint) {
  if (diagnostics_.size() >= kMaxDiagnostics) {
    ++left_out_;
    return;
  }
  diagnostics_.push_back({file_, span, std::move(message), std::move(hint), severity});
}

void ElementReader::Error(const SourceSpan& span, std::string message, std::string hint) {
  Add(Diagnostic::Severity::kError, span, std::move(message), std::move(hint));
}

void ElementReader::Warning(const SourceSpan& span, std::string message, std::string hint) {
  Add(Diagnostic::Severity::kWarning, span, std::move(message), std::move(hint));
}

std::string ElementReader::DidYouMean(std::string_view word, const std::vector<std::string>& known,
                                      std::string otherwise) const {
  constexpr size_t kMaxCandidates = 5000;
  if (full() || known.size() > kMaxCandidates) return otherwise;
  std::string near = Nearest(word, known);
  return near.empty() ? otherwise : Concat("did you mean ", near, "?");
}

Diagnostics ElementReader::TakeDiagnostics() {
  std::stable_sort(diagnostics_.begin(), diagnostics_.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.span.offset < b.span.offset; });
  if (left_out_ > 0) {
    diagnostics_.push_back({file_, {}, absl::StrCat(left_out_, " further mistakes are not shown"), ""});
  }
  left_out_ = 0;
  return std::move(diagnostics_);
}

void ElementReader::CheckAttributes(const Element& element, const std::vector<std::string>& known,
                                    const std::vector<std::string>& extensions) {
  for (size_t i = 0; i < element.attributes.size(); ++i) {
    const xml::Attribute& a = element.attributes[i];
    for (size_t j = 0; j < i; ++j) {
      const xml::Attribute& b = element.attributes[j];
      if (a.name == b.name && a.namespace_iri == b.namespace_iri && a.prefix.empty() == b.prefix.empty()) {
        Error(a.name_span, Concat("attribute ", a.name, " stands twice"));
      }
    }
    bool ours = a.namespace_iri == extension_ns_;
    if (a.prefix.empty() || ours) {
      const std::vector<std::string>& allowed = ours ? extensions : known;
      if (std::find(allowed.begin(), allowed.end(), a.name) != allowed.end()) continue;
      bool other = std::find(ours ? known.begin() : extensions.begin(), ours ? known.end() : extensions.end(),
                             a.name) != (ours ? known.end() : extensions.end());
      std::string hint =
          other && ours ? Concat("write it without prefix: ", a.name)
          : other
              ? Concat("it is an extension: declare xmlns:ext=\"", extension_ns_, "\" and write ext:", a.name)
              : DidYouMean(a.name, allowed, Otherwise(allowed, ours ? "extensions" : "attributes"));
      Error(a.name_span,
            Concat("unknown ", ours ? "extension " : "attribute ", a.name, " of <", element.name, ">"), hint);
    } else if (a.prefix != "xml" && a.namespace_iri.empty()) {
      Error(a.name_span, Concat("prefix ", a.prefix, ": of attribute ", a.name, " is not declared"),
            Concat("extensions need xmlns:", a.prefix, "=\"", extension_ns_, "\" on the root element"));
    } else if (IsOurs(a.namespace_iri)) {
      Error(a.name_span,
            Concat("attribute ", a.prefix, ":", a.name, " is of the namespace ", a.namespace_iri,
                   ", which has no attributes here"),
            Concat("extensions are of ", extension_ns_));
    }
  }
}

bool ElementReader::IsForeign(const Element& element, std::string_view own_ns) {
  const std::string& name_space = element.namespace_iri;
  return !name_space.empty() && name_space != own_ns && !IsOurs(name_space);
}

void ElementReader::UnknownChild(const Element& parent, const Element& child,
                                 const std::vector<std::string>& known) {
  if (!child.prefix.empty() && child.namespace_iri.empty()) {
    Error(child.name_span, Concat("prefix ", child.prefix, ": of element <", child.name, "> is not declared"),
          Concat("an editor's own elements need xmlns:", child.prefix,
                 "=\"…\" on them or on the root element"));
    return;
  }
  Error(child.name_span, Concat("unknown element <", child.name, "> in <", parent.name, ">"),
        DidYouMean(child.name, known, Otherwise(known, "child elements")));
}

void ElementReader::ReadChildren(const Element& element, const ChildTable& table) {
  for (const auto& child : element.children) {
    if (child->name == "documentation" || IsForeign(*child)) continue;
    auto it = std::find_if(table.begin(), table.end(),
                           [&](const auto& entry) { return entry.first == child->name; });
    if (it != table.end()) {
      it->second(*child);
      continue;
    }
    std::vector<std::string> known;
    for (const auto& [name, unused] : table) known.emplace_back(name);
    UnknownChild(element, *child, known);
  }
  if (element.text.given()) {
    Error(element.text.span, Concat("text in <", element.name, ">"),
          "write remarks in <documentation> or in a comment");
  }
}

Text ElementReader::Trimmed(const Text& text) const {
  Text out = text;
  size_t first = text.value.find_first_not_of(" \t\n\r");
  if (first == std::string::npos) {
    out.value.clear();
    return out;
  }
  size_t length = text.value.find_last_not_of(" \t\n\r") - first + 1;
  out.span = Within(text, first, length);
  out.value = text.value.substr(first, length);
  return out;
}

Text ElementReader::Attribute(const Element& element, std::string_view name) const {
  const xml::Attribute* attribute = element.Find(name);
  return attribute != nullptr ? Trimmed(attribute->value) : Text();
}

Text ElementReader::Required(const Element& element, std::string_view name) {
  Text text = Attribute(element, name);
  if (!text.given()) {
    Error(element.name_span, Concat("<", element.name, "> needs the attribute ", name));
  } else if (text.empty()) {
    Error(text.span, Concat("attribute ", name, " of <", element.name, "> is empty"));
  }
  return text;
}

Text ElementReader::Name(const Element& element, std::string_view attribute) {
  Text name = Required(element, attribute);
  CheckName(attribute, name);
  return name;
}

Text ElementReader::OptionalName(const Element& element, std::string_view attribute) {
  Text name = Attribute(element, attribute);
  CheckName(attribute, name);
  return name;
}

void ElementReader::CheckName(std::string_view attribute, const Text& name) {
  if (const std::optional<std::string> fault = NameFault(name.value))
    Error(name.span, Concat("the ", attribute, " ", *fault), "choose another one");
}

Text ElementReader::Extension(const Element& element, std::string_view name) const {
  for (const xml::Attribute& a : element.attributes) {
    if (!a.prefix.empty() && a.name == name && a.namespace_iri == extension_ns_) return Trimmed(a.value);
  }
  return Text();
}

std::optional<int64_t> ElementReader::Duration(const Element& element, std::string_view name) {
  Text text = Extension(element, name);
  if (!text.given()) return std::nullopt;
  int64_t ms = 0;
  if (ParseDurationMs(text.value, &ms)) return ms;
  Error(text.span, Concat(name, " \"", text.value, "\" is not a duration"),
        "write a number above 0 and ms, s, min or h, e.g. 30s; at most 720h");
  return std::nullopt;
}

int ElementReader::Retry(const Element& element) {
  Text text = Extension(element, "retry");
  if (!text.given()) return 0;
  int retry = 0;
  if (absl::SimpleAtoi(text.value, &retry) && retry >= 0 && retry <= kMaxRetry) return retry;
  Error(text.span, Concat("retry \"", text.value, "\" is not a number of further attempts"),
        absl::StrCat("write a whole number from 0 to ", kMaxRetry));
  return 0;
}

bool ElementReader::Flag(const Element& element, std::string_view name) {
  Text text = Extension(element, name);
  if (!text.given() || text.value == "false") return false;
  if (text.value == "true") return true;
  Error(text.span, Concat(name, " is \"", text.value, "\""), "write true or false");
  return false;
}

std::optional<Term> ElementReader::TermOf(const Element& element, const Text& text) {
  TermError error;
  std::optional<Term> term = ParseTerm(text.value, *element.namespaces, &error);
  if (term) return term;
  Error(Within(text, error.offset, error.length), error.message, error.hint);
  return std::nullopt;
}

SourceSpan ElementReader::Within(const Text& text, size_t offset, size_t length) const {
  if (text.value.size() != text.span.length) return text.span;
  return Span(text.span.offset + offset, length);
}

}  // namespace docent::xml
