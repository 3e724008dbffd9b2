#include "kb_server/writer/history.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "graph/base/overload.h"
#include "graph/log/record_codec.h"
#include "graph/store/graph_writer.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/writer/recovery.h"

namespace docent::server {
namespace {

constexpr absl::Duration kPoll = absl::Milliseconds(50);

std::string Show(TimeMicros time_us) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%E*SZ", absl::FromUnixMicros(time_us), absl::UTCTimeZone());
}

}  // namespace

History::History(log::ContextLog* log, const QueryPort* queries, const Dictionary* dictionary,
                 const sparql::FunctionRegistry* functions, const Limits& limits)
    : log_(log), queries_(queries), dictionary_(dictionary), functions_(functions), limits_(limits) {}

size_t History::Kept::DeltaBytes() const {
  size_t bytes = turns.size() * sizeof(Step);
  for (const Step& turn : turns) bytes += turn.delta.size() * sizeof(Quad);
  return bytes;
}

GraphVersionPtr History::Kept::At(uint64_t offset) const {
  if (offset == last()) return version;
  GraphWriter writer(version);
  for (uint64_t revision = last(); revision > offset; --revision) {
    const Delta& delta = turns[revision - first()].delta;
    writer.Apply(delta.removed, delta.added);
  }
  return writer.Freeze(Revision(offset));
}

size_t History::Bytes() const {
  if (kept_.empty()) return 0;
  return kept_.back()->version->replaced_bytes() - kept_.front()->version->replaced_bytes() + delta_bytes_;
}

void History::Keep(GraphVersionPtr version, std::vector<Step> turns, std::vector<GraphVersionPtr>* gone) {
  auto kept = std::make_shared<const Kept>(Kept{std::move(version), std::move(turns)});
  std::vector<std::shared_ptr<const Kept>> dropped;  // goes after the lock
  absl::MutexLock lock(&mutex_);
  delta_bytes_ += kept->DeltaBytes();
  kept_.push_back(std::move(kept));
  while (kept_.size() > 1 && Bytes() > limits_.history_bytes) {
    delta_bytes_ -= kept_.front()->DeltaBytes();
    gone->push_back(kept_.front()->version);
    dropped.push_back(std::move(kept_.front()));
    kept_.pop_front();
  }
}

void History::Clear() {
  std::deque<std::shared_ptr<const Kept>> gone;
  absl::MutexLock lock(&mutex_);
  gone.swap(kept_);
  delta_bytes_ = 0;
}

size_t History::kept_versions() const {
  absl::MutexLock lock(&mutex_);
  return kept_.empty() ? 0 : kept_.back()->last() + 1 - kept_.front()->first();
}

size_t History::kept_bytes() const {
  absl::MutexLock lock(&mutex_);
  return Bytes();
}

absl::StatusOr<QueryGraph> History::At(const AsOf& when, Cancellation* cancellation) {
  const GraphVersionPtr newest = queries_->Newest();
  uint64_t offset = 0;
  if (const Revision* revision = std::get_if<Revision>(&when)) {
    offset = revision->value();
  } else {
    const absl::StatusOr<uint64_t> found =
        OffsetAt(std::get<TimeMicros>(when), newest->revision().value(), cancellation);
    if (!found.ok()) return found.status();
    offset = *found;
  }
  if (offset > newest->revision().value()) {
    return absl::OutOfRangeError(
        absl::StrCat("revision ", offset, " is not here yet; the newest is ", newest->revision().value()));
  }
  GraphVersionPtr kept = newest->revision().value() == offset ? newest : FindKept(offset);
  if (kept == nullptr) return MakeAgain(offset, cancellation);
  return QueryGraph{std::shared_ptr<const Dictionary>(std::shared_ptr<void>(), dictionary_), std::move(kept)};
}

GraphVersionPtr History::FindKept(uint64_t offset) const {
  std::shared_ptr<const Kept> kept;
  {
    absl::MutexLock lock(&mutex_);
    const auto found = std::lower_bound(
        kept_.begin(), kept_.end(), offset,
        [](const std::shared_ptr<const Kept>& k, uint64_t asked) { return k->last() < asked; });
    if (found == kept_.end() || offset < (*found)->first()) return nullptr;
    kept = *found;
  }
  return kept->At(offset);
}

std::optional<uint64_t> History::KeptAt(TimeMicros time_us) const {
  absl::MutexLock lock(&mutex_);
  const auto after = std::upper_bound(kept_.begin(), kept_.end(), time_us,
                                      [](TimeMicros asked, const std::shared_ptr<const Kept>& k) {
                                        return asked < k->turns.front().time_us;
                                      });
  if (after == kept_.begin()) return std::nullopt;
  const Kept& kept = **std::prev(after);
  const auto later =
      std::upper_bound(kept.turns.begin(), kept.turns.end(), time_us,
                       [](TimeMicros asked, const Step& turn) { return asked < turn.time_us; });
  return kept.first() + static_cast<uint64_t>(later - kept.turns.begin()) - 1;
}

absl::StatusOr<TimeMicros> History::TimeOf(uint64_t offset) {
  absl::StatusOr<std::vector<log::LogEntry>> entries = log_->Read(offset, 1);
  if (!entries.ok()) return entries.status();
  if (entries->empty()) return absl::DataLossError(absl::StrCat("the log has no record at offset ", offset));
  const absl::StatusOr<log::TurnRecord> record = log::DecodeTurnRecord(offset, entries->front().data);
  if (!record.ok()) return record.status();
  return record->time_us;
}

