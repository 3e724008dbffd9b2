// A data folder as a quad store, without a server: opening it restores the newest snapshot and replays the log
// after it, reads are of the newest version, and each change is a turn like a server's (rules infer,
// conditions hold, workflows move), durable before it is acknowledged. Snapshots are taken and the log is
// trimmed as in a server that runs. Commands to robots that a change decides are recorded and go out when a
// server runs on the folder. One thread.
//
// The folder is locked meanwhile: a server cannot start on it, and it cannot be opened while one runs.
#ifndef DOCENT_KB_SERVER_WRITER_FOLDER_STORE_H_
#define DOCENT_KB_SERVER_WRITER_FOLDER_STORE_H_

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/limits.h"
#include "graph/log/context_log.h"
#include "graph/rdf/dictionary.h"
#include "graph/redland/quad_store.h"
#include "kb_server/door/catalog.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/query_port.h"
#include "kb_server/door/run_feed.h"
#include "kb_server/writer/snapshot_keeper.h"
#include "kb_server/writer/writer.h"

namespace docent::server {

class FolderStore final : public redland::QuadStore {
 public:
  // `clock` must outlive it. Errors: NOT_FOUND (there is no log in such a folder, and not `make_new`),
  // FAILED_PRECONDITION (in use, by which process; a newer format; `make_new` and the folder has records),
  // DATA_LOSS, PERMISSION_DENIED, and those of recovery.
  static absl::StatusOr<std::unique_ptr<FolderStore>> Open(const std::string& folder, bool make_new,
                                                           const Clock* clock, const Limits& limits = {});
  // Waits for what is being written, a snapshot too.
  ~FolderStore() override;

  absl::StatusOr<std::unique_ptr<redland::QuadStream>> Find(const redland::QuadQuery& query) override;
  absl::StatusOr<uint64_t> Size() override;
  absl::StatusOr<std::vector<Term>> Graphs() override;
  absl::Status Apply(std::vector<QuadOperation> operations) override;

 private:
  FolderStore(const Clock* clock, const Limits& limits);

  const Limits limits_;
  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  std::unique_ptr<log::ContextLog> log_;
  Inbox inbox_;
  QueryPort queries_;
  CatalogPort catalog_;
  RunFeed feed_;
  std::unique_ptr<SnapshotKeeper> snapshots_;
  std::unique_ptr<Writer> writer_;
  std::thread writer_thread_;  // from the first change on: whoever only reads writes nothing, timers neither
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WRITER_FOLDER_STORE_H_
