// Facts behind the parts that only the evaluator understands: recursive paths, aggregates, sub-SELECTs with a
// LIMIT.
//
// For a path: a chain of facts from one end to the other, with a preference for asserted facts, then for
// short chains. For an aggregate: the facts of its group. For others: the facts of one solution. One thread.
#ifndef DOCENT_REASONER_EXPLAIN_PART_FACTS_H_
#define DOCENT_REASONER_EXPLAIN_PART_FACTS_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/statusor.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "reasoner/explain/solver.h"

namespace docent::explain {

struct Ground {
  std::vector<Quad> facts;  // the first ones; graph: kNone if any graph will do
  size_t more = 0;          // further facts that are not in the list
  // Each of `facts` is needed: without it there is no such solution, and no other assertion can change that.
  bool whole = false;
};

class PartFacts {
 public:
  // All arguments must outlive it. After `steps` (matches, and places of paths) the search ends.
  PartFacts(const GraphVersion& version, Dictionary& dictionary, const sparql::FunctionRegistry* functions,
            const sparql::RunOptions& run, size_t steps)
      : version_(version), dictionary_(dictionary), functions_(functions), run_(run), step_limit_(steps) {}

  // The facts on which the part rests in a solution of its clause. CANCELLED, DEADLINE_EXCEEDED.
  absl::StatusOr<Ground> Of(const Part& part, const Row& row);
  size_t steps() const { return steps_; }

 private:
  using ByName = absl::flat_hash_map<std::string, TermId>;

  // kNone: not known.
  TermId IdOf(const sparql::PatternTerm& term, const ByName& values) const;
  // `graph`: the graph of the facts; kNone: any graph.
  std::optional<std::vector<Quad>> Chain(const sparql::Path& path, TermId graph, TermId from, TermId to);
  Ground OfPath(const sparql::Algebra& node, TermId graph, const ByName& values);
  // Facts of at most `solutions` solutions.
  absl::Status AddSolutions(const sparql::Algebra& node, TermId graph, const ByName& values, size_t solutions,
                            Ground& ground);

  const GraphVersion& version_;
  Dictionary& dictionary_;
  const sparql::FunctionRegistry* functions_;
  const sparql::RunOptions run_;
  const size_t step_limit_;
  size_t steps_ = 0;
  int depth_ = 0;  // nesting of parts
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_PART_FACTS_H_
