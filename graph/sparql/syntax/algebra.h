// A SPARQL query as its algebra (SPARQL 1.1 Query Language, section 18). The parser makes it, the planner
// reads it, and the reasoner takes rule bodies and standing conditions from it. It is independent of the
// store: terms are text, variables are names.
//
// One tagged struct for each level (`Algebra`, `Expression`, `Path`) instead of a class hierarchy: every
// consumer is a switch over `kind`, and the comments below name the fields of each kind. Trees are owned by
// unique_ptr and never shared; `Clone` copies. Values; any thread reads, one thread changes.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/rdf/term.h"

namespace docent::sparql {

// ?name. The name has no "?". Names that begin with '.' are made by the parser: ".bLABEL" for the blank node
// _:LABEL of a pattern (section 4.1.4: it acts as a variable), ".aN" for an aggregate, ".pN" inside a path.
// They are never part of SELECT *.
struct Variable {
  std::string name;
  bool IsHidden() const { return !name.empty() && name[0] == '.'; }
  friend bool operator==(const Variable&, const Variable&) = default;
  friend auto operator<=>(const Variable& a, const Variable& b) { return a.name <=> b.name; }
};

// One position of a pattern: a variable or a term, with its place in the text. At first neither.
class PatternTerm {
 public:
  SourceSpan span;

  static PatternTerm Of(Term term, SourceSpan span = {}) { return PatternTerm(std::move(term), span); }
  static PatternTerm Of(Variable variable, SourceSpan span = {}) {
    return PatternTerm(std::move(variable), span);
  }
  PatternTerm() = default;
  PatternTerm(const PatternTerm&) = default;
  PatternTerm& operator=(const PatternTerm&) = default;
  PatternTerm(PatternTerm&& other) noexcept : span(other.span) { Move(&other); }
  PatternTerm& operator=(PatternTerm&& other) noexcept {
    span = other.span;
    if (this != &other) Move(&other);
    return *this;
  }

  bool IsVariable() const { return std::holds_alternative<Variable>(what_); }
  // Requires IsVariable().
  const Variable& variable() const { return *std::get_if<Variable>(&what_); }
  // The term; an IRI without text if it is not a term.
  const Term& term() const {
    const Term* term = std::get_if<Term>(&what_);
    return term != nullptr ? *term : NoTerm();
  }
  void Set(Variable variable) { what_.emplace<Variable>(std::move(variable)); }
  void SetVariable(std::string_view name) { what_.emplace<Variable>(std::string(name)); }
  void Set(Term term) { what_.emplace<Term>(std::move(term)); }
  // Makes it an IRI, whose text the caller writes into the result.
  std::string* SetIri() { return &what_.emplace<Term>().lexical; }

  // Spans are not compared.
  friend bool operator==(const PatternTerm& a, const PatternTerm& b) {
    return a.IsVariable() ? b.IsVariable() && a.variable() == b.variable()
                          : !b.IsVariable() && a.term() == b.term();
  }

 private:
  template <typename What>
  PatternTerm(What what, const SourceSpan& span) : span(span), what_(std::move(what)) {}
  static const Term& NoTerm();
  // Parsing moves each term once or twice: a branch for each kind is cheaper than the variant's own visitor.
  void Move(PatternTerm* from) {
    if (Variable* variable = std::get_if<Variable>(&from->what_)) {
      what_.emplace<Variable>(std::move(*variable));
    } else if (Term* term = std::get_if<Term>(&from->what_)) {
      what_.emplace<Term>(std::move(*term));
    } else {
      what_.emplace<std::monostate>();
    }
  }

