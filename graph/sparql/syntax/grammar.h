// Recursive-descent parser behind parser.h: one method for each production of SPARQL 1.1 section 19.8, with
// its number beside it. Split over grammar_query.cc (prologue, forms, modifiers), grammar_pattern.cc
// (groups), grammar_triples.cc (triples, paths), grammar_expression.cc and grammar_update.cc. Private to this
// folder; one thread.
//
// A production that fails has reported the error, returns null, false or nullopt, and leaves the position
// near the error.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_GRAMMAR_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_GRAMMAR_H_

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/container/inlined_vector.h"
#include "graph/base/cancellation.h"
#include "graph/base/memory_budget.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/sparql/syntax/algebra_memory.h"
#include "graph/sparql/syntax/lexer.h"
#include "graph/sparql/syntax/name_numbers.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/sparql/syntax/update_algebra.h"

namespace docent::sparql {

class Grammar {
 public:
  // Both arguments must outlive it.
  Grammar(std::string_view text, const ParseOptions& options);
  Grammar(const Grammar&) = delete;
  Grammar& operator=(const Grammar&) = delete;

  // grammar_query.cc
  bool QueryUnit(Query* query);  // [1]
  bool Prologue();               // [4]

  // grammar_update.cc
  std::optional<Update> UpdateUnit();  // [3]

  // grammar_pattern.cc
  AlgebraPtr GroupGraphPattern();                                // [53], any filter wrapped around
  std::optional<std::vector<TriplePattern>> TemplateInBraces();  // [73] ConstructTemplate

  // grammar_expression.cc
  ExpressionPtr ParseExpression();  // [110]

  // terms
  std::optional<Term> Iri();         // [136]
  std::optional<Term> GroundTerm();  // [109] without blank nodes and variables
  std::optional<std::string> String();

  // tokens
  const Token& Peek(size_t ahead = 0) {  // ahead: 0 or 1
    if (ahead == 0) return now_ != nullptr ? *now_ : *(now_ = Read(&ahead_[0]));
    if (next_ != nullptr) return *next_;
    next_ = Read(&Peek() == &ahead_[0] ? &ahead_[1] : &ahead_[0]);
    return *next_;
  }
  Token Take() {
    const Token token = Peek();
    Drop();
    return token;
  }
  bool At(std::string_view punctuation) { return Peek().Is(punctuation); }
  bool AtWord(const Keyword& keyword, size_t ahead = 0) { return Peek(ahead).IsWord(keyword); }
  bool Accept(std::string_view punctuation) {
    const bool there = At(punctuation);
    if (there) Drop();
    return there;
  }
  bool AcceptWord(const Keyword& keyword) {
    const bool there = AtWord(keyword);
    if (there) Drop();
    return there;
  }
  // Reports "expected … here" if the next token is another.
  bool Expect(std::string_view punctuation, std::string_view where);
  bool ExpectWord(const Keyword& keyword, std::string_view where);

  void Error(const SourceSpan& span, std::string message, std::string hint = "");
  // Reports "expected WHAT, not TOKEN" at the next token.
  void Expected(std::string_view what, std::string hint = "");
  void SkipPastBrace();

  const std::vector<std::pair<std::string, std::string>>& prefixes() const { return prefixes_; }
  const Diagnostics& diagnostics() const { return diagnostics_; }
  Diagnostics TakeDiagnostics() { return std::move(diagnostics_); }
  // Why the text was not read to its end; see ParsedQuery::stopped.
  const absl::Status& stopped() const { return stopped_; }
  bool failed() const { return !diagnostics_.empty(); }

 private:
  // Counts one more level of nesting during its lifetime; !ok() once the limit is passed (reported).
  class Nested {
   public:
    explicit Nested(Grammar* grammar);
    ~Nested() { --grammar_->depth_; }
    bool ok() const { return ok_; }

