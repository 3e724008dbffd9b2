// "What would happen if …": the question's way to those who can answer it, and the answer. Values; any thread.
#ifndef DOCENT_KB_SERVER_DOOR_WHAT_IF_PORT_H_
#define DOCENT_KB_SERVER_DOOR_WHAT_IF_PORT_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"
#include "graph/store/decisions.h"
#include "graph/store/write_batch.h"
#include "kb_server/door/client.h"

namespace docent::server {

// A standing condition that would begin or cease to hold, or whose bindings would change.
struct ConditionFlip {
  std::string place;  // "run BoothGuide-1, node Move2Booth"; "activator of BoothGuide"
  std::string ask;    // SPARQL
  bool held = false;
  bool holds = false;
  // Of an activator: key bindings that would come and go, variable → value.
  std::vector<std::vector<std::pair<std::string, Term>>> appeared;
  std::vector<std::vector<std::pair<std::string, Term>>> disappeared;
  TimeMicros lasting_us = 0;  // what rises or appears counts only when it has held for so long
};

struct WhatIfAnswer {
  Revision revision;            // that it was asked of
  std::vector<TermQuad> added;  // told and inferred, run facts left out
  std::vector<TermQuad> removed;
  std::vector<ConditionFlip> flips;
  std::vector<Transition> transitions;
  std::vector<std::string> commands;  // for people
};

class WhatIfPort {
 public:
  virtual ~WhatIfPort() = default;
  using Answered = std::function<void(const absl::StatusOr<WhatIfAnswer>&)>;
  // What the batch would do to the newest state. Answers once, from any thread. Errors as if it were told, and
  // RESOURCE_EXHAUSTED for more than what_if_operations; CANCELLED or DEADLINE_EXCEEDED by `cancellation`.
  virtual void Ask(WriteBatch batch, ClientPtr client, std::shared_ptr<Cancellation> cancellation,
                   Answered answered) = 0;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_WHAT_IF_PORT_H_
