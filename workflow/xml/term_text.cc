#include "workflow/xml/term_text.h"

#include <algorithm>
#include <vector>

#include "absl/strings/ascii.h"
#include "graph/base/diagnostic.h"
#include "graph/base/text.h"
#include "graph/rdf/term_check.h"
#include "graph/rdf/utf8.h"
#include "graph/rdf/vocabulary.h"

namespace docent::xml {
namespace {

bool IsIriByte(char c) {
  return static_cast<unsigned char>(c) > 0x20 &&
         std::string_view("<>\"{}|^`\\").find(c) == std::string_view::npos;
}

bool IsLocalByte(char c) {
  return absl::ascii_isalnum(c) || static_cast<unsigned char>(c) >= 0x80 ||
         std::string_view("_-.~/%").find(c) != std::string_view::npos;
}

bool IsPrefixByte(char c) {
  return absl::ascii_isalnum(c) || static_cast<unsigned char>(c) >= 0x80 || c == '_' || c == '-' || c == '.';
}

std::optional<Term> Fail(TermError* error, size_t offset, size_t length, std::string message,
                         std::string hint) {
  *error = {offset, length, std::move(message), std::move(hint)};
  return std::nullopt;
}

// RFC 3986 section 3.1: scheme = ALPHA *( ALPHA / DIGIT / "+" / "-" / "." ) ":"
bool IsAbsolute(std::string_view iri) {
  size_t colon = iri.find(':');
  return colon != std::string_view::npos && colon > 0 && absl::ascii_isalpha(iri[0]) &&
         std::all_of(iri.begin(), iri.begin() + colon,
                     [](char c) { return absl::ascii_isalnum(c) || c == '+' || c == '-' || c == '.'; });
}

std::optional<Term> ParseIri(std::string_view text, TermError* error) {
  size_t close = text.find('>');
  if (close == std::string_view::npos) {
    return Fail(error, 0, text.size(), Concat(text, " has no closing >"), "write <https://…>");
  }
  std::string_view iri = text.substr(1, close - 1);
  if (close + 1 != text.size()) {
    return Fail(error, close + 1, text.size() - close - 1,
                Concat("unexpected ", text.substr(close + 1), " after <", iri, ">"), "one word stands here");
  }
  size_t bad = 0;
  while (bad < iri.size() && IsIriByte(iri[bad])) ++bad;
  if (bad < iri.size()) {
    return Fail(error, bad + 1, 1, Concat("the character '", iri.substr(bad, 1), "' may not stand in an IRI"),
                "");
  }
  if (!IsAbsolute(iri)) {
    return Fail(error, 0, text.size(), Concat("<", iri, "> is not an absolute IRI"),
                "write it whole, as <https://…>");
  }
  return Term::Iri(std::string(iri));
}

// What "u00E9" or "U0001F916" at the beginning of `text` stands for (Turtle, section 6.4); how many hexadecimal digits it has.
// 0: it is no such escape.
size_t AppendCodePoint(std::string_view text, std::string* out) {
  const size_t digits = text.empty() ? 0 : text[0] == 'u' ? 4 : text[0] == 'U' ? 8 : 0;
  if (digits == 0 || text.size() <= digits) return 0;
  char32_t c = 0;
  for (const char digit : text.substr(1, digits)) {
    if (!absl::ascii_isxdigit(static_cast<unsigned char>(digit))) return 0;
    c = c * 16 +
        static_cast<char32_t>(absl::ascii_isdigit(static_cast<unsigned char>(digit))
                                  ? digit - '0'
                                  : absl::ascii_tolower(static_cast<unsigned char>(digit)) - 'a' + 10);
  }
  if (c == 0 || c > 0x10FFFF || (c >= 0xD800 && c <= 0xDFFF)) return 0;
  AppendUtf8(c, out);
  return digits;
}

// "…" or '…' with what follows.
std::optional<Term> ParseQuoted(std::string_view text, const Prefixes& prefixes, TermError* error) {
  std::string value;
  size_t i = 1;
  for (; i < text.size() && text[i] != text[0]; ++i) {
    if (text[i] != '\\') {
      value.push_back(text[i]);
      continue;
    }
    static constexpr std::string_view kEscapes = "\\\"'nrt", kValues = "\\\"'\n\r\t";
    if (const size_t digits = AppendCodePoint(text.substr(i + 1), &value); digits > 0) {
      i += digits + 1;
      continue;
    }
    size_t which = i + 1 < text.size() ? kEscapes.find(text[i + 1]) : std::string_view::npos;
    if (which == std::string_view::npos) {
      return Fail(error, i, 2, "an unknown escape in a literal",
                  "known are \\\\ \\\" \\' \\n \\r \\t \\uXXXX \\UXXXXXXXX");
    }
    value.push_back(kValues[which]);
    ++i;
  }
  if (i >= text.size())
    return Fail(error, 0, text.size(), Concat(text, " has no closing ", text.substr(0, 1)), "");
  std::string_view rest = text.substr(i + 1);
  if (rest.empty()) return Term::Literal(std::move(value));
  if (rest[0] == '@' && IsLanguageTag(rest.substr(1))) {
    return Term::LangString(std::move(value), absl::AsciiStrToLower(ToAbsl(rest.substr(1))));
  }
  if (rest.starts_with("^^")) {
    std::optional<Term> datatype = ParseTerm(rest.substr(2), prefixes, error);
    if (!datatype) {
      error->offset += i + 3;
      return std::nullopt;
    }
    if (!datatype->IsIri())
      return Fail(error, i + 3, rest.size() - 2, "a datatype is an IRI", "e.g. ^^xsd:decimal");
    return Term::Literal(std::move(value), datatype->lexical);
  }
  return Fail(error, i + 1, rest.size(), Concat("unexpected ", rest, " after a literal"),
              "a literal may end in @language or ^^datatype");
}

// xsd:integer, xsd:decimal or xsd:double by its form.
std::optional<Term> ParseNumber(std::string_view text) {
  size_t i = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  size_t whole = 0, fraction = 0, exponent = 0;
  bool point = false, has_exponent = false;
  for (; i < text.size() && absl::ascii_isdigit(text[i]); ++i) ++whole;
  if (i < text.size() && text[i] == '.') {
    point = true;
    for (++i; i < text.size() && absl::ascii_isdigit(text[i]); ++i) ++fraction;
  }
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E') && whole + fraction > 0) {
    has_exponent = true;
    ++i;
    if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
    for (; i < text.size() && absl::ascii_isdigit(text[i]); ++i) ++exponent;
    if (exponent == 0) return std::nullopt;
  }
  if (i != text.size() || whole + fraction == 0) return std::nullopt;
  if (has_exponent) return Term::Literal(std::string(text), std::string(kXsdDouble));
  if (!point) return Term::Literal(std::string(text), std::string(kXsdInteger));
  if (fraction == 0) return std::nullopt;
  return Term::Literal(std::string(text), std::string(kXsdDecimal));
}

std::optional<Term> ParsePrefixed(std::string_view text, size_t colon, const Prefixes& prefixes,
                                  TermError* error) {
  std::string_view prefix = text.substr(0, colon);
  std::string_view local = text.substr(colon + 1);
  if (prefix == "_") {
    return Fail(error, 0, text.size(), Concat("a blank node (", text, ") cannot be named here"),
                Concat("write a free variable, ?", local));
  }
  if (!std::all_of(prefix.begin(), prefix.end(), IsPrefixByte)) {
    return Fail(error, 0, text.size(), Concat("`", text, "` is not a word of the form prefix:local"), "");
  }
  std::optional<std::string> iri = FindPrefix(prefixes, prefix);
  if (!iri) {
    std::vector<std::string> known;
    for (const auto& [name, unused] : prefixes) known.push_back(name);
    for (const auto& [name, unused] : kWellKnownPrefixes) known.emplace_back(name);
    std::string near = Nearest(prefix, known);
    std::string declare = Concat("declare it on the root element: xmlns:", prefix, "=\"…\"");
    Fail(error, 0, prefix.size(), Concat("unknown prefix ", prefix, ":"),
         near.empty() ? declare : Concat("did you mean ", near, ":? Or ", declare));
    error->wrong = prefix;
    error->right = std::move(near);
    return std::nullopt;
  }
  size_t bad = 0;
  while (bad < local.size() && IsLocalByte(local[bad])) ++bad;
  if (bad < local.size()) {
    return Fail(error, colon + 1 + bad, 1, Concat("unexpected '", local.substr(bad, 1), "' in ", text),
                "one word stands here; write <iri> for an IRI with other characters");
  }
  if (!IsAbsolute(*iri) || !std::all_of(iri->begin(), iri->end(), IsIriByte)) {
    return Fail(error, 0, prefix.size(),
                Concat("prefix ", prefix, ": is declared as \"", *iri, "\", which is not an absolute IRI"),
                Concat("declare it as xmlns:", prefix, "=\"https://…\""));
  }
  return Term::Iri(*iri + std::string(local));
}

}  // namespace

