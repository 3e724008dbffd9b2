#include "graph/rdf/term_check.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/overload.h"
#include "graph/base/text.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/turtle_scanner.h"
#include "graph/rdf/utf8.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

absl::Status Wrong(std::string message) {
  return absl::InvalidArgumentError(message);
}

// The beginning of the text for a message, or a placeholder if it cannot be shown.
std::string Shown(std::string_view text) {
  constexpr size_t kShown = 80;
  if (FindInvalidUtf8(text)) return "(not UTF-8)";
  if (text.size() <= kShown) return std::string(text);
  size_t end = 0;
  while (end < kShown) NextCodePoint(text, &end);
  return Concat(text.substr(0, end), "…");
}

absl::Status CheckText(std::string_view text, std::string_view what, size_t term_bytes) {
  if (text.size() > term_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("the ", ToAbsl(what), " has ", text.size(),
                                                     " bytes, the limit term_bytes is ", term_bytes));
  }
  if (std::optional<size_t> at = FindInvalidUtf8(text)) {
    return Wrong(absl::StrFormat("byte %d of the %s (0x%02X) is not UTF-8", *at, ToAbsl(what),
                                 static_cast<unsigned char>(text[*at])));
  }
  return absl::OkStatus();
}

absl::Status CheckIri(std::string_view iri) {
  if (iri.empty()) return Wrong("the IRI is empty");
  if (!IsAbsoluteIri(iri)) {
    return Wrong(Concat("the IRI <", Shown(iri), "> is relative: write it whole, with its scheme"));
  }
  if (!IsValidTermIri(iri)) {
    return Wrong(Concat("the IRI <", Shown(iri), "> holds a character that must be percent-encoded"));
  }
  return absl::OkStatus();
}

bool IsBlankLabel(std::string_view label) {
  std::string text = Concat("_:", label);
  std::string_view read;
  TurtleScanner scanner(text, /*line_based=*/true, text.size());
  return !label.empty() && scanner.ReadBlankLabel(&read) && read == label;
}

absl::Status InPosition(std::string_view position, const absl::Status& status) {
  if (status.ok()) return status;
  return WithMessage(status, Concat(position, ": ", FromAbsl(status.message())));
}

}  // namespace

bool IsLanguageTag(std::string_view tag) {
  std::string text = Concat("@", tag);
  std::string_view read;
  TurtleScanner scanner(text, /*line_based=*/true, text.size());
  return scanner.ReadLanguage(&read) && read == tag;
}

absl::Status CheckTerm(const Term& term, size_t term_bytes) {
  std::string_view what = term.IsIri() ? "IRI" : term.IsBlank() ? "blank node label" : "literal";
  if (absl::Status text = CheckText(term.lexical, what, term_bytes); !text.ok()) return text;
  if (term.IsIri()) return CheckIri(term.lexical);
  if (term.IsBlank()) {
    if (IsBlankLabel(term.lexical)) return absl::OkStatus();
    return Wrong(Concat("'", Shown(term.lexical),
                        "' is not a blank node label: use letters, digits, '_', '-' and '.' inside"));
  }
  if (!term.language.empty()) {
    if (!term.datatype.empty()) return Wrong("a literal has a language or a datatype, not both");
    if (absl::Status text = CheckText(term.language, "language tag", term_bytes); !text.ok()) return text;
    if (!IsLanguageTag(term.language)) {
      return Wrong(Concat("'", Shown(term.language), "' is not a language tag such as en or en-gb"));
    }
  }
  if (term.datatype.empty()) return absl::OkStatus();
  if (term.datatype == kRdfLangString)
    return Wrong("a literal of datatype rdf:langString has a language instead: \"text\"@en");
  if (absl::Status text = CheckText(term.datatype, "datatype", term_bytes); !text.ok()) return text;
  return InPosition("datatype", CheckIri(term.datatype));
}

absl::Status CheckQuad(const TermQuad& quad, size_t term_bytes) {
  if (quad.subject.IsLiteral()) {
    return Wrong(Concat("subject: the literal \"", Shown(quad.subject.lexical), "\" can't be a subject"));
  }
  if (!quad.predicate.IsIri()) {
    return Wrong(Concat("predicate: ", quad.predicate.IsBlank() ? "a blank node" : "a literal",
                        " can't be a predicate"));
  }
  if (quad.graph.IsLiteral()) return Wrong("graph: a literal can't name a graph");
  if (absl::Status s = InPosition("subject", CheckTerm(quad.subject, term_bytes)); !s.ok()) return s;
  if (absl::Status s = InPosition("predicate", CheckTerm(quad.predicate, term_bytes)); !s.ok()) return s;
  if (absl::Status s = InPosition("object", CheckTerm(quad.object, term_bytes)); !s.ok()) return s;
  if (quad.graph.lexical.empty()) return absl::OkStatus();
  return InPosition("graph", CheckTerm(quad.graph, term_bytes));
}

}  // namespace docent
