// What handlers of requests need of a server, without one: a graph, the door, and a writer that applies batches and does
// nothing else.
#ifndef DOCENT_TESTS_KB_SERVER_HANDLER_WORLD_H_
#define DOCENT_TESTS_KB_SERVER_HANDLER_WORLD_H_

#include <optional>
#include <thread>
#include <utility>

#include "graph/rdf/dictionary.h"
#include "graph/store/batch_applier.h"
#include "graph/store/graph_writer.h"
#include "graph/store/recent_changes.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/ports.h"
#include "kb_server/door/query_port.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/work/update_runner.h"

namespace docent::server::test {

class HandlerWorld {
 public:
  HandlerWorld() {
    ports.queries = &queries;
    ports.dictionary = &dictionary;
    ports.workers = &*workers;
    ports.clock = &clock;
    ports.inbox = &inbox;
    ports.updates = &updates;
    writer_thread_ = std::thread([this] { Write(); });
  }
  ~HandlerWorld() {
    workers.reset();
    inbox.Close();
    writer_thread_.join();
  }

  Dictionary dictionary;
  ManualClock clock{1'700'000'000'000'000};
  QueryPort queries;
  Inbox inbox{&clock, Limits{}};
  std::optional<WorkerPool> workers{WorkerPoolLimits{/*running=*/2, /*open=*/4, /*queue=*/16}};
  ServicePorts ports;  // those that have a part here
  UpdateRunner updates{&ports};

 private:
  void Write() {
    while (true) {
      std::vector<PendingBatch> batches = inbox.PopAll(std::nullopt, 16);
      if (batches.empty() && inbox.closed()) return;
      for (PendingBatch& pending : batches) pending.done(Apply(&pending));
    }
  }
  absl::StatusOr<BatchOutcome> Apply(PendingBatch* pending) {
    const auto has_document = [](Document::Kind, const std::string&) { return false; };
    const TurnView view{writer_.current(), revision_, changes_, has_document};
    absl::Status prepared = pending->prepare ? pending->prepare(view, &pending->batch) : absl::OkStatus();
    if (!prepared.ok()) return prepared;
    absl::StatusOr<Delta> delta = applier_.Apply(pending->batch, writer_, {});
    if (!delta.ok()) {
      writer_.Rollback();
      applier_.Rollback();
      return delta.status();
    }
    writer_.Commit();
    applier_.Commit();
    revision_ = Revision(revision_.value() + 1);
    changes_.Add(revision_, *delta);
    queries.Publish(writer_.Freeze(revision_));
    BatchOutcome outcome;
    outcome.offset = revision_.value();
    outcome.added = delta->added.size();
    outcome.removed = delta->removed.size();
    return outcome;
  }

  GraphWriter writer_{nullptr};
  BatchApplier applier_{dictionary, Limits{}};
  RecentChanges changes_;
  Revision revision_;
  std::thread writer_thread_;
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_HANDLER_WORLD_H_
