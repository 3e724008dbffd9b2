// Runs SPARQL Updates: evaluates each beside the writer on the newest version and brings it through the door
// as quads, atomically. Where what it read has changed until its turn, it is evaluated again; after
// Limits::update_attempts it is evaluated on the writer's turn itself, within Limits::update_turn_ms.
// Thread-safe.
#ifndef DOCENT_KB_SERVER_WORK_UPDATE_RUNNER_H_
#define DOCENT_KB_SERVER_WORK_UPDATE_RUNNER_H_

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "graph/base/cancellation.h"
#include "graph/base/ids.h"
#include "graph/base/memory_budget.h"
#include "graph/sparql/run/update_evaluator.h"
#include "graph/sparql/syntax/update_algebra.h"
#include "graph/store/graph_version.h"
#include "kb_server/door/client.h"
#include "kb_server/door/inbox.h"
#include "kb_server/work/load_judge.h"

namespace docent::server {

struct WritePorts;

struct UpdateRequest {
  sparql::Update update;
  // What the request may keep, from its text to its answer; `update` is counted in it. Null: one is made as for a request
  // without a text.
  std::shared_ptr<MemoryUse> memory;
  std::string request_id;                      // as in a WriteBatch
  uint64_t request_digest = 0;                 // as in a WriteBatch
  Revision min_revision;                       // to be evaluated on this version or a later one
  ClientPtr client;                            // null: the server itself
  std::shared_ptr<Cancellation> cancellation;  // not null. Cancels the evaluation, not what is at the door
  absl::Duration timeout;                      // of waiting for a worker, and for min_revision
  LoadedText text;                             // of which its LOAD is, if the client sent one
  // For LOAD, once for each document, whose quads are counted in `memory`; empty: what WritePorts::remote allows.
  sparql::LoadDocument load;
  // Looks at each version that the update is evaluated on; an error ends it (a precondition). May be null.
  std::function<absl::Status(const GraphVersion& version)> precondition;
};

class UpdateRunner {
 public:
  // `ports` must outlive it, and the workers must be ended before it.
  explicit UpdateRunner(const WritePorts* ports) : ports_(*ports) {}

  // Answers through `done`, exactly once, from any thread: when the quads are durable and visible, or why
  // nothing was changed. An update that changes nothing is answered with the revision that it was evaluated
  // on. RESOURCE_EXHAUSTED at once where too much work waits.
  void Submit(UpdateRequest request, BatchCallback done);

  // A number that no other call gets: for names that must differ.
  uint64_t NextNumber() { return count_++; }

 private:
  class Job;
  const WritePorts& ports_;
  std::atomic<uint64_t> count_{0};
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_UPDATE_RUNNER_H_
