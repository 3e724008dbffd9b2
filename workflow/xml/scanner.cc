#include "workflow/xml/scanner.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"

namespace docent::xml {
namespace {

constexpr std::string_view kXmlNs = "http://www.w3.org/XML/1998/namespace";

bool IsSpace(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}
// The end of a name in well-formed XML; which characters a name may have was libxml2's business.
bool EndsName(char c) {
  return IsSpace(c) || c == '=' || c == '>' || c == '/' || c == '<' || c == '"' || c == '\'';
}

void AppendUtf8(uint32_t code, std::string* out) {
  if (code < 0x80) {
    out->push_back(static_cast<char>(code));
  } else if (code < 0x800) {
    out->push_back(static_cast<char>(0xC0 | code >> 6));
    out->push_back(static_cast<char>(0x80 | (code & 0x3F)));
  } else if (code < 0x10000) {
    out->push_back(static_cast<char>(0xE0 | code >> 12));
    out->push_back(static_cast<char>(0x80 | (code >> 6 & 0x3F)));
    out->push_back(static_cast<char>(0x80 | (code & 0x3F)));
  } else {
    out->push_back(static_cast<char>(0xF0 | code >> 18));
    out->push_back(static_cast<char>(0x80 | (code >> 12 & 0x3F)));
    out->push_back(static_cast<char>(0x80 | (code >> 6 & 0x3F)));
    out->push_back(static_cast<char>(0x80 | (code & 0x3F)));
  }
}

constexpr size_t kBlock = 256;

bool BeginsCodePoint(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
}

class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text), lines_(text) {}

  std::unique_ptr<Element> Document() {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
    if (!SkipMisc() || !Looking("<")) return nullptr;
    auto scope = std::make_shared<std::map<std::string, std::string>>();
    (*scope)["xml"] = kXmlNs;
    scopes_.push_back(scope);
    if (!OpenTag()) return nullptr;
    while (!open_.empty()) {
      if (!Content()) return nullptr;
    }
    if (!SkipMisc() || at_ != text_.size()) return nullptr;
    return std::move(root_);
  }

