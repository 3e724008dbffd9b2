// Origin of a fact (source, time, offset), read from the log, newest record first. Any thread.
#ifndef DOCENT_KB_SERVER_WRITER_LOG_HISTORY_H_
#define DOCENT_KB_SERVER_WRITER_LOG_HISTORY_H_

#include "graph/base/explain_limits.h"
#include "graph/log/context_log.h"
#include "graph/rdf/dictionary.h"
#include "reasoner/explain/fact_history.h"

namespace docent::server {

class LogHistory final : public explain::FactHistory {
 public:
  // Both must outlive it.
  LogHistory(log::ContextLog* log, const Dictionary* dictionary, const ExplainLimits& limits)
      : log_(*log), dictionary_(*dictionary), limits_(limits) {}

  // Looks at the newest Limits::explain_log_records records up to the version's revision. What a reading became is
  // found by the mappings of that version.
  absl::StatusOr<std::vector<std::optional<explain::Telling>>> Find(const std::vector<TermQuad>& quads,
                                                                    const GraphVersion& version,
                                                                    Cancellation* cancellation) override;

 private:
  log::ContextLog& log_;
  const Dictionary& dictionary_;
  const ExplainLimits limits_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WRITER_LOG_HISTORY_H_
