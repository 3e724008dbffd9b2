// Interface to the origin of facts (source and time of an assertion). The server's implementation is
// kb_server/writer/log_history.h.
#ifndef DOCENT_REASONER_EXPLAIN_FACT_HISTORY_H_
#define DOCENT_REASONER_EXPLAIN_FACT_HISTORY_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"
#include "graph/store/graph_version.h"

namespace docent::explain {

struct Telling {
  uint64_t offset = 0;
  TimeMicros time_us = 0;
  std::string by;  // "reading of <sensor>", "ontology NAME"; empty: a plain fact
};

class FactHistory {
 public:
  virtual ~FactHistory() = default;
  // For each quad its newest assertion up to the version; nullopt if it is older than the records searched
  // (limit explain_log_records) or was never asserted. Any thread.
  virtual absl::StatusOr<std::vector<std::optional<Telling>>> Find(const std::vector<TermQuad>& quads,
                                                                   const GraphVersion& version,
                                                                   Cancellation* cancellation) = 0;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_FACT_HISTORY_H_
