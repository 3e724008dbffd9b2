// A pattern as alternatives of plain conjunctions (clauses), the form on which explanations work.
//
//   { ?v a :Visitor ; :isAt ?r . FILTER NOT EXISTS { ?v :served true } } UNION { … }
//     → clause 1: facts  ?v a :Visitor, ?v :isAt ?r    absent  { ?v :served true }
//       clause 2: …
//
// UNION and alternative paths move to the top, EXISTS and sub-SELECTs become facts with variables of their
// own, and an OPTIONAL whose variables are not used is dropped. The clauses have a solution exactly if the
// pattern has one. Constructs that cannot be decomposed (recursive paths, aggregates, LIMIT) stay whole as a
// *part*, which only the evaluator understands. Values; any thread.
#ifndef DOCENT_REASONER_EXPLAIN_CONDITION_FORM_H_
#define DOCENT_REASONER_EXPLAIN_CONDITION_FORM_H_

#include <array>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/syntax/algebra.h"

namespace docent::explain {

// A constant, or a variable of the clause.
struct AtomTerm {
  static constexpr int kConstant = -1;
  TermId constant;  // kNone with kConstant: any graph
  int variable = kConstant;
};

// ?v :isAt ?r, in subject, predicate, object, graph order.
struct Atom {
  std::array<AtomTerm, 4> terms;
};

// Every variable mentioned in `node`, except below `except` (null: none).
void MentionedBeside(const sparql::Algebra& node, const sparql::Algebra* except,
                     std::set<std::string>& names);

struct Clause;

// NOT EXISTS { … } or MINUS { … }: no alternative may have a solution. Variables with the name of a variable
// of the clause are that variable.
struct Absence {
  std::vector<Clause> alternatives;
  std::shared_ptr<const sparql::Algebra> source;  // for people
};

// FILTER without EXISTS at its top.
struct Test {
  std::shared_ptr<const sparql::Expression> expression;
  std::vector<int> variables;  // of the clause
};

// BIND(expression AS ?variable)
struct Assignment {
  std::shared_ptr<const sparql::Expression> expression;
  std::vector<int> variables;  // mentioned in the expression
  int variable = 0;
};

// VALUES
struct Table {
  std::vector<int> variables;
  std::vector<std::vector<TermId>> rows;  // kNone: UNDEF
};

// A part of the pattern that stays whole.
struct Part {
  std::shared_ptr<const sparql::Algebra> pattern;
  std::vector<int> variables;  // in its scope
  AtomTerm graph;              // the graph in which it is evaluated
  bool beside_gap =
      false;  // PathForm::kWithGap: its missing step is an atom beside it, or of another alternative
};

// A name that no query uses.
inline constexpr std::string_view kGraphOfPart = "_graph_of_part";
// The pattern inside its GRAPH; the graph is called `graph_name` if it is a variable.
sparql::AlgebraPtr InItsGraph(const Part& part, const Dictionary& dictionary, const std::string& graph_name);

// A variable "v~2", from a copy of a pattern, is shown as "v", like that of the first.
inline constexpr char kCopyMark = '~';

struct Clause {
  std::vector<std::string> names;    // of its variables
  std::vector<std::string> written;  // names in the query; empty: made here, or a blank node
  std::vector<Atom> atoms;
  std::vector<Absence> absences;
  std::vector<Test> tests;
  std::vector<Assignment> assignments;
  std::vector<Table> tables;
  std::vector<Part> parts;

  // -1: no variable of that name.
  int Find(const std::string& name) const;
};

// Translation of a recursive path outside absences.
enum class PathForm : uint8_t {
  kWhole,    // ?x :in+ ?y   a part
  kWithGap,  // ?x :in ?y, or else  ?x :in* ?u . ?u :in ?v . ?v :in* ?y, where one step may be missing
};

// The alternatives of `where`, with constants interned in `dictionary` (the caller's own, over the server's).
// `default_graph`: the graph of patterns outside GRAPH; kNone: all graphs. RESOURCE_EXHAUSTED for more than
// kMaxClauses alternatives.
inline constexpr size_t kMaxClauses = 64;
absl::StatusOr<std::vector<Clause>> ToClauses(const sparql::Algebra& where, Dictionary& dictionary,
                                              TermId default_graph = TermId(),
                                              PathForm paths = PathForm::kWhole);

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_CONDITION_FORM_H_
