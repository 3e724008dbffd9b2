// Why a condition does not hold: the nearest partial matches, and the smallest sets of facts that would have to be
// told (or withdrawn) for it to hold, rules considered.
//
// Sets are looked for in the order of their size, and each is tried on a copy of the graph with the rules applied: it
// makes the condition true, and no proper subset of it does. What may be anything (a fact with an open variable) is
// tried with an example. Sets that would change what a thing is (rdf:type) are named only where no set as small
// changes less of that; axioms (of classes, properties, equality) that a rule asks for only where no set of facts about
// things does it, of any size.
#ifndef DOCENT_REASONER_EXPLAIN_WHY_NOT_H_
#define DOCENT_REASONER_EXPLAIN_WHY_NOT_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "absl/status/statusor.h"
#include "kb_server/base/explain_limits.h"
#include "kb_server/rdf/dictionary.h"
#include "kb_server/sparql/algebra.h"
#include "reasoner/explain/hypothesis.h"
#include "reasoner/explain/proof.h"
#include "reasoner/explain/solver.h"

namespace docent::explain {

// A fact that would have to be told.
struct ToTell {
  sparql::TriplePattern fact;  // open variables are variables
  Term graph;                  // empty IRI: any
  std::vector<Term> now;       // objects that the graph has instead, of the same subject and predicate; a few
  TermQuad example;            // with values in the place of open variables, as it was tried
};

// A fact that stands in the way of an absence.
struct InTheWay {
  TermQuad fact;                     // without graph
  std::string absence;               // "{ expo:R01 docent:task ?t }"
  std::vector<TermQuad> withdraw;    // the told facts to withdraw for it to go, with their graphs
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

  size_t size() const { return tell.size() + in_the_way.size(); }
};

struct WhyNotAnswer {
  bool holds = false;           // nothing to explain
  // Best first: facts about things before axioms, fewest changes, then changes of state before changes of kind.
  std::vector<Repair> repairs;
  size_t more = 0;              // sets as small as the last one that are not listed
  bool whole = true;            // false: the search ended at a limit; there may be smaller or more sets
  std::string failed_part;      // a path, aggregate or sub-SELECT that has no solution; empty: none known
};

class WhyNotFinder {
 public:
  struct Parts {
    const GraphVersion* version = nullptr;
    Dictionary* dictionary = nullptr;
    const RuleBase* rules = nullptr;
    Hypothesis* hypothesis = nullptr;
    Prover* prover = nullptr;
    const sparql::FunctionRegistry* functions = nullptr;
    sparql::RunOptions run;
    ExplainLimits limits;
    TermId default_graph;  // none: union
    std::vector<std::pair<std::string, std::string>> prefixes;
  };
  explicit WhyNotFinder(Parts parts);

  // `ask` does not hold on the version. At most `sets` repairs.
  absl::StatusOr<WhyNotAnswer> Find(const sparql::Query& ask, size_t sets);

 private:
  using Examples = absl::flat_hash_map<int, TermId>;  // by open variable

  absl::Status Gather(const Clause& clause, int changes, bool tell_derived, bool tell_schema,
                      std::vector<Repair>& found);
  absl::StatusOr<bool> Make(const Solution& solution, Repair& repair);
  bool PickExamples(const Solution& solution, Examples& examples);
  bool PickFrom(const std::vector<int>& open, size_t at, const Solution& solution,
                const absl::flat_hash_map<int, std::vector<TermId>>& candidates, Examples& examples,
                size_t& tries);
  bool LetsThrough(const OpenTest& test, const Examples& examples);
  std::vector<TermId> CandidatesFor(int open, const std::string& name, const Solution& solution);
  std::vector<Term> ValuesNow(const MissingFact& fact) const;
  absl::StatusOr<bool> MakesTrue(const std::vector<Quad>& add, const std::vector<Quad>& remove);
  absl::StatusOr<std::vector<std::vector<Quad>>> WaysToRemove(const Quad& fact);
  absl::StatusOr<bool> Check(Repair& repair);
  absl::StatusOr<bool> IsMinimal(const Repair& repair);
  void Rank(std::vector<Repair>& repairs) const;
  bool IsState(const sparql::TriplePattern& fact) const;

  const Parts parts_;
  Solver solver_;
  std::unique_ptr<sparql::PreparedQuery> ask_;
  absl::flat_hash_set<std::string> seen_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_WHY_NOT_H_