   private:
    Grammar* grammar_;
    bool ok_;
  };
  // grammar_budget.cc: what a text may have and keep. Each is false once the limit is passed (reported); then the text ends
  // for the productions, so that these need not look at the result.
  bool CountElement(const SourceSpan& span);
  bool CountTriple(bool template_mode);
  // An IRI that is longer than its written form, under a prefix or a base.
  bool CountExpanded(const SourceSpan& span, size_t bytes);
  // The limits of QueryLimits, for a query or an operation.
  bool CountPattern() {
    return ++patterns_ <= options_.query_limits.query_patterns ? !ended_ : PastPatterns();
  }
  bool CountPathStep();
  bool CountListElement() {
    return ++list_elements_ <= options_.query_limits.query_list_elements ? !ended_ : PastListElements();
  }
  bool CountValue() { return ++values_ <= options_.query_limits.query_values ? !ended_ : PastValues(); }
  bool CountOperation();
  bool PastPatterns();
  bool PastListElements();
  bool PastValues();
  bool PastCount(std::string_view what, std::string_view name, size_t limit, std::string hint);
  bool PastLimit(const SourceSpan& span, std::string message, std::string hint);
  void BeginCounts();  // of another query or operation
  SourceSpan LastSpan() const;
  // Counts memory that the result keeps.
  bool Charge(size_t bytes) { return (uncounted_ += bytes) < kBytesAChunk || Look(); }
  bool ChargeCopy(const PatternTerm& term) { return Charge(TextMemory(term)); }
  // Takes over the bytes so far, and looks at deadline and cancellation.
  bool Look();
  bool Stop(absl::Status status);
  ExpressionPtr NewExpression(Expression::Kind kind, const SourceSpan& span) {
    Charge(sizeof(Expression) + kBytesOfChild);
    return std::make_unique<Expression>(kind, span);
  }
  AlgebraPtr NewAlgebra(Algebra::Kind kind, const SourceSpan& span = {}) {
    Charge(sizeof(Algebra) + kBytesOfChild);
    return std::make_unique<Algebra>(kind, span);
  }
  // A node over one child, or over a child for a value of an expression.
  AlgebraPtr Wrap(Algebra::Kind kind, AlgebraPtr child);
  AlgebraPtr Extend(AlgebraPtr child, Variable variable, ExpressionPtr expression);

  enum class QuadsUse { kInsertData, kDeleteData, kInsertTemplate, kDeleteTemplate, kDeleteWhere };

  // grammar_query.cc
  struct SelectItem {
    Variable variable;
    ExpressionPtr expression;  // null: a plain variable
    SourceSpan span;
  };
  struct SelectClause {
    bool distinct = false, reduced = false, all = false;
    absl::InlinedVector<SelectItem, 2> items;
    SourceSpan span;
  };
  struct Modifiers {
    bool grouped = false;
    std::vector<GroupKey> group_keys;
    std::vector<std::pair<Variable, ExpressionPtr>> key_binds;  // GROUP BY (e AS ?v), kept for order
    std::vector<ExpressionPtr> having;
    std::vector<OrderCondition> order;
    std::vector<SourceSpan> order_spans;
    uint64_t offset = 0;
    std::optional<uint64_t> limit;
    AlgebraPtr values;
  };
  bool BaseDeclaration();                     // [5]
  bool PrefixDeclaration();                   // [6]
  bool SelectQuery(Query* query);             // [7]
  bool ConstructQuery(Query* query);          // [10]
  bool DescribeQuery(Query* query);           // [11]
  bool AskQuery(Query* query);                // [12]
  bool ParseSelectClause(SelectClause* out);  // [9]
  bool DatasetClauses(Query* query);          // [13]
  AlgebraPtr WhereClause();                   // [17]
  bool SolutionModifier(Modifiers* out);      // [18]
  bool GroupClause(Modifiers* out);           // [19]
  bool HavingClause(Modifiers* out);          // [21]
  bool OrderClause(Modifiers* out);           // [23]
  bool LimitOffsetClauses(Modifiers* out);    // [25]
  bool ValuesClause(Modifiers* out);          // [28]
  AlgebraPtr ApplyModifiers(AlgebraPtr where, SelectClause* select, Modifiers* modifiers,
                            std::vector<Aggregate> aggregates, std::vector<Variable>* projection);
  AlgebraPtr ApplyGroup(AlgebraPtr where, SelectClause* select, Modifiers* modifiers,
                        std::vector<Aggregate> aggregates);
  void SampleUngrouped(const std::set<std::string>& allowed, Algebra* group, Expression* expression);
  void CheckGrouped(const Expression& expression, const std::set<std::string>& allowed);
  void CheckAliases(const Expression& expression, const std::set<std::string>& given);
  AlgebraPtr SubSelect();  // [8]

