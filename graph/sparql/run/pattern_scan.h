// The matches of one pattern for one row, in the graphs that the pattern is about. One thread.
#ifndef DOCENT_GRAPH_SPARQL_RUN_PATTERN_SCAN_H_
#define DOCENT_GRAPH_SPARQL_RUN_PATTERN_SCAN_H_

#include <array>
#include <optional>
#include <utility>

#include "graph/sparql/plan/evaluation_context.h"
#include "graph/sparql/plan/plan.h"
#include "graph/store/graph_version.h"

namespace docent::sparql {

// Usage: scan.Open(pattern, row, context); while (scan.Next(row)) …; what Next put into the row is taken out
// again when it returns false, or by Close.
class PatternScan {
 public:
  void Open(const PlanPattern& pattern, const TermId* row, EvaluationContext& context);
  bool Next(TermId* row);
  // Instead of Next, right after Open: how many matches there are.
  uint64_t Count(TermId* row);
  void Close(TermId* row);
  // The version and the dataset may be others from now on.
  void Forget() {
    cursor_.Forget();
    bound_ = kNothingYet;
  }
  // How many Opens found their matches elsewhere than beside the last ones.
  uint64_t descents() const { return cursor_.descents(); }

 private:
  static constexpr unsigned kNothingYet = ~0u;

  // What all rows that bind these terms (a bit each: 1, 2, 4, and 8 for the graph's name) have in common.
  void Prepare(const PlanPattern& pattern, unsigned bound);
  // What a pattern outside GRAPH or inside it may match.
  void PrepareGraph(const GraphRef& graph, bool bound);
  bool GraphAllowed(TermId graph) const;
  // Whether what the cursor stands at is a match, where `checks_`.
  bool Passes();
  void AssignTo(int slot, int position);

  // The matches give `slot` the term at this position (0 to 3: subject, predicate, object, graph).
  struct Assign {
    int slot;
    int position;
  };

  EvaluationContext* context_ = nullptr;
  QuadCursor cursor_;
  bool valid_ = false;
  bool first_ = false;
  Quad last_;  // the last one allowed, where `checks_` and `merge_`

  // From Prepare.
  unsigned bound_ = kNothingYet;               // what it was for
  bool sees_ = false;                          // there is a graph to look at
  bool checks_ = false;                        // not everything that the cursor finds is a match
  bool merge_ = false;                         // the same triple in several graphs is one match
  TermId graph_;                               // the only one, where no name says which
  const std::vector<TermId>* only_ = nullptr;  // graphs allowed; null: all
  TermId except_;                              // graph not allowed
  std::optional<AccessPath> path_;             // none: it depends on the terms
  std::array<Assign, 4> assigns_;
  int assigned_ = 0;                          // how many of them
  std::array<std::pair<int, int>, 4> equal_;  // positions that must hold the same term
  int equals_ = 0;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_PATTERN_SCAN_H_
