#include "graph/rdf/xml_entities.h"

#include <algorithm>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

// The offset of a document type definition, which can stand only before the first element.
std::optional<size_t> FindDoctype(std::string_view text) {
  size_t at = 0;
  while (true) {
    at = text.find_first_not_of(kSpace, at);
    if (at == std::string_view::npos) return std::nullopt;
    std::string_view rest = text.substr(at);
    std::string_view end;
    if (rest.starts_with("<!DOCTYPE")) return at;
    if (rest.starts_with("<?"))
      end = "?>";
    else if (rest.starts_with("<!--"))
      end = "-->";
    else
      return std::nullopt;
    at = text.find(end, at + 2);
    if (at == std::string_view::npos) return std::nullopt;
    at += end.size();
  }
}

bool IsNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
         c == '.' || c == ':' || (static_cast<unsigned char>(c) & 0x80) != 0;
}

// What may stand in an attribute, whichever quotes that has.
std::string Quoted(std::string_view value) {
  std::string out;
  for (const char c : value) {
    if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else {
      out += kSpace.find(c) == std::string_view::npos ? c : ' ';
    }
  }
  return out;
}

class Expander {
 public:
  Expander(std::string_view text, const ParseRdfOptions& options, Diagnostics* diagnostics)
      : text_(text), options_(options), diagnostics_(diagnostics) {}

  std::optional<std::string> Run(size_t doctype) {
    at_ = doctype;
    if (!ReadDoctype()) return std::nullopt;
    std::string out(text_.substr(0, doctype));
    out.append(static_cast<size_t>(std::count(text_.begin() + doctype, text_.begin() + at_, '\n')), '\n');
    if (!Copy(&out)) return std::nullopt;
    return out;
  }

 private:
  std::nullopt_t Refuse(size_t at, std::string message, std::string hint) {
    diagnostics_->push_back({options_.file, SpanAt(text_, at, 1), std::move(message), std::move(hint)});
    return std::nullopt;
  }
  bool RefuseHere(const std::string& what) {
    Refuse(at_,
           Concat("a document type definition is refused where it ", what,
                  ": it could fetch or expand without end"),
           "write only <!ENTITY name \"text\"> in <!DOCTYPE rdf:RDF [ … ]>, or none at all");
    return false;
  }

  void SkipSpace() { at_ = std::min(text_.find_first_not_of(kSpace, at_), text_.size()); }
  bool Take(std::string_view word) {
    if (!text_.substr(at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  std::string_view TakeName() {
    const size_t start = at_;
    while (at_ < text_.size() && IsNameCharacter(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }

  // XML 1.0 [28] doctypedecl, without an external identifier.
  bool ReadDoctype() {
    Take("<!DOCTYPE");
    SkipSpace();
    TakeName();
    SkipSpace();
    if (Take(">")) return true;
    if (!Take("[")) return RefuseHere("names an external subset");
    while (true) {
      SkipSpace();
      if (Take("]")) break;
      if (Take("<!--")) {
        const size_t end = text_.find("-->", at_);
        if (end == std::string_view::npos) return RefuseHere("does not end");
        at_ = end + 3;
      } else if (!ReadEntity()) {
        return false;
      }
    }
    SkipSpace();
    return Take(">") || RefuseHere("goes on after ]");
  }

  // [71] GEDecl with an entity value: <!ENTITY name "text">
  bool ReadEntity() {
    if (!Take("<!ENTITY")) return RefuseHere("holds anything but entities");
    SkipSpace();
    const std::string_view name = TakeName();
    if (name.empty()) return RefuseHere("declares a parameter entity");
    SkipSpace();
    const char quote = at_ < text_.size() ? text_[at_] : '\0';
    if (quote != '"' && quote != '\'') return RefuseHere("declares an external entity");
    const size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) return RefuseHere("does not end");
    const std::string_view value = text_.substr(at_ + 1, end - at_ - 1);
    if (value.find_first_of("&%<") != std::string_view::npos)
      return RefuseHere("declares an entity that holds & % or <");
    entities_.try_emplace(std::string(name), Quoted(value));  // the first declaration counts
    at_ = end + 1;
    SkipSpace();
    return Take(">") || RefuseHere("goes on after an entity's text");
  }

  // The rest of the text with its entities replaced, but for comments and CDATA sections.
  bool Copy(std::string* out) {
    while (at_ < text_.size()) {
      const size_t next = std::min(text_.find_first_of("&<", at_), text_.size());
      out->append(text_.substr(at_, next - at_));
      at_ = next;
      if (at_ >= text_.size()) break;
      if (text_[at_] == '&') {
        CopyReference(out);
      } else if (text_.substr(at_).starts_with("<!--")) {
        CopyUntil("-->", out);
      } else if (text_.substr(at_).starts_with("<![CDATA[")) {
        CopyUntil("]]>", out);
      } else {
        out->push_back(text_[at_++]);
      }
      if (out->size() > options_.limits.document_bytes) {
        Refuse(at_,
               absl::StrCat(
                   "with its entities written out the document is larger than the limit document_bytes = ",
                   options_.limits.document_bytes),
               "load it in parts");
        return false;
      }
    }
    return true;
  }

  void CopyUntil(std::string_view end, std::string* out) {
    size_t stop = text_.find(end, at_);
    stop = stop == std::string_view::npos ? text_.size() : stop + end.size();
    out->append(text_.substr(at_, stop - at_));
    at_ = stop;
  }

  void CopyReference(std::string* out) {
    const size_t start = at_++;
    const std::string_view name = TakeName();
    const auto known = entities_.find(std::string(name));
    if (known != entities_.end() && Take(";")) {
      out->append(known->second);
    } else {
      out->append(text_.substr(start, at_ - start));
    }
  }

  std::string_view text_;
  const ParseRdfOptions& options_;
  Diagnostics* diagnostics_;
  size_t at_ = 0;
  absl::flat_hash_map<std::string, std::string> entities_;
};

}  // namespace

std::optional<std::string> ExpandEntities(std::string_view text, const ParseRdfOptions& options,
                                          Diagnostics* diagnostics) {
  const std::optional<size_t> doctype = FindDoctype(text);
  if (!doctype) return std::nullopt;
  return Expander(text, options, diagnostics).Run(*doctype);
}

}  // namespace docent
