#include "graph/sparql/syntax/parser.h"

#include "graph/base/overload.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/grammar.h"

namespace docent::sparql {
namespace {

// Checks made before the lexer sees the text. `stopped`, if not null, is told of a limit.
std::optional<Diagnostic> Refuse(std::string_view text, const ParseOptions& options, bool update = false,
                                 absl::Status* stopped = nullptr) {
  const size_t limit = update ? options.limits.update_text_bytes : options.limits.query_text_bytes;
  if (text.size() > limit) {
    const std::string message = "the text has " + std::to_string(text.size()) + " bytes, the limit " +
                                (update ? "update_text_bytes" : "query_text_bytes") + " is " +
                                std::to_string(limit);
    if (stopped != nullptr) *stopped = absl::ResourceExhaustedError(message);
    return Diagnostic{options.file, {}, message, ""};
  }
  const size_t bad = FindInvalidUtf8(text);
  if (bad == std::string_view::npos) return std::nullopt;
  SourceSpan span;  // built by hand, because SpanAt counts code points and this is not UTF-8
  span = SpanAt(text.substr(0, bad), bad);
  return Diagnostic{options.file, span,
                    text[bad] == '\0' ? "U+0000 is not allowed in a query" : "this byte is not UTF-8",
                    "save the text as UTF-8"};
}

}  // namespace

std::vector<std::pair<std::string, std::string>> WellKnownPrefixes() {
  std::vector<std::pair<std::string, std::string>> out;
  for (const auto& [prefix, iri] : kWellKnownPrefixes) out.emplace_back(prefix, iri);
  return out;
}

ParseOptions ParseOptionsWith(const Limits& limits, const FunctionRegistry* functions) {
  ParseOptions options;
  options.prefixes = WellKnownPrefixes();
  options.limits = limits;
  options.functions = functions;
  return options;
}

ParsedQuery ParseQuery(std::string_view text, const ParseOptions& options) {
  ParsedQuery parsed;
  if (std::optional<Diagnostic> refused = Refuse(text, options, false, &parsed.stopped)) {
    parsed.diagnostics.push_back(*std::move(refused));
    return parsed;
  }
  Grammar grammar(text, options);
  const bool whole = grammar.QueryUnit(&parsed.query);
  parsed.stopped = grammar.stopped();
  parsed.diagnostics = grammar.TakeDiagnostics();
  if (!whole) parsed.query = Query();
  return parsed;
}

ParsedUpdate ParseUpdate(std::string_view text, const ParseOptions& options) {
  ParsedUpdate parsed;
  if (std::optional<Diagnostic> refused = Refuse(text, options, true, &parsed.stopped)) {
    parsed.diagnostics.push_back(*std::move(refused));
    return parsed;
  }
  Grammar grammar(text, options);
  std::optional<Update> update = grammar.UpdateUnit();
  parsed.stopped = grammar.stopped();
  parsed.diagnostics = grammar.TakeDiagnostics();
  if (update) parsed.update = *std::move(update);
  return parsed;
}

namespace {

absl::Status StatusOf(const absl::Status& stopped, const Diagnostics& diagnostics, std::string_view text) {
  absl::Status mistakes = ToStatus(diagnostics, text);
  if (stopped.ok()) return mistakes;
  return absl::IsResourceExhausted(stopped) ? WithMessage(stopped, FromAbsl(mistakes.message())) : stopped;
}

}  // namespace

absl::Status ToStatus(const ParsedQuery& parsed, std::string_view text) {
  return StatusOf(parsed.stopped, parsed.diagnostics, text);
}

absl::Status ToStatus(const ParsedUpdate& parsed, std::string_view text) {
  return StatusOf(parsed.stopped, parsed.diagnostics, text);
}

ParsedExpression ParseExpression(std::string_view text, const ParseOptions& options) {
  ParsedExpression parsed;
  if (std::optional<Diagnostic> refused = Refuse(text, options)) {
    parsed.diagnostics.push_back(*std::move(refused));
    return parsed;
  }
  Grammar grammar(text, options);
  parsed.expression = grammar.ParseExpression();
  if (parsed.expression && grammar.Peek().kind != TokenKind::kEnd)
    grammar.Expected("the end of the expression");
  parsed.diagnostics = grammar.diagnostics();
  if (!parsed.ok()) parsed.expression = nullptr;
  return parsed;
}

struct ProductionParser::Impl {
  Impl(std::string_view text, const ParseOptions& given)
      : options(given),
        refused(Refuse(text, options)),
        grammar(refused ? std::string_view() : text, options) {
    if (refused) grammar.Error(refused->span, refused->message, refused->hint);
  }
  const ParseOptions options;
  std::optional<Diagnostic> refused;
  mutable Grammar grammar;  // looking ahead fills its buffer
};

ProductionParser::ProductionParser(std::string_view text, const ParseOptions& options)
    : impl_(std::make_unique<Impl>(text, options)) {}
ProductionParser::~ProductionParser() = default;

bool ProductionParser::Prologue() {
  return impl_->grammar.Prologue();
}

std::optional<std::vector<TriplePattern>> ProductionParser::TriplesTemplateInBraces() {
  return impl_->grammar.TemplateInBraces();
}

AlgebraPtr ProductionParser::GroupGraphPattern() {
  impl_->grammar.blank_bgp_.clear();
  impl_->grammar.BeginCounts();  // a document holds many queries; the limits are for each
  return impl_->grammar.GroupGraphPattern();
}

ExpressionPtr ProductionParser::Expression() {
  return impl_->grammar.ParseExpression();
}
std::optional<Term> ProductionParser::Iri() {
  return impl_->grammar.Iri();
}
std::optional<Term> ProductionParser::GroundTerm() {
  return impl_->grammar.GroundTerm();
}
std::optional<std::string> ProductionParser::String() {
  return impl_->grammar.String();
}
bool ProductionParser::AcceptKeyword(std::string_view keyword) {
  return impl_->grammar.AcceptWord(Keyword(keyword));
}
bool ProductionParser::AtKeyword(std::string_view keyword) const {
  return impl_->grammar.AtWord(Keyword(keyword));
}
bool ProductionParser::AtPunctuation(std::string_view punctuation) const {
  return impl_->grammar.At(punctuation);
}
bool ProductionParser::AtWord() const {
  return impl_->grammar.Peek().kind == TokenKind::kWord;
}
bool ProductionParser::AtEnd() const {
  return impl_->grammar.Peek().kind == TokenKind::kEnd;
}
SourceSpan ProductionParser::Here() const {
  return impl_->grammar.Peek().span;
}

void ProductionParser::Error(const SourceSpan& at, std::string message, std::string hint) {
  impl_->grammar.Error(at, std::move(message), std::move(hint));
}

void ProductionParser::Error(std::string message, std::string hint) {
  impl_->grammar.Error(Here(), std::move(message), std::move(hint));
}

void ProductionParser::SkipPastBrace() {
  impl_->grammar.SkipPastBrace();
}

const std::vector<std::pair<std::string, std::string>>& ProductionParser::prefixes() const {
  return impl_->grammar.prefixes();
}

const Diagnostics& ProductionParser::diagnostics() const {
  return impl_->grammar.diagnostics();
}

}  // namespace docent::sparql