std::optional<std::string> FindPrefix(const Prefixes& prefixes, std::string_view prefix) {
  auto it = prefixes.find(std::string(prefix));
  if (it != prefixes.end() && !prefix.empty()) return it->second;
  for (const auto& [name, iri] : kWellKnownPrefixes) {
    if (name == prefix) return std::string(iri);
  }
  return std::nullopt;
}

bool IsVariableName(std::string_view name) {
  if (name.empty() || absl::ascii_isdigit(name[0]) || name[0] == '_') return false;
  for (char c : name) {
    if (!absl::ascii_isalnum(c) && c != '_') return false;
  }
  return true;
}

std::optional<Term> ParseTerm(std::string_view text, const Prefixes& prefixes, TermError* error) {
  if (text.empty()) return Fail(error, 0, 0, "a value is missing", "");
  if (text[0] == '<') return ParseIri(text, error);
  if (text[0] == '"' || text[0] == '\'') return ParseQuoted(text, prefixes, error);
  if (text == "true" || text == "false") return Term::Boolean(text == "true");
  if (absl::ascii_isdigit(text[0]) || text[0] == '+' || text[0] == '-' || text[0] == '.') {
    std::optional<Term> number = ParseNumber(text);
    if (number) return number;
    return Fail(error, 0, text.size(), Concat("`", text, "` is not a number"), "");
  }
  size_t colon = text.find(':');
  if (colon != std::string_view::npos && colon > 0) return ParsePrefixed(text, colon, prefixes, error);
  return Fail(error, 0, text.size(), Concat("`", text, "` is neither a resource nor a literal"),
              Concat("write prefix:", text, " or <iri> for a resource, \"", text, "\" for text"));
}

}  // namespace docent::xml
