// Repairs of a false condition: facts to assert and facts in the way, in the form for display and the form
// for trial. Pure functions; any thread.
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

// A fact to assert.
struct ToTell {
  sparql::TriplePattern fact;  // open variables are variables
  Term graph;                  // empty IRI: any
  std::vector<Term> now;       // current objects of the same subject and predicate; a few
  TermQuad example;            // the fact as tried, with example values for open variables
  std::string absence;  // "{ expo:R01 a docent:Idle }", which then holds; empty: the fact itself is needed
};

// A fact that keeps an absence from holding.
struct InTheWay {
  TermQuad fact;        // without graph
  std::string absence;  // "{ expo:R01 docent:task ?t }"
  std::vector<TermQuad>
      withdraw;  // asserted facts to withdraw to remove it, with their graphs: each triple is one change
};

// A nearest partial match with its missing facts.
struct Repair {
  std::vector<ToTell> tell;
  std::vector<InTheWay> in_the_way;
  std::vector<TermQuad> holds;  // facts of the match that hold, without graph
  // Facts that rules would infer: rule and fact.
  std::vector<std::pair<std::string, sparql::TriplePattern>> inferred;
  std::vector<std::string> conditions;                 // filters and absences of open variables
  std::vector<std::pair<std::string, Term>> bindings;  // of the query's variables
  // The changes that were tried.
  std::vector<Quad> add;
  std::vector<Quad> remove;

  // Number of changes: facts to assert and triples to withdraw, from however many graphs.
  size_t size() const { return add.size() + Withdrawals().size(); }
  // `remove`, grouped by triple.
  std::vector<std::vector<Quad>> Withdrawals() const;
};

// Values tried for open variables.
using Examples = absl::flat_hash_map<int, TermId>;
// Display names of open variables.
using OpenNames = absl::flat_hash_map<int, std::string>;

// A distinct name for each open variable of a solution.
OpenNames DistinctNames(const Solution& solution);

sparql::TriplePattern PatternOf(const MissingFact& fact, const Dictionary& dictionary,
                                const OpenNames& names);

// "{ expo:R01 docent:task ?t }"; its local variables get names that differ from the others.
std::string AbsenceText(const Absence& absence, const Row& row, const OpenNames& names,
                        const Dictionary& dictionary, const Display& display);

// Adds the missing facts of a solution, and the conditions on their open variables. False: some cannot be
// asserted (a literal as subject, a graph that only rules write); then `repair` must not be used.
bool AddMissing(const Solution& solution, const Examples& examples, const OpenNames& names,
                const GraphVersion& version, Dictionary& dictionary, const Display& display, Repair& repair);

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_REPAIR_H_