  std::variant<std::monostate, Variable, Term> what_;
};

// ?robot docent:isAt ?booth
struct TriplePattern {
  PatternTerm subject;
  PatternTerm predicate;
  PatternTerm object;
  friend bool operator==(const TriplePattern&, const TriplePattern&) = default;
};

// A property path (section 9.1) that is not just one IRI.
struct Path {
  enum class Kind : uint8_t {
    kIri,          // iri
    kInverse,      // ^path                 children[0]
    kSequence,     // path / path / …       children, two or more
    kAlternative,  // path | path | …       children, two or more
    kZeroOrMore,   // path*                 children[0]
    kOneOrMore,    // path+                 children[0]
    kZeroOrOne,    // path?                 children[0]
    kNegatedSet,   // !(iri | ^iri | …)     children, each kIri or kInverse of kIri; may be empty
  };
  Kind kind = Kind::kIri;
  Term iri;
  std::vector<Path> children;
  friend bool operator==(const Path&, const Path&) = default;
};

struct Algebra;
struct Expression;
using AlgebraPtr = std::unique_ptr<Algebra>;
using ExpressionPtr = std::unique_ptr<Expression>;

// The functions that SPARQL 1.1 section 17.4 names by keyword. In the order of the table in builtins.cc.
enum class Builtin : uint8_t {
  kStr,
  kLang,
  kLangMatches,
  kDatatype,
  kBound,
  kIri,
  kBnode,
  kRand,
  kAbs,
  kCeil,
  kFloor,
  kRound,
  kConcat,
  kStrlen,
  kUcase,
  kLcase,
  kEncodeForUri,
  kContains,
  kStrStarts,
  kStrEnds,
  kStrBefore,
  kStrAfter,
  kYear,
  kMonth,
  kDay,
  kHours,
  kMinutes,
  kSeconds,
  kTimezone,
  kTz,
  kNow,
  kUuid,
  kStrUuid,
  kMd5,
  kSha1,
  kSha256,
  kSha384,
  kSha512,
  kCoalesce,
  kIf,
  kStrLang,
  kStrDt,
  kSameTerm,
  kIsIri,
  kIsBlank,
  kIsLiteral,
  kIsNumeric,
  kRegex,
  kSubstr,
  kReplace,
};

// An expression of FILTER, BIND, SELECT, HAVING, ORDER BY.
struct Expression {
  enum class Kind : uint8_t {
    kVariable,        // ?x                       variable
    kTerm,            // "a", 5, <iri>            term
    kOr,              // a || b || …              arguments, two or more
    kAnd,             // a && b && …              arguments, two or more
    kNot,             // ! a                      arguments[0]
    kEqual,           // a = b                    arguments[0], [1]; and so on
    kNotEqual,        // a != b
    kLess,            // a < b
    kGreater,         // a > b
    kLessOrEqual,     // a <= b
    kGreaterOrEqual,  // a >= b
    kIn,              // a IN (b, c)              arguments[0] is a
    kNotIn,           // a NOT IN (b, c)
    kAdd,             // a + b
    kSubtract,        // a - b
    kMultiply,        // a * b
    kDivide,          // a / b
    kUnaryPlus,       // + a
    kUnaryMinus,      // - a
    kBuiltin,         // STRLEN(a)                builtin, arguments
    kFunction,        // <iri>(a, b), xsd:int(a)  term (the IRI), arguments
    kExists,          // EXISTS { … }             pattern
    kNotExists,       // NOT EXISTS { … }         pattern
  };
  Kind kind = Kind::kTerm;
  SourceSpan span;
  Variable variable;
  Term term;
  Builtin builtin = Builtin::kStr;
  std::vector<ExpressionPtr> arguments;
  AlgebraPtr pattern;

