// Brings loads (ontology modules, rule sets, data) through the door, judged by the shapes that are loaded where the server
// is to do that (WritePorts::on_violation). A load is judged beside the writer; where what the shapes read has changed
// until its turn, it is judged again, at most Limits::update_attempts times. Thread-safe.
#ifndef DOCENT_KB_SERVER_WORK_LOAD_RUNNER_H_
#define DOCENT_KB_SERVER_WORK_LOAD_RUNNER_H_

#include <functional>
#include <memory>

#include "graph/base/diagnostic.h"
#include "kb_server/door/client.h"
#include "kb_server/door/inbox.h"
#include "kb_server/work/load_judge.h"

namespace docent {
class Cancellation;
}  // namespace docent

namespace docent::server {

struct WritePorts;

using LoadCallback =
    std::function<void(const absl::StatusOr<BatchOutcome>& outcome, const Diagnostics& warnings)>;

struct LoadJob {
  WriteBatch batch;
  LoadedText text;           // that the batch was made of
  BatchPreparation prepare;  // on the writer's turn, before the batch is applied; may be null
  std::shared_ptr<Cancellation> cancellation;  // of the judging; not null
  ClientPtr client;                            // null: the server itself
  LoadCallback done;
};

class LoadRunner {
 public:
  // `ports` must outlive it, and the workers must be ended before it.
  explicit LoadRunner(const WritePorts* ports) : ports_(*ports) {}

  // On a worker, where it may take long. Answers exactly once, from any thread. FAILED_PRECONDITION with the results: the
  // load is refused; ABORTED: what it is judged by kept changing.
  void Run(LoadJob job);

 private:
  class Attempt;
  const WritePorts& ports_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_LOAD_RUNNER_H_