absl::StatusOr<uint64_t> History::OffsetAt(TimeMicros time_us, uint64_t newest, Cancellation* cancellation) {
  if (const std::optional<uint64_t> kept = KeptAt(time_us)) return std::min(*kept, newest);
  const absl::StatusOr<uint64_t> first = log_->First();
  if (!first.ok()) return first.status();
  // the last record in [first, newest] whose time is not later; times never decrease
  uint64_t low = *first - 1;
  uint64_t high = newest;
  while (low < high) {
    if (absl::Status status = cancellation->Check(); !status.ok()) return status;
    const uint64_t middle = low + (high - low + 1) / 2;
    const absl::StatusOr<TimeMicros> time = TimeOf(middle);
    if (!time.ok()) return time.status();
    if (*time <= time_us)
      low = middle;
    else
      high = middle - 1;
  }
  if (low<*first&& * first> 1) return NoLongerKept(Show(time_us));
  return low;
}

absl::Status History::NoLongerKept(const std::string& what) {
  const absl::StatusOr<uint64_t> first = log_->First();
  const absl::StatusOr<std::vector<uint64_t>> snapshots = log_->SnapshotOffsets();
  if (!first.ok() || !snapshots.ok()) return first.ok() ? snapshots.status() : first.status();
  const auto snapshot = std::lower_bound(snapshots->begin(), snapshots->end(), *first - 1);
  uint64_t oldest = queries_->Newest()->revision().value();
  if (snapshot != snapshots->end()) oldest = std::min(oldest, *snapshot);
  absl::MutexLock lock(&mutex_);
  if (!kept_.empty()) oldest = std::min(oldest, kept_.front()->first());
  return absl::OutOfRangeError(absl::StrCat(
      "the graph as of ", what, " is no longer kept; the oldest revision that is kept is ", oldest));
}

std::shared_ptr<const History::Remade> History::FindRemade(uint64_t offset) {
  for (auto it = remade_.begin(); it != remade_.end(); ++it) {
    if ((*it)->version->revision().value() != offset) continue;
    std::rotate(it, it + 1, remade_.end());
    return remade_.back();
  }
  return nullptr;
}

absl::Status History::MakeRoom() {
  for (auto it = remade_.begin(); it != remade_.end() && remade_.size() >= limits_.as_of_open;) {
    it = it->use_count() == 1 ? remade_.erase(it) : it + 1;
  }
  if (remade_.size() < limits_.as_of_open) return absl::OkStatus();
  return OverloadError(absl::StrCat(
      "other queries read past graphs that were made again from the log; the limit as_of_open is ",
      limits_.as_of_open, "; try again later"));
}

// Others have the place of a query that waits for another one.
absl::Status History::AwaitMade(Cancellation* cancellation) {
  const WorkerPool::Waiting waiting;
  if (!waiting.status().ok()) return waiting.status();
  const auto idle = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return !making_; };
  while (true) {
    if (absl::Status status = cancellation->CheckNow(); !status.ok()) return status;
    absl::MutexLock lock(&mutex_);
    if (mutex_.AwaitWithTimeout(absl::Condition(&idle), kPoll)) return absl::OkStatus();
  }
}

absl::StatusOr<QueryGraph> History::MakeAgain(uint64_t offset, Cancellation* cancellation) {
  const auto answer = [](const std::shared_ptr<const Remade>& remade) {
    return QueryGraph{std::shared_ptr<const Dictionary>(remade, &remade->dictionary),
                      GraphVersionPtr(remade, remade->version.get())};
  };
  while (true) {
    {
      absl::MutexLock lock(&mutex_);
      if (const auto known = FindRemade(offset)) return answer(known);
      if (!making_) {
        if (absl::Status status = MakeRoom(); !status.ok()) return status;
        making_ = true;
        break;
      }
    }
    if (absl::Status status = AwaitMade(cancellation); !status.ok()) return status;
  }
  absl::StatusOr<std::shared_ptr<const Remade>> remade = Replay(offset, cancellation);
  absl::MutexLock lock(&mutex_);
  making_ = false;
  if (!remade.ok()) return remade.status();
  remade_.push_back(*remade);
  return answer(*remade);
}

absl::StatusOr<std::shared_ptr<const History::Remade>> History::Replay(uint64_t offset,
                                                                       Cancellation* cancellation) {
  const absl::StatusOr<uint64_t> first = log_->First();
  const absl::StatusOr<std::vector<uint64_t>> snapshots = log_->SnapshotOffsets();
  if (!first.ok() || !snapshots.ok()) return first.ok() ? snapshots.status() : first.status();
  const auto after = std::upper_bound(snapshots->begin(), snapshots->end(), offset);
  const uint64_t base = after == snapshots->begin() ? 0 : *std::prev(after);
  if (base + 1 < *first) return NoLongerKept(absl::StrCat("revision ", offset));
  if (offset - base > limits_.as_of_records) {
    return absl::ResourceExhaustedError(absl::StrCat("revision ", offset, " lies ", offset - base,
                                                     " records after the snapshot at ", base,
                                                     "; the limit as_of_records is ", limits_.as_of_records));
  }
  auto remade = std::make_shared<Remade>();
  absl::StatusOr<RestoredState> start = FindStart(log_, offset, &remade->dictionary, functions_, limits_);
  if (!start.ok()) return start.status();
  const absl::Status status =
      ReplayTurns(log_, start->offset + 1, offset, start->stages.get(),
                  [cancellation](const TurnResult&, size_t) { return cancellation->Check(); });
  if (!status.ok()) return status;
  remade->version = start->stages->writer.Freeze(Revision(offset));
  return std::shared_ptr<const Remade>(std::move(remade));
}

}  // namespace docent::server
