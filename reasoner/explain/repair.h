// Repairs of a condition that is false: facts to tell and facts in the way, as they are shown and as they are tried. Pure
// functions; any thread.
#ifndef DOCENT_REASONER_EXPLAIN_REPAIR_H_
#define DOCENT_REASONER_EXPLAIN_REPAIR_H_

#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/store/graph_version.h"
#include "reasoner/explain/display.h"
#include "reasoner/explain/solver.h"

namespace docent::explain {

// A fact that would have to be told.
struct ToTell {
  sparql::TriplePattern fact;  // open variables are variables
  Term graph;                  // empty IRI: any
  std::vector<Term> now;       // objects that the graph has instead, of the same subject and predicate; a few
  TermQuad example;            // with values in the place of open variables, as it was tried
  std::string
      absence;  // "{ expo:R01 a docent:Idle }", which holds by it; empty: the fact itself is asked for
};

// A fact that stands in the way of an absence.
struct InTheWay {
  TermQuad fact;        // without graph
  std::string absence;  // "{ expo:R01 docent:task ?t }"
  std::vector<TermQuad>
      withdraw;  // told facts to withdraw for it to go, with their graphs: each triple is one change
};

// A nearest partial match with what it lacks.
struct Repair {
  std::vector<ToTell> tell;
  std::vector<InTheWay> in_the_way;
  std::vector<TermQuad> holds;  // facts of the match that are there, without graph
  // Facts that rules would make of them: rule and fact.
  std::vector<std::pair<std::string, sparql::TriplePattern>> inferred;
  std::vector<std::string> conditions;                 // filters and absences of open variables
  std::vector<std::pair<std::string, Term>> bindings;  // of the query's variables
  // What was tried.
  std::vector<Quad> add;
  std::vector<Quad> remove;

  // Changes: facts to tell and triples to withdraw, from however many graphs.
  size_t size() const { return add.size() + Withdrawals().size(); }
  // `remove` by triples.
  std::vector<std::vector<Quad>> Withdrawals() const;
};

// What open variables were tried with.
using Examples = absl::flat_hash_map<int, TermId>;
// What open variables are called.
using OpenNames = absl::flat_hash_map<int, std::string>;

// Each open variable of a solution gets a name of its own.
OpenNames DistinctNames(const Solution& solution);

sparql::TriplePattern PatternOf(const MissingFact& fact, const Dictionary& dictionary,
                                const OpenNames& names);

// "{ expo:R01 docent:task ?t }"; variables of its own are not called as others are.
std::string AbsenceText(const Absence& absence, const Row& row, const OpenNames& names,
                        const Dictionary& dictionary, const Display& display);

// Adds what a solution lacks: facts to tell, and the conditions on their open variables. False: not facts that can be
// told (a literal as subject, a graph that only rules write); `repair` is then not to be used.
bool AddMissing(const Solution& solution, const Examples& examples, const OpenNames& names,
                const GraphVersion& version, Dictionary& dictionary, const Display& display, Repair& repair);

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_REPAIR_H_