  // grammar_pattern.cc
  struct Group {
    AlgebraPtr pattern;
    ExpressionPtr filter;  // conjunction of the group's own FILTERs; null: none
  };
  struct OpenGroup {
    AlgebraPtr pattern;      // null: nothing yet
    Algebra* bgp = nullptr;  // the BGP that further triples go to; null: the next triples begin one
    std::vector<ExpressionPtr> filters;
  };
  bool GroupWithFilter(Group* group);
  void Unclosed(const SourceSpan& opened);  // the error at a group without '}'
  bool GroupElement(OpenGroup* group);
  bool TriplesBlock(OpenGroup* group);     // [55]
  bool OptionalElement(OpenGroup* group);  // [57]
  bool MinusElement(OpenGroup* group);     // [66]
  bool GraphElement(OpenGroup* group);     // [58]
  bool ServiceElement(OpenGroup* group);   // [59]
  bool BindElement(OpenGroup* group);      // [60]
  bool NotElement(OpenGroup* group);
  bool SetElement(OpenGroup* group);
  bool Assign(OpenGroup* group, const SourceSpan& span, const Token& variable, ExpressionPtr expression);
  bool FilterElement(OpenGroup* group);  // [68]
  bool GroupOrUnion(OpenGroup* group);   // [67]
  AlgebraPtr DataBlock();                // [62]
  void AddToGroup(OpenGroup* group, AlgebraPtr element);
  void CloseBgp(OpenGroup* group);
  void RecoverInGroup();

  // Destination of parsed triples.
  struct TriplesSink {
    std::vector<TriplePattern> triples;
    std::vector<AlgebraPtr> paths;
    bool template_mode = false;  // blank nodes stay terms, no paths
    // Of an update: where triples go from time to time, and the graph around them.
    QuadTemplates* quads = nullptr;
    std::shared_ptr<const PatternTerm> graph;
    QuadsUse use = QuadsUse::kInsertData;
    bool ok = true;  // all those were allowed there
  };
  // Gives *from to *to: a copy if it must be kept, else a move.
  void Give(PatternTerm* from, bool keep, PatternTerm* to);
  bool TriplesSameSubject(TriplesSink* sink);  // [75] [81]
  bool AtPlainVerb();
  // The last triple takes *subject by move; likewise *verb below.
  bool PropertyListNotEmpty(PatternTerm* subject, TriplesSink* sink);  // [77] [83]
  bool Property(PatternTerm* subject, TriplesSink* sink);              // a verb and its objects
  bool Verb(PatternTerm* out);                                         // [78]
  // `path` null: the predicate is *verb.
  bool ObjectList(PatternTerm* subject, const Path* path, PatternTerm* verb, TriplesSink* sink);
  // These fill *out, an empty term; false: an error was reported.
  bool GraphNode(TriplesSink* sink, PatternTerm* out);              // [104] [105]
  bool Collection(TriplesSink* sink, PatternTerm* out);             // [102]
  bool BlankNodePropertyList(TriplesSink* sink, PatternTerm* out);  // [99]
  bool VarOrTerm(TriplesSink* sink, PatternTerm* out);              // [106]
  bool OtherTerm(TriplesSink* sink, PatternTerm* out);
  bool LabelledBlank(const Token& token, bool template_mode, PatternTerm* out);
  std::optional<PatternTerm> VarOrIri();  // [107]
  PatternTerm NewBlank(const SourceSpan& span, bool template_mode);
  std::optional<Path> ParsePath();         // [88] [89]
  std::optional<Path> PathSequence();      // [90]
  std::optional<Path> PathEltOrInverse();  // [92]
  std::optional<Path> PathPrimary();       // [94]
  std::optional<Path> PathNegatedSet();    // [95]
  // Section 18.2.2.4: parts that are not recursive become triples, UNIONs and hidden variables.
  void TranslatePath(const PatternTerm& subject, const Path& path, const PatternTerm& object,
                     TriplesSink* sink);
  AlgebraPtr SinkToAlgebra(TriplesSink sink);

