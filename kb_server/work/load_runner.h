// Brings what clients write (ontology modules, rule sets, data, told facts, updates) through the door, judged by the shapes that are
// loaded where the server is to do that (WritePorts::on_violation). A write is judged beside the writer; where what the shapes
// read has changed until its turn, it is judged again, after Limits::update_attempts times on its turn itself, within
// Limits::update_turn_ms. Thread-safe.
#ifndef DOCENT_KB_SERVER_WORK_LOAD_RUNNER_H_
#define DOCENT_KB_SERVER_WORK_LOAD_RUNNER_H_

#include <functional>
#include <memory>

#include "graph/base/diagnostic.h"
#include "kb_server/door/catalog.h"
#include "kb_server/door/client.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/ports.h"
#include "kb_server/work/load_judge.h"
#include "kb_server/work/unknown_words.h"

namespace docent {
class Cancellation;
}  // namespace docent

namespace docent::server {

using LoadCallback =
    std::function<void(const absl::StatusOr<BatchOutcome>& outcome, const Diagnostics& warnings)>;

struct LoadJob {
  WriteBatch batch;
  LoadedText text;           // that the batch was made of
  BatchPreparation prepare;  // on the writer's turn, before the batch is applied; may be null
  std::shared_ptr<Cancellation> cancellation;  // of the judging; not null
  ClientPtr client;                            // null: the server itself
  LoadCallback done;
  bool made_on_turn = false;  // `prepare` fills the batch: it can be judged on its turn alone
};

class LoadRunner {
 public:
  // `ports` must outlive it, and the workers must be ended before it.
  // `catalog`: of the rules in use; null: there are none.
  explicit LoadRunner(const WritePorts* ports, const CatalogPort* catalog = nullptr)
      : ports_(*ports), catalog_(catalog), unknown_words_(ports, catalog) {}

  // On a worker, where it may take long. Answers exactly once, from any thread. FAILED_PRECONDITION with the results: the
  // load is refused; ABORTED: what it is judged by kept changing.
  void Run(LoadJob job);
  // The same from any thread: a worker judges it. Warnings are in the outcome.
  void Bring(WriteBatch batch, LoadedText text, BatchPreparation prepare, bool made_on_turn, ClientPtr client,
             BatchCallback done);

 private:
  class Attempt;
  RuleTexts Rules() const;
  Diagnostics UnknownIn(const WriteBatch& batch, const LoadedText& text);
  const WritePorts& ports_;
  const CatalogPort* const catalog_;
  UnknownWords unknown_words_;
};

// By LoadRunner::Bring, where there is a runner; else as it is. `text`: as in LoadJob.
void BringJudged(const WritePorts& ports, WriteBatch batch, LoadedText text, BatchPreparation prepare,
                 bool made_on_turn, ClientPtr client, BatchCallback done);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_LOAD_RUNNER_H_
