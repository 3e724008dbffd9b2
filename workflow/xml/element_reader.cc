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

bool Contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// What to say where no known word is near.
std::string Otherwise(const std::vector<std::string>& known, std::string_view what) {
  return known.empty() ? Concat("it has no ", what) : Concat("known here: ", ListOf(known));
}

bool IsBlankByte(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool IsWordByte(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' ||
         (static_cast<unsigned char>(c) & 0x80) != 0;
}

// The offset of `word` where it stands in `text` as a whole word, and once; npos otherwise.
size_t OnlyPlaceOf(std::string_view word, std::string_view text) {
  size_t place = std::string_view::npos;
  if (word.empty()) return place;
  for (size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const bool within =
        (at > 0 && IsWordByte(text[at - 1]) && IsWordByte(word[0])) ||
        (at + word.size() < text.size() && IsWordByte(text[at + word.size()]) && IsWordByte(word.back()));
    if (within) continue;
    if (place != std::string_view::npos) return std::string_view::npos;
    place = at;
  }
  return place;
}

}  // namespace

std::string XmlEscaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&apos;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string ListOf(const std::vector<std::string>& words) {
  std::string out;
  for (size_t i = 0; i < words.size(); ++i) {
    if (i > 0) out += i + 1 == words.size() ? " and " : ", ";
    out += words[i];
  }
  return out;
}

Diagnostic& ElementReader::Add(Diagnostic::Severity severity, const SourceSpan& span, std::string message,
                               const Advice& advice) {
  Counts& count = severity == Diagnostic::Severity::kError ? errors_ : warnings_;
  if (count.kept == kMaxDiagnostics) {
    ++count.left_out;
    dropped_ = {};
    return dropped_;
  }
  ++count.kept;
  diagnostics_.push_back({file_, span, std::move(message), advice.hint, severity});
  Diagnostic& report = diagnostics_.back();
  if (!advice.right.empty() && span.offset + span.length <= source_.size()) {
    const std::string wrong = XmlEscaped(advice.wrong);
    const size_t at = OnlyPlaceOf(wrong, source_.substr(span.offset, span.length));
    if (at != std::string_view::npos)
      report.fix.push_back({span.offset + at, wrong.size(), XmlEscaped(advice.right)});
  }
  return report;
}

Diagnostic& ElementReader::Error(const SourceSpan& span, std::string message, const Advice& advice) {
  return Add(Diagnostic::Severity::kError, span, std::move(message), advice);
}

Diagnostic& ElementReader::Warning(const SourceSpan& span, std::string message, const Advice& advice) {
  return Add(Diagnostic::Severity::kWarning, span, std::move(message), advice);
}

Advice ElementReader::DidYouMean(std::string_view word, const std::vector<std::string>& known,
                                 std::string otherwise) const {
  constexpr size_t kMaxCandidates = 5000;
  const bool many = full(Diagnostic::Severity::kError) || full(Diagnostic::Severity::kWarning);
  if (many || known.size() > kMaxCandidates) return otherwise;
  std::string near = Nearest(word, known);
  if (near.empty()) return otherwise;
  std::string hint = Concat("did you mean ", near, "?");
  return Advice(std::move(hint), word, std::move(near));
}

TextEdit ElementReader::Removal(const SourceSpan& element) const {
  size_t begin = element.offset;
  const size_t end = element.offset + element.length;
  while (begin > 0 && (source_[begin - 1] == ' ' || source_[begin - 1] == '\t')) --begin;
  const bool begins_line = begin > 0 && source_[begin - 1] == '\n';
  const bool ends_line = end >= source_.size() || source_[end] == '\n' || source_[end] == '\r';
  if (!begins_line || !ends_line) return {element.offset, element.length, ""};
  --begin;
  if (begin > 0 && source_[begin - 1] == '\r') --begin;
  return {begin, end - begin, ""};
}

TextEdit ElementReader::AttributeRemoval(const SourceSpan& value) const {
  size_t begin = value.offset;
  size_t end = value.offset + value.length;
  const auto is_blank = [&](size_t i) { return IsBlankByte(source_[i]); };
  while (begin > 0 && is_blank(begin - 1)) --begin;
  if (begin == 0) return {value.offset, 0, ""};
  const char quote = source_[--begin];
  while (end < source_.size() && source_[end] != quote) ++end;
  end = std::min(end + 1, source_.size());
  while (begin > 0 && is_blank(begin - 1)) --begin;
  if (begin > 0 && source_[begin - 1] == '=') --begin;
  while (begin > 0 && is_blank(begin - 1)) --begin;
  while (begin > 0 && !is_blank(begin - 1)) --begin;  // its name
  while (begin > 0 && is_blank(begin - 1)) --begin;
  return {begin, end - begin, ""};
}

