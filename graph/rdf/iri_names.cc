#include "graph/rdf/iri_names.h"

#include <algorithm>

#include "graph/base/text.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/turtle_scanner.h"
#include "graph/rdf/utf8.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

bool IsForbidden(std::string_view iri) {
  return std::any_of(iri.begin(), iri.end(), [](unsigned char c) { return IsForbiddenInIri(c); });
}

// True if "prefix:" can be declared in Turtle.
bool IsPrefix(std::string_view prefix) {
  if (FindInvalidUtf8(prefix)) return false;
  const std::string declared = Concat(prefix, ":");
  TurtleScanner scanner(declared, /*line_based=*/false, declared.size());
  std::string_view read;
  return scanner.ReadPrefix(&read) && read == prefix && scanner.AtEnd();
}

// The end of the literal that begins at the quote `at`, past its closing quote.
size_t EndOfQuotes(std::string_view text, size_t at) {
  for (++at; at < text.size() && text[at] != '"'; ++at) {
    if (text[at] == '\\') ++at;
  }
  return std::min(at + 1, text.size());
}

}  // namespace

bool IsPrefixedName(std::string_view prefix, std::string_view local) {
  if (FindInvalidUtf8(local) || local.find('\\') != std::string_view::npos) return false;
  const std::string name = Concat(prefix, ":", local);
  TurtleScanner scanner(name, /*line_based=*/false, name.size());
  std::string_view read_prefix;
  std::string read_local;
  return scanner.ReadPrefixedName(&read_prefix, &read_local) && scanner.AtEnd() && read_local == local;
}

const IriNames& IriNames::WellKnown() {
  static const IriNames* const names = [] {
    auto* made = new IriNames;
    for (const auto& [prefix, name_space] : kWellKnownPrefixes) made->Add(prefix, name_space);
    return made;
  }();
  return *names;
}

void IriNames::Add(std::string_view prefix, std::string_view name_space) {
  if (!IsPrefix(prefix) || !IsAbsoluteIri(name_space) || IsForbidden(name_space)) return;
  if (taken_.emplace(prefix).second) prefixes_.emplace_back(prefix, name_space);
}

std::string IriNames::Iri(std::string_view iri) const {
  const std::pair<std::string, std::string>* best = nullptr;
  for (const auto& known : prefixes_) {
    if (iri.size() > known.second.size() && iri.starts_with(known.second) &&
        (best == nullptr || known.second.size() > best->second.size()) &&
        IsPrefixedName(known.first, iri.substr(known.second.size())))
      best = &known;
  }
  if (best == nullptr) return ToNTriples(Term::Iri(std::string(iri)));
  return Concat(best->first, ":", iri.substr(best->second.size()));
}

std::string IriNames::Show(const Term& term) const {
  if (term.IsIri()) return Iri(term.lexical);
  if (term.IsBlank()) return Concat("_:", term.lexical);
  const bool number = (term.datatype == kXsdInteger || term.datatype == kXsdDecimal) &&
                      !term.lexical.empty() &&
                      term.lexical.find_first_not_of("+-.0123456789") == std::string::npos;
  const bool truth = term.datatype == kXsdBoolean && (term.lexical == "true" || term.lexical == "false");
  if (number || truth) return term.lexical;
  if (term.datatype.empty() || !term.language.empty()) return ToNTriples(term);
  return Concat(ToNTriples(Term::Literal(term.lexical)), "^^", Iri(term.datatype));
}

std::string IriNames::InText(std::string_view text) const {
  if (prefixes_.empty()) return std::string(text);
  std::string out;
  for (size_t at = 0; at < text.size();) {
    size_t end = at + 1;
    if (text[at] == '"') {
      end = EndOfQuotes(text, at);
    } else if (const size_t close = text[at] == '<' ? text.find('>', at) : std::string_view::npos;
               close != std::string_view::npos) {
      const std::string_view iri = text.substr(at + 1, close - at - 1);
      if (IsValidTermIri(iri)) {
        out += Iri(iri);
        at = close + 1;
        continue;
      }
    }
    out += text.substr(at, end - at);
    at = end;
  }
  return out;
}

}  // namespace docent
