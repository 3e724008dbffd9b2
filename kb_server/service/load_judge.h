// Would the graph violate its shapes after a load? The batch is applied to a private copy of a version, beside the writer;
// rules are not: what they would derive of the load is not seen. Any thread.
#ifndef DOCENT_KB_SERVER_SERVICE_LOAD_JUDGE_H_
#define DOCENT_KB_SERVER_SERVICE_LOAD_JUDGE_H_

#include <vector>

#include "absl/status/statusor.h"
#include "kb_server/base/cancellation.h"
#include "kb_server/base/diagnostic.h"
#include "kb_server/service/ports.h"
#include "kb_server/store/recent_changes.h"
#include "kb_server/store/write_batch.h"
#include "reasoner/shapes/report.h"

namespace docent {

// A result with terms in the place of ids, which a private copy's dictionary gave.
struct JudgedResult {
  shapes::ResultText text;
  Term focus, value, shape;  // an empty IRI as value: none
  bool violation = false;    // sh:Violation
};

struct LoadVerdict {
  std::vector<JudgedResult> results;  // that the version before does not have
  Diagnostics diagnostics;            // ill-formed shapes
  std::vector<ReadPattern> reads;     // what the shapes looked at
  bool HasViolations() const;
};

// The batch of a Load on `version`: its documents are ontologies (replaced or removed), its operations quads. CANCELLED,
// DEADLINE_EXCEEDED, RESOURCE_EXHAUSTED: there is no verdict.
absl::StatusOr<LoadVerdict> JudgeLoad(const ServicePorts& ports, const WriteBatch& batch, const GraphVersion& version,
                                      Cancellation* cancellation);

// The graphs of the ontology modules: where shapes are looked for.
std::vector<TermId> ModuleGraphs(const GraphVersion& version, const Dictionary& dictionary);

}  // namespace docent

#endif  // DOCENT_KB_SERVER_SERVICE_LOAD_JUDGE_H_
