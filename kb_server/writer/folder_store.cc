#include "kb_server/writer/folder_store.h"

#include <future>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/log/log_end.h"
#include "graph/log/sqlite_log.h"
#include "graph/redland/version_store.h"
#include "kb_server/turn/spatial_functions.h"

namespace docent::server {

FolderStore::FolderStore(const Clock* clock, const Limits& limits)
    : limits_(limits), inbox_(clock, limits), feed_(limits.run_events_kept) {
  RegisterSpatialFunctions(&functions_);
}

absl::StatusOr<std::unique_ptr<FolderStore>> FolderStore::Open(const std::string& folder, bool make_new,
                                                               const Clock* clock, const Limits& limits) {
  // A name that was mistyped must not leave a log somewhere.
  const absl::Status found = log::FindLog(folder);
  if (!found.ok() && !make_new) {
    if (absl::IsDataLoss(found)) return found;
    return absl::NotFoundError(
        absl::StrCat("there is no data folder ", folder, "; new='yes' makes one (rdfproc --new)"));
  }
  std::unique_ptr<FolderStore> store(new FolderStore(clock, limits));
  log::SqliteLogOptions options;
  options.snapshots_kept = limits.snapshots_kept;
  auto log = log::SqliteLog::Open(folder, options);
  if (!log.ok()) return log.status();
  store->log_ = *std::move(log);
  auto head = store->log_->Head();
  if (!head.ok()) return head.status();
  if (make_new && head->offset > 0) {
    return absl::FailedPreconditionError(absl::StrCat("new='yes' is for an empty folder, and ", folder,
                                                      " holds ", head->offset,
                                                      " records; leave new away or choose another folder"));
  }
  store->snapshots_ = std::make_unique<SnapshotKeeper>(store->log_.get(), &store->dictionary_, limits);
  Writer::Ports ports;
  ports.inbox = &store->inbox_;
  ports.log = store->log_.get();
  ports.queries = &store->queries_;
  ports.catalog = &store->catalog_;
  ports.feed = &store->feed_;
  ports.snapshots = store->snapshots_.get();
  ports.dictionary = &store->dictionary_;
  ports.functions = &store->functions_;
  ports.limits = limits;
  store->writer_ = std::make_unique<Writer>(ports);
  if (absl::Status status = store->writer_->Recover(nullptr); !status.ok()) return status;
  return store;
}

FolderStore::~FolderStore() {
  inbox_.Close();
  if (writer_thread_.joinable()) writer_thread_.join();
}

absl::StatusOr<std::unique_ptr<redland::QuadStream>> FolderStore::Find(const redland::QuadQuery& query) {
  return redland::FindInVersion(dictionary_, queries_.Newest(), query);
}

absl::StatusOr<uint64_t> FolderStore::Size() {
  return queries_.Newest()->size();
}

absl::StatusOr<std::vector<Term>> FolderStore::Graphs() {
  return redland::GraphsOfVersion(dictionary_, *queries_.Newest());
}

absl::Status FolderStore::Apply(std::vector<QuadOperation> operations) {
  if (!writer_thread_.joinable()) {
    writer_thread_ = std::thread([this] { writer_->Run().IgnoreError(); });  // told to who waits
  }
  WriteBatch batch;
  batch.mode = WriteBatch::Mode::kLoad;
  batch.operations = std::move(operations);
  std::promise<absl::Status> answer;
  inbox_.Push(std::move(batch),
              [&answer](const absl::StatusOr<BatchOutcome>& outcome) { answer.set_value(outcome.status()); });
  return answer.get_future().get();
}

}  // namespace docent::server
