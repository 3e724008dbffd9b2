// Choice of example values for the open variables of missing facts, such that the filters pass. One thread.
#ifndef DOCENT_REASONER_EXPLAIN_EXAMPLE_PICKER_H_
#define DOCENT_REASONER_EXPLAIN_EXAMPLE_PICKER_H_

#include <optional>
#include <string>
#include <vector>

#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "reasoner/explain/repair.h"
#include "reasoner/explain/solver.h"

namespace docent::explain {

class ExamplePicker {
 public:
  // All arguments must outlive it. `solver` evaluates filters; it must not be inside a Solve.
  ExamplePicker(const GraphVersion& version, Dictionary& dictionary, Solver& solver)
      : version_(version), dictionary_(dictionary), solver_(solver) {}

  // One value for each open variable of the missing facts. nullopt: none found.
  std::optional<Examples> Pick(const Solution& solution);

 private:
  bool PickFrom(const std::vector<int>& open, size_t at, const Solution& solution,
                const absl::flat_hash_map<int, std::vector<TermId>>& candidates, Examples& examples,
                size_t& tries);
  bool LetsThrough(const OpenTest& test, const Examples& examples);
  std::vector<TermId> CandidatesFor(int open, const std::string& name, const Solution& solution);

  const GraphVersion& version_;
  Dictionary& dictionary_;
  Solver& solver_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_EXAMPLE_PICKER_H_