  Expression();
  Expression(Kind kind, SourceSpan span);
  ~Expression();
  ExpressionPtr Clone() const;
};

// COUNT(DISTINCT ?x), GROUP_CONCAT(?n ; SEPARATOR = ", ")
struct Aggregate {
  enum class Function : uint8_t { kCount, kSum, kMin, kMax, kAvg, kSample, kGroupConcat };
  Function function = Function::kCount;
  bool distinct = false;
  ExpressionPtr expression;  // null: COUNT(*)
  std::string separator = " ";
  Variable result;  // ".aN": used by the expressions above the group
  SourceSpan span;
};

// A key of GROUP BY: (expression AS variable). For a plain variable the two name the same.
struct GroupKey {
  Variable variable;
  ExpressionPtr expression;
};

struct OrderCondition {
  ExpressionPtr expression;
  bool descending = false;
};

// An operator of the algebra (section 18.2.4 and 18.5).
struct Algebra {
  enum class Kind : uint8_t {
    kBgp,       // { t1 . t2 }                    triples; empty: the one empty solution
    kPath,      // subject path object            subject, path, object
    kJoin,      // A . B . C                      children, two or more
    kLeftJoin,  // A OPTIONAL { B FILTER e }      children A, B; expression (may be null)
    kFilter,    // FILTER e                       children[0]; expression
    kUnion,     // { A } UNION { B } UNION …      children, two or more
    kMinus,     // A MINUS { B }                  children A, B
    kGraph,     // GRAPH name { A }               name; children[0]
    kExtend,    // BIND(e AS ?v)                  children[0]; variable; expression
    kValues,    // VALUES (?x ?y) { (…) (…) }     variables; rows (nullopt: UNDEF)
    kService,   // SERVICE name { A }             name; silent; children[0]
    kGroup,     // GROUP BY keys, aggregates      children[0]; group_keys; aggregates
    kOrderBy,   // ORDER BY                       children[0]; order
    kProject,   // SELECT ?x ?y                   children[0]; variables. Inside a tree: a sub-SELECT, other
                //                                variables of the child are not visible outside
    kDistinct,  // DISTINCT                       children[0]
    kReduced,   // REDUCED                        children[0]
    kSlice,     // OFFSET LIMIT                   children[0]; offset; limit
  };
  Kind kind = Kind::kBgp;
  SourceSpan span;
  std::vector<AlgebraPtr> children;
  std::vector<TriplePattern> triples;
  PatternTerm subject, object;
  Path path;
  PatternTerm name;
  bool silent = false;
  ExpressionPtr expression;
  Variable variable;
  std::vector<Variable> variables;
  std::vector<std::vector<std::optional<Term>>> rows;
  std::vector<GroupKey> group_keys;
  std::vector<Aggregate> aggregates;
  std::vector<OrderCondition> order;
  uint64_t offset = 0;
  std::optional<uint64_t> limit;

  Algebra();
  explicit Algebra(Kind kind, SourceSpan span = {});
  ~Algebra();
  AlgebraPtr Clone() const;
};

// A whole query.
struct Query {
  enum class Form : uint8_t { kSelect, kAsk, kConstruct, kDescribe };
  Form form = Form::kSelect;
  std::string base_iri;
  std::vector<std::pair<std::string, std::string>>
      prefixes;                  // declared in the text, in order: name without ':', IRI
  std::vector<Term> from;        // FROM <iri>
  std::vector<Term> from_named;  // FROM NAMED <iri>
  // The graph that replaces the default graph if there is no FROM: WITH <iri> of an update.
  std::optional<Term> with;
  // WHERE with the solution modifiers around it. kSelect: a kProject is inside.
  AlgebraPtr algebra;
  std::vector<Variable> projection;  // kSelect: the result's variables in order (those of SELECT * too)
  std::vector<TriplePattern>
      construct_template;             // kConstruct; blank nodes stay terms here: new ones for each solution
  std::vector<PatternTerm> describe;  // kDescribe: IRIs and variables (those of DESCRIBE * too)

  Query() = default;
  Query(Query&&) = default;
  Query& operator=(Query&&) = default;
  Query Clone() const;
};

// The variables that a solution of `algebra` can bind (section 18.2.1 "in scope"), in order of first
// occurrence, hidden ones included.
std::vector<Variable> InScopeVariables(const Algebra& algebra);
bool IsInScope(const Algebra& algebra, std::string_view variable);
// Every variable that `expression` mentions, those inside EXISTS included.
std::vector<Variable> MentionedVariables(const Expression& expression);
// Both without copies: the pointers point into the tree.
std::vector<const Variable*> VariablesInScope(const Algebra& algebra);
std::vector<const Variable*> VariablesMentioned(const Expression& expression);
// Every triple pattern in `algebra`, at any depth (OPTIONAL, EXISTS, sub-SELECT, …), and whether
// an added triple may also remove solutions (below MINUS, NOT EXISTS, OPTIONAL, FILTER EXISTS,
// …).
struct PatternOccurrence {
  const TriplePattern* pattern;
  bool monotone;  // true: more triples can only add solutions
};
std::vector<PatternOccurrence> AllTriplePatterns(const Algebra& algebra);
// True if each solution of `inside`, evaluated in one graph, needs a triple of that graph. If false ({ },
// BIND, VALUES, an aggregate, OPTIONAL alone, a path of length zero, another GRAPH), GRAPH has solutions only
// if the dataset is known to have the graph.
bool NeedsTripleOfGraph(const Algebra& inside);
// True if `algebra` holds a property path anywhere.
bool HasPath(const Algebra& algebra);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_H_
