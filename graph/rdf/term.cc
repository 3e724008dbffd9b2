#include "graph/rdf/term.h"

#include <cstdint>
#include <tuple>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/text.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

// Blank nodes < IRIs < literals (SPARQL 1.1 section 15.1).
int KindRank(TermKind kind) {
  switch (kind) {
    case TermKind::kBlank:
      return 0;
    case TermKind::kIri:
      return 1;
    case TermKind::kLiteral:
      return 2;
  }
  return 3;
}

// N-Triples section 3, STRING_LITERAL_QUOTE: these four must be escaped. Other control characters are escaped
// as well, so that a line stays one line on every terminal.
void AppendEscapedString(std::string_view text, std::string* out) {
  for (char c : text) {
    switch (c) {
      case '"':
        *out += "\\\"";
        break;
      case '\\':
        *out += "\\\\";
        break;
      case '\n':
        *out += "\\n";
        break;
      case '\r':
        *out += "\\r";
        break;
      case '\t':
        *out += "\\t";
        break;
      default:
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
          absl::StrAppendFormat(out, "\\u%04X", static_cast<unsigned char>(c));
        } else {
          *out += c;
        }
    }
  }
}

// N-Triples section 3, IRIREF: characters that are not allowed in <> are written as a UCHAR.
void AppendIri(std::string_view iri, std::string* out) {
  *out += '<';
  for (char c : iri) {
    if (static_cast<unsigned char>(c) <= 0x20 ||
        std::string_view("<>\"{}|^`\\").find(c) != std::string_view::npos) {
      absl::StrAppendFormat(out, "\\u%04X", static_cast<unsigned char>(c));
    } else {
      *out += c;
    }
  }
  *out += '>';
}

}  // namespace

std::string LowerLanguage(std::string_view tag) {
  std::string lower(tag);
  absl::AsciiStrToLower(&lower);
  return lower;
}

bool SameLanguage(std::string_view a, std::string_view b) {
  return a == b || absl::EqualsIgnoreCase(ToAbsl(a), ToAbsl(b));
}

Term Term::Literal(std::string lexical, std::string datatype) {
  if (datatype == kXsdString) datatype.clear();
  return {TermKind::kLiteral, std::move(lexical), std::move(datatype), ""};
}

Term Term::LangString(std::string lexical, std::string language) {
  return {TermKind::kLiteral, std::move(lexical), "", std::move(language)};
}

Term Term::Integer(int64_t value) {
  return Literal(absl::StrCat(value), std::string(kXsdInteger));
}

Term Term::Boolean(bool value) {
  return Literal(value ? "true" : "false", std::string(kXsdBoolean));
}

bool operator<(const Term& a, const Term& b) {
  int rank_a = KindRank(a.kind);
  int rank_b = KindRank(b.kind);
  const int order = std::tie(rank_a, a.lexical, a.datatype) < std::tie(rank_b, b.lexical, b.datatype)   ? -1
                    : std::tie(rank_b, b.lexical, b.datatype) < std::tie(rank_a, a.lexical, a.datatype) ? 1
                                                                                                        : 0;
  return order != 0 ? order < 0 : LowerLanguage(a.language) < LowerLanguage(b.language);
}

std::string ToNTriples(const Term& term) {
  std::string out;
  switch (term.kind) {
    case TermKind::kIri:
      AppendIri(term.lexical, &out);
      break;
    case TermKind::kBlank:
      absl::StrAppend(&out, "_:", term.lexical);
      break;
    case TermKind::kLiteral:
      out += '"';
      AppendEscapedString(term.lexical, &out);
      out += '"';
      if (!term.language.empty()) {
        absl::StrAppend(&out, "@", term.language);
      } else if (!term.datatype.empty()) {
        out += "^^";
        AppendIri(term.datatype, &out);
      }
  }
  return out;
}

std::string ToDisplay(const Term& term) {
  return IriNames::WellKnown().Show(term);
}

}  // namespace docent
