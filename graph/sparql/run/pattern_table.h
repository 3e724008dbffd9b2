// Hash table of the matches of one pattern's constants, by the values of the slots that earlier patterns
// bind. A level of a basic graph pattern uses it after many index lookups. One thread.
#ifndef DOCENT_GRAPH_SPARQL_RUN_PATTERN_TABLE_H_
#define DOCENT_GRAPH_SPARQL_RUN_PATTERN_TABLE_H_

#include <cstdint>
#include <vector>

#include "graph/sparql/plan/evaluation_context.h"
#include "graph/sparql/plan/plan.h"
#include "graph/sparql/run/pattern_scan.h"
#include "graph/sparql/run/row_set.h"

namespace docent::sparql {

class PatternTable {
 public:
  // True if the table is built and its keys are the pattern's slots that are bound in `row`.
  bool Fits(const TermId* row) const;
  // Builds it for those slots. False, and there is no table, if it would take much of the query's memory, if
  // the pattern has no bound slot, if it has far more matches than counted (pattern.matches is then raised),
  // or if the evaluation must end.
  bool Build(PlanPattern& pattern, const TermId* row, size_t slots, EvaluationContext& context);
  // Used as PatternScan. Requires Fits.
  void Open(const TermId* row);
  bool Next(TermId* row, EvaluationContext& context);
  void Forget();

 private:
  static constexpr uint32_t kEnd = ~uint32_t{0};

  // The values of the key's slots, one after the other.
  const TermId* KeyOf(const TermId* row);

  RowSet keys_{0};
  std::vector<int> key_slots_, value_slots_;
  std::vector<TermId> values_;          // value_slots_.size() each
  std::vector<uint32_t> first_, next_;  // chains of matches with the same key
  std::vector<TermId> key_;
  uint32_t at_ = kEnd;
  KeptMemory kept_;
  bool ready_ = false;
  bool given_ = false;  // the row holds values from this table
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_PATTERN_TABLE_H_
