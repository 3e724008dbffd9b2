// Trigger analysis: finds the changes of the graph that can change the answer of a pattern, and the variables
// that such a change binds.
//
// It reads the algebra of a rule body or standing condition and lists all its triple patterns as triggers.
// Pure analysis of the algebra, no store. Any thread.
#ifndef DOCENT_REASONER_MATCHING_TRIGGER_ANALYSIS_H_
#define DOCENT_REASONER_MATCHING_TRIGGER_ANALYSIS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "graph/sparql/syntax/algebra.h"

namespace docent::matching {

// The direction in which a match of a pattern acts.
enum class Polarity : uint8_t {
  kPositive,  // another match can only add solutions: { ?r ex:at ?b }, FILTER EXISTS { … }
  kNegative,  // another match can only take solutions away: NOT EXISTS { … }, MINUS { … }
  kBoth,      // OPTIONAL, aggregates, EXISTS inside an expression
};

struct TriggerSource {
  sparql::TriplePattern pattern;  // for a path: its IRI as predicate between variables, or three variables
  sparql::PatternTerm graph;      // inside GRAPH; a variable with an empty name elsewhere
  Polarity polarity = Polarity::kPositive;
  // Every solution contains a match of this pattern (it is in the conjunction of the outermost group).
  bool required = false;
  // Variables that a matching quad may bind in the whole query without losing or inventing a solution that
  // rests on this match. Empty: the query must be evaluated whole.
  std::vector<std::string> seeds;
};

struct TriggerAnalysis {
  std::vector<TriggerSource> triggers;
  // Variables in scope that may be bound initially to test whether there is a solution.
  absl::flat_hash_set<std::string> seedable;
  // Those of them that every solution binds: an initial binding only selects solutions and changes none.
  absl::flat_hash_set<std::string> certain;
  bool is_volatile =
      false;  // NOW(), RAND(), UUID(), STRUUID() or BNODE(): answers change without a change of the graph
};

TriggerAnalysis AnalyseTriggers(const sparql::Algebra& where);

// Variables that every solution of `algebra` binds by a triple pattern or GRAPH name.
absl::flat_hash_set<std::string> CertainVariables(const sparql::Algebra& algebra);

// The GROUP BY of an aggregating sub-SELECT (a Project over it, with the expressions of SELECT and HAVING
// between them); null for any other algebra.
const sparql::Algebra* GroupOf(const sparql::Algebra& project);

// `algebra` without the outer operators that do not change whether there are solutions and which: Project,
// Distinct, Reduced and OrderBy.
const sparql::Algebra& WithoutModifiers(const sparql::Algebra& algebra);

}  // namespace docent::matching

#endif  // DOCENT_REASONER_MATCHING_TRIGGER_ANALYSIS_H_
