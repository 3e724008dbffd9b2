// The matches of one pattern for one row, in the graphs that the pattern is about. One thread.
#ifndef DOCENT_KB_SERVER_SPARQL_PATTERN_SCAN_H_
#define DOCENT_KB_SERVER_SPARQL_PATTERN_SCAN_H_

#include "kb_server/sparql/evaluation_context.h"
#include "kb_server/sparql/plan.h"
#include "kb_server/store/graph_version.h"

namespace docent::sparql {

// Usage: scan.Open(pattern, row, context); while (scan.Next(row)) …; what Next put into the row is taken out
// again when it returns false, or by Close.
class PatternScan {
 public:
  void Open(const PlanPattern& pattern, const TermId* row, EvaluationContext& context);
  bool Next(TermId* row);
  void Close(TermId* row);
  // The version may be another one from now on.
  void Forget() { known_ = false; }

 private:
  // What a pattern outside GRAPH, inside GRAPH <iri> or GRAPH ?g may match; false: nothing.
  bool OpenGraph(const GraphRef& graph, const TermId* row, QuadPattern* quad);
  bool GraphAllowed(TermId graph) const;

  EvaluationContext* context_ = nullptr;
  QuadCursor cursor_;
  bool known_ = false;  // cursor_ is of the context's version
  Quad last_;
  bool valid_ = false;
  bool first_ = false;
  bool merge_ = false;                         // the same triple in several graphs is one match
  const std::vector<TermId>* only_ = nullptr;  // graphs allowed; null: all
  TermId except_;                              // graph not allowed
  int assign_[4];                              // slots that take the quad's positions; -1: already bound
  int assigns_ = 0;
  int same_as_[3];  // an earlier position that must hold the same term; -1: none
  bool repeats_ = false;
};

}  // namespace docent::sparql

#endif  // DOCENT_KB_SERVER_SPARQL_PATTERN_SCAN_H_
