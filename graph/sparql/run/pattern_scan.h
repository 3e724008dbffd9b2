// Scan of the matches of one pattern for one row, in the graphs of the pattern. One thread.
#ifndef DOCENT_GRAPH_SPARQL_RUN_PATTERN_SCAN_H_
#define DOCENT_GRAPH_SPARQL_RUN_PATTERN_SCAN_H_

#include <array>
#include <optional>
#include <utility>

#include "graph/sparql/plan/evaluation_context.h"
#include "graph/sparql/plan/plan.h"
#include "graph/store/graph_version.h"

namespace docent::sparql {

// Usage: scan.Open(pattern, row, context); while (scan.Next(row)) …; Next binds slots of the row; they are
// unbound when it returns false, or by Close.
class PatternScan {
 public:
  void Open(const PlanPattern& pattern, const TermId* row, EvaluationContext& context);
  bool Next(TermId* row);
  // Instead of Next, right after Open: the number of matches.
  uint64_t Count(TermId* row);
  void Close(TermId* row);
  // Drops prepared state: the version and the dataset may change.
  void Forget() {
    cursor_.Forget();
    bound_ = kNothingYet;
  }
  // The number of Opens whose matches were not beside the last ones.
  uint64_t descents() const { return cursor_.descents(); }

 private:
  static constexpr unsigned kNothingYet = ~0u;

  // Prepares the common part of all rows that bind these terms (bits 1, 2, 4, and 8 for the graph's name).
  void Prepare(const PlanPattern& pattern, unsigned bound);
  // Prepares the graphs that a pattern outside or inside GRAPH may match.
  void PrepareGraph(const GraphRef& graph, bool bound);
  bool GraphAllowed(TermId graph) const;
  // Checks the cursor's quad, if `checks_`.
  bool Passes();
  void AssignTo(int slot, int position);

  // A match binds `slot` to the term at this position (0 to 3: subject, predicate, object, graph).
  struct Assign {
    int slot;
    int position;
  };

  EvaluationContext* context_ = nullptr;
  QuadCursor cursor_;
  bool valid_ = false;
  bool first_ = false;
  Quad last_;  // the last accepted quad, if `checks_` and `merge_`

  // Set by Prepare.
  unsigned bound_ = kNothingYet;               // terms it was prepared for
  bool sees_ = false;                          // there is a graph to search
  bool checks_ = false;                        // some quads of the cursor are no matches
  bool merge_ = false;                         // the same triple in several graphs is one match
  TermId graph_;                               // the only graph, if no name gives it
  const std::vector<TermId>* only_ = nullptr;  // graphs allowed; null: all
  TermId except_;                              // graph not allowed
  std::optional<AccessPath> path_;             // nullopt: depends on the terms
  std::array<Assign, 4> assigns_;
  int assigned_ = 0;                          // number of assignments
  std::array<std::pair<int, int>, 4> equal_;  // positions that must hold the same term
  int equals_ = 0;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_PATTERN_SCAN_H_
