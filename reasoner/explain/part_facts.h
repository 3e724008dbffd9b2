// The facts behind what the solver leaves to the evaluator: recursive paths, aggregates, sub-SELECTs with a LIMIT.
//
// Of a path: a chain of facts from one end to the other, told ones preferred, else the shortest. Of an aggregate: the
// facts of its group. Of others: those of one solution. One thread.
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
  std::vector<Quad> facts;  // graph: none where any will do; the first ones
  size_t more = 0;          // that are not among them
  // Without one of `facts` there would be no such solution by these facts, and nothing told besides can change that.
  bool whole = false;
};

class PartFacts {
 public:
  // All must outlive it. Beyond `steps` (matches, and places of paths) nothing more is found.
  PartFacts(const GraphVersion& version, Dictionary& dictionary, const sparql::FunctionRegistry* functions,
            const sparql::RunOptions& run, size_t steps)
      : version_(version), dictionary_(dictionary), functions_(functions), run_(run), step_limit_(steps) {}

  // What the part rests on in a solution of its clause. CANCELLED, DEADLINE_EXCEEDED.
  absl::StatusOr<Ground> Of(const Part& part, const Row& row);
  size_t steps() const { return steps_; }

 private:
  using ByName = absl::flat_hash_map<std::string, TermId>;

  // None: nothing known.
  TermId IdOf(const sparql::PatternTerm& term, const ByName& values) const;
  // `graph`: where facts are looked for; none: anywhere.
  std::optional<std::vector<Quad>> Chain(const sparql::Path& path, TermId graph, TermId from, TermId to);
  Ground OfPath(const sparql::Algebra& node, TermId graph, const ByName& values);
  // Facts of `solutions` solutions, at most.
  absl::Status AddSolutions(const sparql::Algebra& node, TermId graph, const ByName& values, size_t solutions,
                            Ground& ground);

  const GraphVersion& version_;
  Dictionary& dictionary_;
  const sparql::FunctionRegistry* functions_;
  const sparql::RunOptions run_;
  const size_t step_limit_;
  size_t steps_ = 0;
  int depth_ = 0;  // parts in parts
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_PART_FACTS_H_
