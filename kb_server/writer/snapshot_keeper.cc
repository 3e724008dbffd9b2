#include "kb_server/writer/snapshot_keeper.h"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

// Below the threads that answer (setpriority(2): on Linux it may be one thread's).
constexpr int kNice = 10;
constexpr std::chrono::milliseconds kDurablePoll{50};

}  // namespace

SnapshotKeeper::SnapshotKeeper(log::ContextLog* log, const Dictionary* dictionary, const Limits& limits)
    : log_(log), dictionary_(dictionary), limits_(limits) {
  thread_ = std::thread([this] {
    pthread_setname_np(pthread_self(), "snapshots");
    setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNice);
    Run();
  });
}

SnapshotKeeper::~SnapshotKeeper() {
  pace_.Hurry();
  {
    absl::MutexLock lock(&mutex_);
    closing_ = true;
  }
  thread_.join();
}

void SnapshotKeeper::Recovered(uint64_t records, uint64_t bytes) {
  records_ = records;
  bytes_ = bytes;
}

void SnapshotKeeper::Appended(uint64_t records, uint64_t bytes) {
  records_ += records;
  bytes_ += bytes;
}

bool SnapshotKeeper::Due() const {
  if (records_ < limits_.snapshot_records && bytes_ < limits_.snapshot_log_bytes) return false;
  // A large graph is not written again for a few records: it would cost more than it saves.
  if (bytes_ < counters_.newest_bytes / 2) return false;
  absl::MutexLock lock(&mutex_);
  return !busy_ && !job_.has_value();
}

void SnapshotKeeper::Take(ServerState state) {
  records_ = 0;
  bytes_ = 0;
  absl::MutexLock lock(&mutex_);
  job_ = std::move(state);
}

void SnapshotKeeper::Discard() {
  absl::MutexLock lock(&mutex_);
  job_.reset();
  discarded_ = busy_;
}

absl::Status SnapshotKeeper::TakeLast(const ServerState& state) {
  pace_.Hurry();
  {
    const auto idle = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return !busy_ && !job_.has_value(); };
    absl::MutexLock lock(&mutex_);
    mutex_.Await(absl::Condition(&idle));
  }
  const absl::StatusOr<std::vector<uint64_t>> offsets = log_->SnapshotOffsets();
  if (!offsets.ok()) return offsets.status();
  if (state.offset == 0 || (!offsets->empty() && offsets->back() == state.offset)) return absl::OkStatus();
  return Write(state, false);
}

void SnapshotKeeper::Run() {
  while (true) {
    std::optional<ServerState> state;
    {
      absl::MutexLock lock(&mutex_);
      mutex_.Await(absl::Condition(this, &SnapshotKeeper::Wanted));
      if (!job_) return;
      state = std::exchange(job_, std::nullopt);
      busy_ = true;
      discarded_ = false;
    }
    const absl::Status status = Write(*state, true);
    if (!status.ok()) {
      ++counters_.failed;
      spdlog::error("no snapshot at offset {}: {}", state->offset, std::string(status.message()));
    }
    state.reset();  // the graph version goes before the next one is asked for
    absl::MutexLock lock(&mutex_);
    busy_ = false;
  }
}

absl::Status SnapshotKeeper::Write(const ServerState& state, bool wait) {
  const auto start = std::chrono::steady_clock::now();
  const absl::StatusOr<std::string> bytes = EncodeState(state, *dictionary_, &pace_);
  if (!bytes.ok()) return bytes.status();
  while (wait) {
    const absl::StatusOr<uint64_t> head = log_->Wait(state.offset - 1, kDurablePoll);
    if (!head.ok()) return head.status();
    absl::MutexLock lock(&mutex_);
    if (discarded_) return absl::AbortedError("its last turns were refused by the log");
    if (*head >= state.offset) break;
  }
  absl::Status status = log_->SnapshotPut(state.offset, *bytes);
  if (!status.ok()) return status;
  ++counters_.written;
  counters_.newest_offset = state.offset;
  counters_.newest_bytes = bytes->size();
  spdlog::info("snapshot at offset {}: {} quads, {} bytes, {} ms", state.offset, state.graph->size(),
               bytes->size(),
               std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start)
                   .count());
  status = Trim();
  if (!status.ok()) spdlog::error("the log was not trimmed: {}", std::string(status.message()));
  return absl::OkStatus();
}

// Records beyond log_bytes_kept go, up to a snapshot from which the rest can be replayed; never beyond the
// second newest. How many bytes a record takes is taken to be the same everywhere.
absl::Status SnapshotKeeper::Trim() {
  const absl::StatusOr<uint64_t> bytes = log_->Bytes();
  if (!bytes.ok()) return bytes.status();
  if (*bytes <= limits_.log_bytes_kept) return absl::OkStatus();
  const absl::StatusOr<uint64_t> first = log_->First();
  if (!first.ok()) return first.status();
  const absl::StatusOr<log::LogHead> head = log_->Head();
  if (!head.ok()) return head.status();
  const double records = static_cast<double>(head->offset - *first + 1);
  const double kept = records * static_cast<double>(limits_.log_bytes_kept) / static_cast<double>(*bytes);
  const uint64_t wanted = head->offset - static_cast<uint64_t>(kept);
  const absl::StatusOr<std::vector<uint64_t>> offsets = log_->SnapshotOffsets();
  if (!offsets.ok()) return offsets.status();
  // With one snapshot alone a damaged byte in it would cost everything.
  if (offsets->size() < 2) return absl::OkStatus();
  uint64_t start = offsets->front();
  for (size_t i = 0; i + 1 < offsets->size() && (*offsets)[i] <= wanted; ++i) start = (*offsets)[i];
  const absl::Status status = log_->SnapshotDrop(start);
  return status.ok() ? log_->Trim(start + 1) : status;
}

}  // namespace docent::server
