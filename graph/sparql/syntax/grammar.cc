#include "graph/sparql/syntax/grammar.h"

#include <algorithm>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/text.h"

namespace docent::sparql {
namespace {

constexpr size_t kMaxErrors = 20;  // more errors in one text do not help a person

// The namespace of the first that has the name; null: none.
const std::string* Known(const std::vector<std::pair<std::string, std::string>>& prefixes,
                         std::string_view name) {
  for (const auto& [prefix, name_space] : prefixes) {
    if (prefix == name) return &name_space;
  }
  return nullptr;
}

}  // namespace

Grammar::Grammar(std::string_view text, const ParseOptions& options)
    : options_(options),
      text_(text),
      lexer_(text),
      base_iri_(options.base_iri),
      own_(options.limits.query_memory_bytes),
      memory_(options.memory != nullptr ? options.memory : &own_) {
  Charge(text.size());  // of names and terms
}

const Token* Grammar::Read(Token* place) {
  if (++tokens_ % kTokensALook == 0) Look();
  if (!ended_) lexer_.Next(place);
  while (!ended_ && place->kind == TokenKind::kError) {
    ReportError(*place);
    lexer_.Next(place);
  }
  if (ended_) *place = {TokenKind::kEnd, 0, place->span, {}, {}};
  return place;
}

void Grammar::ReportError(const Token& token) {
  Error(token.span, std::string(token.text), std::string(token.prefix));
}

bool Grammar::Expect(std::string_view punctuation, std::string_view where) {
  if (Accept(punctuation)) return true;
  Expected(Concat("'", punctuation, "' ", where));
  return false;
}

bool Grammar::ExpectWord(const Keyword& keyword, std::string_view where) {
  if (AcceptWord(keyword)) return true;
  Expected(Concat(keyword.text, " ", where));
  return false;
}

void Grammar::Error(const SourceSpan& span, std::string message, std::string hint) {
  if (ended_) return;
  for (const Diagnostic& d : diagnostics_) {
    if (d.span.offset == span.offset) return;  // a follow-up error at the same place
  }
  diagnostics_.push_back({options_.file, span, std::move(message), std::move(hint)});
  ended_ = diagnostics_.size() == kMaxErrors;
}

std::string Grammar::Describe(const Token& token) const {
  switch (token.kind) {
    case TokenKind::kEnd:
      return "the end of the text";
    case TokenKind::kIri:
      return Concat("<", token.text, ">");
    case TokenKind::kPrefixedName:
      return Concat(token.prefix, ":", token.text);
    case TokenKind::kBlankLabel:
      return Concat("_:", token.text);
    case TokenKind::kVariable:
      return Concat("?", token.text);
    case TokenKind::kString:
      return Concat("the string \"", token.text.substr(0, 40), "\"");
    case TokenKind::kLanguage:
      return Concat("@", token.text);
    default:
      return Concat("'", token.text, "'");
  }
}

namespace {

// Hint for constructs of other languages and misspelt keywords; empty: none.
std::string HintFor(const Token& token) {
  if (token.Is("<")) return "'<' begins no IRI here: an IRI holds no space and ends with '>'";
  if (token.Is("=")) return "SPARQL compares with one '='";
  if (token.kind == TokenKind::kIri && token.text.empty()) return "SPARQL writes 'not equal' as !=";
  if (token.kind != TokenKind::kWord) return "";
  if (EqualsIgnoreCase(token.text, "AND")) return "SPARQL writes 'and' as &&";
  if (EqualsIgnoreCase(token.text, "OR")) return "SPARQL writes 'or' as ||";
  static const std::vector<std::string> kKeywords = {
      "SELECT",   "ASK",     "CONSTRUCT", "DESCRIBE", "PREFIX", "BASE",   "FROM",   "NAMED",  "WHERE",
      "DISTINCT", "REDUCED", "OPTIONAL",  "UNION",    "MINUS",  "FILTER", "BIND",   "VALUES", "GRAPH",
      "SERVICE",  "SILENT",  "GROUP",     "HAVING",   "ORDER",  "LIMIT",  "OFFSET", "INSERT", "DELETE",
      "DATA",     "WITH",    "USING",     "LOAD",     "CLEAR",  "CREATE", "DROP",   "EXISTS", "INTO"};
  for (const std::string& keyword : kKeywords) {
    if (EqualsIgnoreCase(token.text, keyword)) return "";  // spelt correctly, at a wrong place
  }
  std::string word(token.text);
  for (char& c : word) c = AsciiUpper(c);
  const std::string near = Nearest(word, kKeywords);
  return near.empty() ? "" : Concat("did you mean ", near, "?");
}

}  // namespace

void Grammar::Expected(std::string_view what, std::string hint) {
  const Token& token = Peek();
  if (hint.empty()) hint = HintFor(token);
  Error(token.span, Concat("expected ", what, ", not ", Describe(token)), std::move(hint));
}

Grammar::Nested::Nested(Grammar* grammar) : grammar_(grammar) {
  const int limit = grammar->options_.limits.query_nesting;
  if (++grammar->depth_ > limit) {
    grammar->PastLimit(grammar->Peek().span,
                       "nested deeper than the limit query_nesting = " + std::to_string(limit),
                       "split the query, or join the groups without nesting them");
  }
  ok_ = !grammar->ended_;
}

void Grammar::SkipPastBrace() {
  for (int open = 0; Peek().kind != TokenKind::kEnd;) {
    const Token token = Take();
    if (token.Is("{")) ++open;
    if (token.Is("}") && --open <= 0) return;
  }
}

bool Grammar::Resolve(const Token& iri, std::string* out) {
  if (!IsAbsoluteIri(iri.text)) return ResolveRelative(iri, out);
  *out = std::string(iri.text);
  return true;
}

bool Grammar::ResolveRelative(const Token& iri, std::string* out) {
  if (base_iri_.empty()) {
    Error(iri.span, Concat("<", iri.text, "> is relative and no BASE is known"),
          iri.text.find(':') == std::string::npos
              ? "write BASE <http://…/> before the query, or the whole IRI"
              : "");
    return false;
  }
  *out = ResolveIri(iri.text, base_iri_);
  return CountExpanded(iri.span, out->size());
}

bool Grammar::Expand(const Token& name, std::string* out) {
  const std::string* iri = nullptr;
  if (const int* declared = declared_.Find(name.prefix)) {
    iri = &prefixes_[static_cast<size_t>(*declared)].second;
  } else {
    iri = Known(options_.prefixes, name.prefix);
    if (iri == nullptr && options_.known != nullptr) iri = Known(options_.known->prefixes(), name.prefix);
    if (iri == nullptr) return Undeclared(name);
  }
  out->reserve(iri->size() + name.text.size());
  out->append(*iri);
  out->append(name.text.data(), name.text.size());
  return CountExpanded(name.span, out->size());
}

bool Grammar::Undeclared(const Token& name) {
  std::vector<std::string> names;
  for (const auto& [prefix, iri] : options_.prefixes) names.push_back(prefix);
  std::set<std::string_view> declared;
  if (options_.known != nullptr) {
    for (const auto& [prefix, iri] : options_.known->prefixes()) declared.insert(prefix);
  }
  for (const auto& [prefix, iri] : prefixes_) declared.insert(prefix);
  constexpr size_t kMostCompared = 1000;
  for (const std::string_view prefix : declared) {
    if (names.size() < kMostCompared) names.emplace_back(prefix);
  }
  std::string hint;
  if (const std::string near = Nearest(name.prefix, names); !near.empty()) {
    hint = "did you mean " + near + ":?";
  } else {
    hint = Concat("declare it: PREFIX ", name.prefix, ": <…>");
    for (const auto& [prefix, iri] : kWellKnownPrefixes) {
      if (prefix == name.prefix) hint = Concat("declare it: PREFIX ", prefix, ": <", iri, ">");
    }
  }
  Error(name.span, Concat("the prefix '", name.prefix, ":' is not declared"), hint);
  return false;
}

bool Grammar::IriText(std::string* out) {
  const Token& token = Peek();
  if (token.kind != TokenKind::kIri && token.kind != TokenKind::kPrefixedName) {
    Expected("an IRI");
    return false;
  }
  Drop();  // its text stays valid until another token is peeked at
  return token.kind == TokenKind::kIri ? Resolve(token, out) : Expand(token, out);
}

std::optional<Term> Grammar::Iri() {
  Term term;
  if (!IriText(&term.lexical)) return std::nullopt;
  return term;
}

std::optional<std::string> Grammar::String() {
  if (Peek().kind != TokenKind::kString) {
    Expected("a string");
    return std::nullopt;
  }
  return std::string(Take().text);
}

std::optional<Term> Grammar::LiteralTail(const Token& string) {
  if (Peek().kind == TokenKind::kLanguage)
    return Term::LangString(std::string(string.text), std::string(Take().text));
  if (!Accept("^^")) return Term::Literal(std::string(string.text));
  std::optional<Term> datatype = Iri();
  if (!datatype) return std::nullopt;
  return Term::Literal(std::string(string.text), datatype->lexical);
}

std::optional<Term> Grammar::NumericLiteral() {
  std::string_view sign;
  if (At("+") || At("-")) {
    const Token token = Take();
    if (Peek().span.offset != token.span.offset + 1) {
      Expected("a number right after the sign");
      return std::nullopt;
    }
    sign = token.text;
  }
  std::string_view datatype;
  switch (Peek().kind) {
    case TokenKind::kInteger:
      datatype = kXsdInteger;
      break;
    case TokenKind::kDecimal:
      datatype = kXsdDecimal;
      break;
    case TokenKind::kDouble:
      datatype = kXsdDouble;
      break;
    default:
      Expected("a number");
      return std::nullopt;
  }
  Charge(datatype.size() + kBytesOfAllocation);
  return Term::Literal(Concat(sign, Take().text), std::string(datatype));
}

std::optional<Term> Grammar::GroundTerm() {
  const Token& token = Peek();
  switch (token.kind) {
    case TokenKind::kIri:
    case TokenKind::kPrefixedName:
      return Iri();
    case TokenKind::kString: {
      const Token string = Take();
      return LiteralTail(string);
    }
    case TokenKind::kInteger:
    case TokenKind::kDecimal:
    case TokenKind::kDouble:
      return NumericLiteral();
    case TokenKind::kWord:
      if (AcceptWord("true")) return Term::Boolean(true);
      if (AcceptWord("false")) return Term::Boolean(false);
      break;
    default:
      if (token.Is("+") || token.Is("-")) return NumericLiteral();
      break;
  }
  Expected("an IRI or a literal");
  return std::nullopt;
}

}  // namespace docent::sparql