Diagnostics ElementReader::TakeDiagnostics() {
  std::stable_sort(diagnostics_.begin(), diagnostics_.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.span.offset < b.span.offset; });
  if (errors_.left_out > 0) {
    diagnostics_.push_back(
        {file_, {}, absl::StrCat(errors_.left_out, " further mistakes are not shown"), ""});
  }
  if (warnings_.left_out > 0) {
    diagnostics_.push_back({file_,
                            {},
                            absl::StrCat(warnings_.left_out, " further warnings are not shown"),
                            "",
                            Diagnostic::Severity::kWarning});
  }
  errors_ = warnings_ = {};
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
    if (a.prefix.empty() || a.namespace_iri == extension_ns_) {
      UnknownAttribute(element, a, known, extensions);
    } else if (a.prefix != "xml" && a.namespace_iri.empty()) {
      Diagnostic& report =
          Error(a.name_span, Concat("prefix ", a.prefix, ": of attribute ", a.name, " is not declared"),
                Concat("extensions need xmlns:", a.prefix, "=\"", extension_ns_, "\" on the root element"));
      if (Contains(extensions, a.name)) report.fix = {ExtensionDeclaration(a.prefix)};
    } else if (IsOurs(a.namespace_iri)) {
      Error(a.name_span,
            Concat("attribute ", a.prefix, ":", a.name, " is of the namespace ", a.namespace_iri,
                   ", which has no attributes here"),
            Concat("extensions are of ", extension_ns_));
    }
  }
}

void ElementReader::UnknownAttribute(const Element& element, const xml::Attribute& a,
                                     const std::vector<std::string>& known,
                                     const std::vector<std::string>& extensions) {
  const bool ours = !a.prefix.empty();
  const std::vector<std::string>& allowed = ours ? extensions : known;
  if (Contains(allowed, a.name)) return;
  const std::string message =
      Concat("unknown ", ours ? "extension " : "attribute ", a.name, " of <", element.name, ">");
  const TextEdit rename{a.name_span.offset, a.name_span.length, ""};
  if (ours && Contains(known, a.name)) {
    Error(a.name_span, message, Concat("write it without prefix: ", a.name)).fix = {
        {rename.offset, rename.length, a.name}};
  } else if (!ours && Contains(extensions, a.name)) {
    Diagnostic& report =
        Error(a.name_span, message,
              Concat("it is an extension: declare xmlns:ext=\"", extension_ns_, "\" and write ext:", a.name));
    std::string prefix = ExtensionPrefix(element);
    if (prefix.empty()) {
      prefix = "ext";
      if (element.namespaces->contains(prefix)) return;  // it stands for something else
      report.fix.push_back(ExtensionDeclaration(prefix));
    }
    report.fix.push_back({rename.offset, rename.length, Concat(prefix, ":", a.name)});
  } else {
    Error(a.name_span, message,
          DidYouMean(a.name, allowed, Otherwise(allowed, ours ? "extensions" : "attributes")));
  }
}

std::string ElementReader::ExtensionPrefix(const Element& element) const {
  for (const auto& [prefix, iri] : *element.namespaces) {
    if (!prefix.empty() && iri == extension_ns_) return prefix;
  }
  return "";
}

TextEdit ElementReader::ExtensionDeclaration(std::string_view prefix) const {
  return {root_->name_span.offset + root_->name_span.length, 0,
          Concat(" xmlns:", prefix, "=\"", extension_ns_, "\"")};
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
  Diagnostic& report =
      Error(child.name_span, Concat("unknown element <", child.name, "> in <", parent.name, ">"),
            DidYouMean(child.name, known, Otherwise(known, "child elements")));
  if (report.fix.empty() || child.start_tag.length == child.span.length) return;
  // The end tag has the same name.
  const size_t end_tag = source_.rfind("</", child.span.offset + child.span.length - 1);
  const size_t shift = report.fix[0].offset - child.name_span.offset;
  report.fix.push_back({end_tag + 2 + shift, report.fix[0].length, report.fix[0].replacement});
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
  Error(Within(text, error.offset, error.length), error.message,
        Advice(error.hint, error.wrong, error.right));
  return std::nullopt;
}

SourceSpan ElementReader::Within(const Text& text, size_t offset, size_t length) const {
  if (text.value.size() != text.span.length) return text.span;
  return Span(text.span.offset + offset, length);
}

}  // namespace docent::xml
