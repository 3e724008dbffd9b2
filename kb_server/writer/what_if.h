// What-if evaluation of a batch on copies of the stages: a visit copies the writer's state, a worker runs
// the same turn (kb_server/turn/turn.h) on private copies over a dictionary of its own, and throws them away.
#ifndef DOCENT_KB_SERVER_WRITER_WHAT_IF_H_
#define DOCENT_KB_SERVER_WRITER_WHAT_IF_H_

#include <memory>
#include <vector>

#include "graph/base/explain_limits.h"
#include "kb_server/door/catalog.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/what_if_port.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/turn/turn.h"
#include "workflow/engine/engine_state.h"

namespace docent::server {

// What private stages are made of. Value, but for the shared version.
struct StagesCopy {
  GraphVersionPtr version;
  std::vector<explain::RuleText> rules;
  std::vector<engine::ConditionRequest> conditions;
  std::vector<LastingSince> times;  // of those that must have held for some time
  engine::EngineState engine;
  EventShelf::Events events;
};

// The state after the turn that ran last. On the writer's thread, between two turns.
StagesCopy CopyStages(Stages* stages, Revision revision);

// Runs the batch on private stages. `dictionary` is over the writer's and the caller's own. Beside the writer.
// CANCELLED or DEADLINE_EXCEEDED by `cancellation`, which may be null.
absl::StatusOr<WhatIfAnswer> RunWhatIf(const StagesCopy& copy, Dictionary* dictionary,
                                       const sparql::FunctionRegistry* functions, const Limits& limits,
                                       WriteBatch batch, Cancellation* cancellation = nullptr);

class WhatIf final : public WhatIfPort {
 public:
  struct Ports {
    Inbox* inbox = nullptr;
    WorkerPool* workers = nullptr;
    const Dictionary* dictionary = nullptr;
    const sparql::FunctionRegistry* functions = nullptr;
    const Clock* clock = nullptr;
    Limits limits;
    ExplainLimits explain_limits;
  };
  // Everything must outlive it.
  explicit WhatIf(const Ports& ports) : ports_(ports) {}
  void Ask(WriteBatch batch, ClientPtr client, std::shared_ptr<Cancellation> cancellation,
           Answered answered) override;

 private:
  const Ports ports_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WRITER_WHAT_IF_H_