  // grammar_expression.cc
  ExpressionPtr AndExpression();                                       // [112]
  ExpressionPtr RelationalExpression();                                // [114]
  ExpressionPtr AdditiveExpression();                                  // [116]
  ExpressionPtr MultiplicativeExpression();                            // [117]
  ExpressionPtr UnaryExpression();                                     // [118]
  ExpressionPtr PrimaryExpression();                                   // [119]
  ExpressionPtr BracketedExpression();                                 // [120]
  ExpressionPtr BuiltinCall();                                         // [121]
  ExpressionPtr ExistsCall(bool negated);                              // [125] [126]
  ExpressionPtr AggregateCall(Aggregate::Function function);           // [127]
  ExpressionPtr IriOrFunction();                                       // [128]
  ExpressionPtr Constraint();                                          // [69]
  bool ArgumentList(std::vector<ExpressionPtr>* out, bool* distinct);  // [71]
  ExpressionPtr Binary(Expression::Kind kind, ExpressionPtr left, ExpressionPtr right);
  friend class ProductionParser;

  // The next token that is not of kind kError; errors are reported.
  const Token* Read(Token* place);
  void ReportError(const Token& token);  // of the kind kError
  // Takes the peeked token. Its slot is reused for the next token.
  void Drop() {
    now_ = next_;
    next_ = nullptr;
  }
  // grammar_update.cc
  bool Update1(UpdateOperation* operation);      // [30]
  bool Load(UpdateOperation* operation);         // [31]
  bool DeleteWhere(UpdateOperation* operation);  // [40]
  bool Modify(UpdateOperation* operation);       // [41]
  bool GraphOrDefault(GraphTarget* target);      // [45]
  bool GraphRef(GraphTarget* target);            // [46]
  bool GraphRefAll(GraphTarget* target);         // [47]
  bool Quads(QuadTemplates* out, QuadsUse use);  // [48] [49], in braces
  bool Triples(std::shared_ptr<const PatternTerm> graph, QuadTemplates* out, QuadsUse use);  // [52]
  void TakeQuads(TriplesSink* sink);
  bool QuadTerm(const PatternTerm& term, QuadsUse use);
  // Skips to the ';' that ends the operation, or to the end.
  void RecoverAtSemicolon();

  std::optional<Term> LiteralTail(const Token& string);
  std::optional<Term> NumericLiteral();
  bool IriText(std::string* out);  // [136], absolute
  bool Resolve(const Token& iri, std::string* out);
  bool ResolveRelative(const Token& iri, std::string* out);
  bool Expand(const Token& name, std::string* out);
  bool Undeclared(const Token& name);  // the error; false
  std::string Describe(const Token& token) const;

  const ParseOptions& options_;
  const std::string_view text_;
  Lexer lexer_;
  std::array<Token, 2> ahead_;   // tokens read but not taken
  const Token* now_ = nullptr;   // the first of them; null: not read yet
  const Token* next_ = nullptr;  // the second
  std::string base_iri_;
  std::vector<std::pair<std::string, std::string>> prefixes_;  // declared in the text
  NameNumbers declared_;                                       // name → its last number in prefixes_
  Diagnostics diagnostics_;
  int depth_ = 0;
  static constexpr size_t kBytesOfTriple = 16, kFewTriples = 1000;
  static constexpr size_t kGrowth = 16;
  size_t elements_ = 0, triples_ = 0, expanded_bytes_ = 0;
  size_t patterns_ = 0, path_steps_ = 0, list_elements_ = 0, values_ = 0, operations_ = 0;
  static constexpr size_t kBytesAChunk = 16u << 10, kTokensALook = 1024;
  static constexpr size_t kBytesOfChild = 48;  // of a node in its parent, and of its allocation
  MemoryUse own_;                              // where the caller counts none
  MemoryUse* const memory_;
  size_t uncounted_ = 0;      // bytes, of the chunk
  size_t kept_by_lexer_ = 0;  // bytes that are counted
  size_t tokens_ = 0;
  absl::Status stopped_;
  bool ended_ = false;                            // no more is read
  int counter_ = 0;                               // hidden variables
  int bgp_ = 0;                                   // number of the current basic graph pattern
  std::map<std::string, int> blank_bgp_;          // blank node label → BGP that used it
  std::vector<Aggregate>* aggregates_ = nullptr;  // destination of aggregates; null: none allowed here
  bool in_aggregate_ = false;
  bool in_service_ = false;                 // functions inside belong to the other endpoint
  int operation_ = 0;                       // number of the current update operation
  std::map<std::string, int> data_labels_;  // blank node label → INSERT DATA that used it
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_GRAMMAR_H_