 private:
  bool Looking(std::string_view what) const { return text_.substr(at_).starts_with(what); }
  bool SkipPast(std::string_view end) {
    size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) return false;
    at_ = found + end.size();
    return true;
  }
  void SkipSpace() {
    while (at_ < text_.size() && IsSpace(text_[at_])) ++at_;
  }
  // Blanks, comments and processing instructions before and after the root.
  bool SkipMisc() {
    for (;;) {
      SkipSpace();
      if (Looking("<?")) {
        if (!SkipPast("?>")) return false;
      } else if (Looking("<!--")) {
        at_ += 4;
        if (!SkipPast("-->")) return false;
      } else {
        return true;
      }
    }
  }

  // One piece of content of the innermost open element.
  bool Content() {
    if (at_ >= text_.size()) return false;
    if (text_[at_] != '<') return CharacterData();
    if (Looking("<!--")) {
      at_ += 4;
      return SkipPast("-->");
    }
    if (Looking("<![CDATA[")) return CharacterDataSection();
    if (Looking("<?")) return SkipPast("?>");
    if (Looking("</")) return CloseTag();
    return OpenTag();
  }

  bool CharacterData() {
    size_t end = std::min(text_.find('<', at_), text_.size());
    Element* element = open_.back();
    while (at_ < end) {
      if (!DecodeOne(end, &element->text.value, &element->text_offsets, /*in_attribute=*/false)) return false;
    }
    return true;
  }

  bool CharacterDataSection() {
    at_ += 9;
    size_t end = text_.find("]]>", at_);
    if (end == std::string_view::npos) return false;
    Element* element = open_.back();
    for (; at_ < end; ++at_) {
      // XML 1.0 section 2.11: a line end is one line feed.
      if (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') continue;
      element->text.value.push_back(text_[at_] == '\r' ? '\n' : text_[at_]);
      element->text_offsets.push_back(at_);
    }
    at_ = end + 3;
    return true;
  }

  // One character or reference at `at_` (< end) → its value; XML 1.0 sections 2.11 and 3.3.3.
  bool DecodeOne(size_t end, std::string* out, std::vector<size_t>* offsets, bool in_attribute) {
    size_t start = at_;
    char c = text_[at_];
    if (c == '&') {
      size_t close = text_.find(';', at_);
      if (close == std::string_view::npos || close >= end) return false;
      if (!Reference(text_.substr(at_ + 1, close - at_ - 1), out)) return false;
      at_ = close + 1;
    } else {
      ++at_;
      if (c == '\r') {
        if (at_ < text_.size() && text_[at_] == '\n') ++at_;
        c = '\n';
      }
      out->push_back(in_attribute && IsSpace(c) ? ' ' : c);
    }
    if (offsets != nullptr) offsets->resize(out->size(), start);
    return true;
  }

  static bool Reference(std::string_view name, std::string* out) {
    if (name == "lt") return out->push_back('<'), true;
    if (name == "gt") return out->push_back('>'), true;
    if (name == "amp") return out->push_back('&'), true;
    if (name == "quot") return out->push_back('"'), true;
    if (name == "apos") return out->push_back('\''), true;
    if (name.size() < 2 || name[0] != '#') return false;
    bool hex = name[1] == 'x';
    name.remove_prefix(hex ? 2 : 1);
    uint32_t code = 0;
    for (char c : name) {
      if (!(hex ? absl::ascii_isxdigit(c) : absl::ascii_isdigit(c))) return false;
      uint32_t digit = absl::ascii_isdigit(c) ? c - '0' : absl::ascii_tolower(c) - 'a' + 10;
      code = code * (hex ? 16 : 10) + digit;
      if (code > 0x10FFFF) return false;
    }
    if (name.empty() || code == 0) return false;
    AppendUtf8(code, out);
    return true;
  }

  // prefix:local at `at_`.
  bool Name(std::string* prefix, std::string* local, SourceSpan* span) {
    size_t start = at_;
    while (at_ < text_.size() && !EndsName(text_[at_])) ++at_;
    if (at_ == start) return false;
    std::string_view name = text_.substr(start, at_ - start);
    size_t colon = name.find(':');
    if (colon == std::string_view::npos || colon == 0 || colon + 1 == name.size()) {
      *local = name;
    } else {
      *prefix = name.substr(0, colon);
      *local = name.substr(colon + 1);
    }
    *span = lines_.Span(start, at_ - start);
    return true;
  }

  bool OpenTag() {
    size_t start = at_++;
    auto element = std::make_unique<Element>();
    if (!Name(&element->prefix, &element->name, &element->name_span)) return false;
    std::shared_ptr<std::map<std::string, std::string>> scope = scopes_.back();
    for (;;) {
      SkipSpace();
      if (at_ >= text_.size()) return false;
      if (text_[at_] == '>' || text_[at_] == '/') break;
      if (!AttributeAt(element.get(), &scope)) return false;
    }
    ResolveNamespaces(*scope, element.get());
    element->namespaces = scope;
    bool closed = text_[at_] == '/';
    if (closed && !Looking("/>")) return false;
    at_ += closed ? 2 : 1;
    element->start_tag = lines_.Span(start, at_ - start);
    element->span = element->start_tag;
    Element* raw = element.get();
    if (open_.empty()) {
      root_ = std::move(element);
    } else {
      open_.back()->children.push_back(std::move(element));
    }
    if (!closed) {
      open_.push_back(raw);
      scopes_.push_back(scope);
    }
    return true;
  }

  bool AttributeAt(Element* element, std::shared_ptr<std::map<std::string, std::string>>* scope) {
    Attribute attribute;
    if (!Name(&attribute.prefix, &attribute.name, &attribute.name_span)) return false;
    SkipSpace();
    if (!Looking("=")) return false;
    ++at_;
    SkipSpace();
    if (at_ >= text_.size() || (text_[at_] != '"' && text_[at_] != '\'')) return false;
    size_t end = text_.find(text_[at_], at_ + 1);
    if (end == std::string_view::npos) return false;
    attribute.value.span = lines_.Span(at_ + 1, end - at_ - 1);
    for (++at_; at_ < end;) {
      if (!DecodeOne(end, &attribute.value.value, nullptr, /*in_attribute=*/true)) return false;
    }
    ++at_;
    bool is_default = attribute.prefix.empty() && attribute.name == "xmlns";
    if (is_default || attribute.prefix == "xmlns") {
      if (*scope == scopes_.back()) *scope = std::make_shared<std::map<std::string, std::string>>(**scope);
      (**scope)[is_default ? "" : attribute.name] = attribute.value.value;
      return true;
    }
    element->attributes.push_back(std::move(attribute));
    return true;
  }

  static void ResolveNamespaces(const std::map<std::string, std::string>& scope, Element* element) {
    auto find = [&scope](const std::string& prefix) {
      auto it = scope.find(prefix);
      return it == scope.end() ? std::string() : it->second;
    };
    element->namespace_iri = find(element->prefix);
    for (Attribute& a : element->attributes) {
      if (!a.prefix.empty()) a.namespace_iri = find(a.prefix);
    }
  }

  bool CloseTag() {
    at_ += 2;
    std::string prefix, name;
    SourceSpan span;
    Element* element = open_.back();
    if (!Name(&prefix, &name, &span) || name != element->name || prefix != element->prefix) return false;
    SkipSpace();
    if (!Looking(">")) return false;
    ++at_;
    element->span.length = at_ - element->span.offset;
    TrimText(element);
    open_.pop_back();
    scopes_.pop_back();
    return true;
  }

  void TrimText(Element* element) {
    std::string& value = element->text.value;
    std::vector<size_t>& offsets = element->text_offsets;
    size_t first = 0, last = value.size();
    while (first < last && IsSpace(value[first])) ++first;
    while (last > first && IsSpace(value[last - 1])) --last;
    value = value.substr(first, last - first);
    offsets = std::vector<size_t>(offsets.begin() + first, offsets.begin() + last);
    if (value.empty()) return;
    // The last byte may come from a reference: its source ends after the ";".
    size_t end = offsets.back() + 1;
    if (text_[offsets.back()] == '&') end = text_.find(';', offsets.back()) + 1;
    element->text.span = lines_.Span(offsets.front(), end - offsets.front());
  }

  std::string_view text_;
  LineIndex lines_;
  size_t at_ = 0;
  std::unique_ptr<Element> root_;
  std::vector<Element*> open_;
  std::vector<std::shared_ptr<std::map<std::string, std::string>>> scopes_;
};

}  // namespace

LineIndex::LineIndex(std::string_view text) : text_(text), starts_{0} {
  size_t code_points = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if (i % kBlock == 0) code_points_.push_back(code_points);
    if (BeginsCodePoint(text[i])) ++code_points;
    if (text[i] == '\n') starts_.push_back(i + 1);
  }
  code_points_.push_back(code_points);
}

size_t LineIndex::CodePointsBefore(size_t offset) const {
  size_t block = offset / kBlock;
  size_t count = code_points_[std::min(block, code_points_.size() - 1)];
  for (size_t i = block * kBlock; i < offset; ++i) {
    if (BeginsCodePoint(text_[i])) ++count;
  }
  return count;
}

SourceSpan LineIndex::Span(size_t offset, size_t length) const {
  offset = std::min(offset, text_.size());
  auto line = std::upper_bound(starts_.begin(), starts_.end(), offset) - 1;
  int column = static_cast<int>(CodePointsBefore(offset) - CodePointsBefore(*line)) + 1;
  return {static_cast<int>(line - starts_.begin()) + 1, column, offset, length};
}

std::unique_ptr<Element> ScanXml(std::string_view text) {
  return Scanner(text).Document();
}

}  // namespace docent::xml
