// A pattern as alternatives of plain conjunctions: what explanations reason about.
//
//   { ?v a :Visitor ; :isAt ?r . FILTER NOT EXISTS { ?v :served true } } UNION { … }
//     → clause 1: facts  ?v a :Visitor, ?v :isAt ?r    absent  { ?v :served true }
//       clause 2: …
//
// UNION and alternative paths are carried to the outside, EXISTS and sub-SELECTs become facts with variables of
// their own, an OPTIONAL that nothing else looks at is left out: the clauses have a solution exactly when the
// pattern has one. What cannot be taken apart (recursive paths, aggregates, LIMIT) stays whole as a *part* that
// only the evaluator understands. Values; any thread.
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
  TermId constant;  // none with kConstant: any graph
  int variable = kConstant;
};

// ?v :isAt ?r, in subject, predicate, object, graph order.
struct Atom {
  std::array<AtomTerm, 4> terms;
};

// Every variable that is mentioned anywhere in `node` but below `except` (null: nothing).
void MentionedBeside(const sparql::Algebra& node, const sparql::Algebra* except,
                     std::set<std::string>& names);

struct Clause;

// NOT EXISTS { … } or MINUS { … }: none of the alternatives may have a solution. Their variables of the same name as
// the clause's are the clause's.
struct Absence {
  std::vector<Clause> alternatives;
  std::shared_ptr<const sparql::Algebra> source;  // for people
};

// FILTER, without EXISTS at its top.
struct Test {
  std::shared_ptr<const sparql::Expression> expression;
  std::vector<int> variables;  // of the clause
};

// BIND(expression AS ?variable)
struct Assignment {
  std::shared_ptr<const sparql::Expression> expression;
  std::vector<int> variables;  // that the expression mentions
  int variable = 0;
};

// VALUES
struct Table {
  std::vector<int> variables;
  std::vector<std::vector<TermId>> rows;  // none: UNDEF
};

// What stays whole.
struct Part {
  std::shared_ptr<const sparql::Algebra> pattern;
  std::vector<int> variables;  // in scope of it
  AtomTerm graph;              // that it is looked for in
  bool beside_gap =
      false;  // PathForm::kWithGap: what it lacks is an atom beside it, or of another alternative
};

// A name that no query has.
inline constexpr std::string_view kGraphOfPart = "_graph_of_part";
// The pattern with its graph around it, which is called `graph_name` where it is a variable.
sparql::AlgebraPtr InItsGraph(const Part& part, const Dictionary& dictionary, const std::string& graph_name);

// A variable "v~2", of a copy of a pattern, is called "v" as that of the first.
inline constexpr char kCopyMark = '~';

struct Clause {
  std::vector<std::string> names;    // of its variables
  std::vector<std::string> written;  // as the query has them; empty: made here, or a blank node
  std::vector<Atom> atoms;
  std::vector<Absence> absences;
  std::vector<Test> tests;
  std::vector<Assignment> assignments;
  std::vector<Table> tables;
  std::vector<Part> parts;

  // -1: none of that name.
  int Find(const std::string& name) const;
};

// What a recursive path outside absences becomes.
enum class PathForm : uint8_t {
  kWhole,  // ?x :in+ ?y   a part
  kWithGap,  // ?x :in ?y, or else  ?x :in* ?u . ?u :in ?v . ?v :in* ?y, so that one step of it may be taken as missing
};

// The alternatives of `where`, constants interned in `dictionary` (the caller's own, over the server's).
// `default_graph`: where patterns outside GRAPH are looked for; none: all graphs. RESOURCE_EXHAUSTED for more than
// kMaxClauses alternatives.
inline constexpr size_t kMaxClauses = 64;
absl::StatusOr<std::vector<Clause>> ToClauses(const sparql::Algebra& where, Dictionary& dictionary,
                                              TermId default_graph = TermId(),
                                              PathForm paths = PathForm::kWhole);

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_CONDITION_FORM_H_
