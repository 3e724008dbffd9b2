// SPARQL 1.1 parser: text → algebra. It reads the whole grammar of the W3C recommendation (section 19.8),
// queries and updates.
//
// Hand-written recursive descent, one method for each production; independent of store and clock. After an
// error it continues at the next '.' or '}', so several mistakes are reported at once. Any thread.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_PARSER_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_PARSER_H_

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"
#include "graph/base/query_limits.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/sparql/syntax/update_algebra.h"

namespace docent {
class Cancellation;
class IriNames;
class MemoryUse;
}  // namespace docent

namespace docent::sparql {

class FunctionRegistry;

struct ParseOptions {
  std::string file;      // for diagnostics; may be empty
  std::string base_iri;  // BASE before the text's own; empty: a relative IRI is an error
  // Prefixes known without declaration (e.g. kWellKnownPrefixes); the text may redeclare them.
  std::vector<std::pair<std::string, std::string>> prefixes;
  // Further ones, behind those; null: none. Read during parsing.
  const IriNames* known = nullptr;
  Limits limits;  // query_text_bytes, query_nesting, query_elements
  QueryLimits query_limits;
  // Counts what the parser makes, which stays counted; null: it is bounded by limits.query_memory_bytes alone.
  MemoryUse* memory = nullptr;
  Cancellation* cancellation = nullptr;  // polled; null: none
  // Allows the group elements that the W3C SHACL 1.2 Rules draft adds: NOT { … } and SET(?x :=
  // expression).
  bool rule_elements = false;
  // Checks function calls against these and the casts; null: Prepare checks them. Read during parsing.
  const FunctionRegistry* functions = nullptr;
  // Constant regular expressions that cannot be evaluated are errors; false: calls with them have no value.
  // For texts that an earlier version accepted.
  bool check_patterns = true;
};

// kWellKnownPrefixes of the vocabulary, in the shape that ParseOptions takes.
std::vector<std::pair<std::string, std::string>> WellKnownPrefixes();

// Options for a text sent to a server: the prefixes above, the limits and the registered functions.
ParseOptions ParseOptionsWith(const Limits& limits, const FunctionRegistry* functions);

struct ParsedQuery {
  Query query;  // usable only if ok()
  Diagnostics diagnostics;
  // Why the parser stopped before the end: RESOURCE_EXHAUSTED at a limit of size, CANCELLED, DEADLINE_EXCEEDED. The
  // diagnostics say it, too.
  absl::Status stopped;
  bool ok() const { return !HasErrors(diagnostics); }
};
ParsedQuery ParseQuery(std::string_view text, const ParseOptions& options = {});

struct ParsedUpdate {
  Update update;  // usable only if ok()
  Diagnostics diagnostics;
  absl::Status stopped;  // as in ParsedQuery
  bool ok() const { return !HasErrors(diagnostics); }
};
// `limits.update_text_bytes` holds instead of query_text_bytes.
ParsedUpdate ParseUpdate(std::string_view text, const ParseOptions& options = {});

// What stopped the parser, or INVALID_ARGUMENT, each with the rendered mistakes; OK if parsed.ok(). `text`: what was parsed.
absl::Status ToStatus(const ParsedQuery& parsed, std::string_view text);
absl::Status ToStatus(const ParsedUpdate& parsed, std::string_view text);

// A single expression, as in FILTER(…) without the keyword (CAWL comparisons, tests). Null if there are
// errors.
struct ParsedExpression {
  ExpressionPtr expression;
  Diagnostics diagnostics;
  bool ok() const { return !HasErrors(diagnostics); }
};
ParsedExpression ParseExpression(std::string_view text, const ParseOptions& options = {});

// The productions of SPARQL as building blocks for languages that contain them (the rule language). Each
// method reads from the current token. Errors are collected in diagnostics(); a method that fails has
// reported the error and returns false, null or nullopt. `text` must outlive it. One thread.
//
//   ProductionParser p(text, options);
//   p.Prologue();
//   while (!p.AtEnd()) {
//     if (!p.AcceptKeyword("RULE")) { p.Error("expected RULE", "…"); p.SkipPastBrace(); continue; }
//     auto head = p.TriplesTemplateInBraces();
//     p.AcceptKeyword("WHERE");
//     auto body = p.GroupGraphPattern();
//   }
class ProductionParser {
 public:
  ProductionParser(std::string_view text, const ParseOptions& options);
  ~ProductionParser();
  ProductionParser(const ProductionParser&) = delete;
  ProductionParser& operator=(const ProductionParser&) = delete;

  // (BASE <iri> | PREFIX p: <iri>)*; may be called again later in the text.
  bool Prologue();
  // '{' triples '}'. Blank nodes stay terms; variables stay variables; no paths.
  std::optional<std::vector<TriplePattern>> TriplesTemplateInBraces();
  // '{' … '}' as in WHERE. Blank nodes become hidden variables; their labels are valid up to the end of the
  // outermost group.
  AlgebraPtr GroupGraphPattern();
  // One expression; one IRI (full or prefixed); one IRI, literal, number or boolean; one string.
  ExpressionPtr Expression();
  std::optional<Term> Iri();
  std::optional<Term> GroundTerm();
  std::optional<std::string> String();

  // If the next token is the keyword (any case) or punctuation: moves past it.
  bool AcceptKeyword(std::string_view keyword);
  bool AtKeyword(std::string_view keyword) const;
  bool AtPunctuation(std::string_view punctuation) const;
  bool AtWord() const;  // a keyword, or other letters
  bool AtEnd() const;
  // The place of the next token, for errors and AST nodes.
  SourceSpan Here() const;

  void Error(std::string message, std::string hint = "");
  void Error(const SourceSpan& at, std::string message, std::string hint);
  // Moves past the next '}' that closes what is open here (or to the end): recovery between rules.
  void SkipPastBrace();

  const std::vector<std::pair<std::string, std::string>>& prefixes() const;
  const Diagnostics& diagnostics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_PARSER_H_
