#include "kb_server/door/worker_pool.h"

#include <time.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/overload.h"
#include "graph/base/waiting_limits.h"

namespace docent::server {
namespace {

constexpr absl::Duration kLookAtQueue = absl::Milliseconds(20);
constexpr absl::Duration kSlice = absl::Milliseconds(2);  // of a processor, before a place is given up
constexpr int kOverdue = 4;                               // times the short time, by the clock
constexpr size_t kTimesFree = 3;  // a client may have so many times what is free of all

absl::Duration ThreadTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return absl::DurationFromTimespec(time);
}

// Whether a client that has `has` of all, `taken` of `limit`, may have one more.
bool MayHaveMore(const Client* client, size_t has, size_t taken, size_t limit) {
  return taken < limit && (client == nullptr || has < kTimesFree * (limit - taken));
}

absl::Status NotBegun() {
  return absl::DeadlineExceededError(
      "it waited for others to end until its time limit, query_timeout_ms or less, and was not begun; try "
      "again");
}

absl::Status Stopped() {
  return absl::UnavailableError("the server stops; nothing was done, try again");
}

}  // namespace

thread_local WorkerPool::Piece* WorkerPool::current_ = nullptr;

WorkerPoolLimits WorkerPoolLimitsOf(const Limits& limits) {
  return {limits.queries_running,
          limits.queries_open,
          limits.queries_waiting,
          limits.queries_short,
          absl::Milliseconds(limits.query_short_ms),
          absl::Milliseconds(limits.crowded_client_ms),
          kWaitingLimits.queries_stalled,
          kWaitingLimits.queries_first};
}

WorkerPool::~WorkerPool() {
  Stop();
  std::vector<std::thread> threads;
  {
    absl::MutexLock lock(&mutex_);
    threads.swap(threads_);  // no more are started
    if (watch_.joinable()) threads.push_back(std::move(watch_));
  }
  for (std::thread& thread : threads) thread.join();
}

void WorkerPool::Stop() {
  std::vector<Work> refused;
  {
    absl::MutexLock lock(&mutex_);
    closed_ = true;
    for (Starting& starting : starting_) refused.push_back(std::move(starting.work));
    for (auto& [client, work] : clients_) {
      for (Queued& queued : work->queue) refused.push_back(std::move(queued.work));
      work->queue.clear();
    }
    starting_.clear();
    queued_ = 0;
    LetGoEnded();
    work_.SignalAll();
    waiting_.SignalAll();
    closing_.SignalAll();
    for (const Piece* piece : pieces_) {
      if (piece->cancellation != nullptr) piece->cancellation->Cancel();
    }
  }
  for (const Work& work : refused) work.refuse(Stopped());
}

void WorkerPool::Submit(Work work) {
  absl::Status refusal;
  {
    absl::MutexLock lock(&mutex_);
    const Client* const client = work.client.get();
    const auto known = clients_.find(client);
    const size_t has = known == clients_.end() ? 0 : known->second->queue.size();
    if (closed_) {
      refusal = Stopped();
    } else if (!MayHaveMore(client, has, queued_, limits_.queue)) {
      refusal = OverloadError(
          absl::StrCat(queued_ < limits_.queue ? "too much work of this client waits" : "too much work waits",
                       ": the limit queries_waiting is ", limits_.queue, "; nothing was done, try again"));
    } else {
      if (!watch_.joinable()) watch_ = std::thread([this] { Watch(); });
      std::unique_ptr<ClientWork>& of_client = clients_[client];
      if (of_client == nullptr) of_client = std::make_unique<ClientWork>();
      of_client->queue.push_back({std::move(work), absl::Now(), ++last_number_});
      ++queued_;
      shares_.Enter(client);
      Dispatch();
      if (queued_ > 0) waiting_.Signal();
      return;
    }
  }
  work.refuse(refusal);
}

void WorkerPool::Watch() {
  while (true) {
    std::vector<Queued> late;  // with the work that never began, which may be large
    {
      absl::MutexLock lock(&mutex_);
      while (!closed_ && !IsWaitedFor()) waiting_.Wait(&mutex_);
      const absl::Time next = absl::Now() + kLookAtQueue;
      while (!closed_ && absl::Now() < next) closing_.WaitWithDeadline(&mutex_, next);
      if (closed_) return;
      LetGoEnded();
      MoveOverdue();
      late = TakeLate();
    }
    for (const Queued& queued : late) queued.work.refuse(NotBegun());
  }
}

std::vector<WorkerPool::Queued> WorkerPool::TakeLate() {
  std::vector<Queued> late;
  const absl::Time now = absl::Now();
  for (auto& [client, work] : clients_) {
    std::erase_if(work->queue, [&](Queued& queued) {
      if (queued.work.until > now) return false;
      late.push_back(std::move(queued));
      return true;
    });
  }
  queued_ -= late.size();
  for (const Queued& queued : late) {
    shares_.Leave(queued.work.client.get());
    Forget(queued.work.client.get());
  }
  return late;
}

void WorkerPool::Forget(const Client* client) {
  const auto found = clients_.find(client);
  if (found != clients_.end() && found->second->queue.empty() && found->second->begun == 0)
    clients_.erase(found);
}

void WorkerPool::MoveOverdue() {
  if (limits_.short_running == 0 || HasShortPlace()) return;
  const absl::Time overdue = absl::Now() - kOverdue * limits_.short_time;
  for (Piece* piece : pieces_) {
    if (running_ >= limits_.running + limits_.short_running) break;
    if (!piece->placed || !piece->is_short || piece->begun > overdue) continue;
    piece->is_short = false;
    --short_;
    ++running_;
  }
  Dispatch();
}

WorkerPool::SharedWork::SharedWork(WorkerPool* pool, Cancellation* cancellation)
    : cancellation_(*cancellation) {
  cancellation_.OnLook([pool](const Cancellation& looking) { pool->HoldUp(looking); });
}

void WorkerPool::HoldUp(const Cancellation& cancellation) {
  Piece* const piece = current_;
  if (piece == nullptr || piece->pool != this || ThreadTime() - piece->processor_time < kSlice) return;
  absl::MutexLock lock(&mutex_);
  if (!piece->placed) return;
  Charge(piece);
  if ((!piece->is_short || IsShort(*piece)) && !IsOutranked(*piece)) return;
  LeavePlace(piece);
  AwaitPlace(piece, &cancellation);
}

void WorkerPool::Charge(Piece* piece) {
  const absl::Duration now = ThreadTime();
  const absl::Duration used = now - std::exchange(piece->processor_time, now);
  piece->used += used;
  shares_.Charge(piece->client.get(), used);
}

bool WorkerPool::IsOutranked(const Piece& piece) {
  const absl::Duration mine = shares_.TimeOf(piece.client.get());
  if (const Piece* other = FirstInLine(false); other != nullptr && shares_.TimeOf(other->client.get()) < mine)
    return true;
  const ClientWork* queued = FirstQueued();
  return queued != nullptr && shares_.TimeOf(queued->queue.front().work.client.get()) < mine;
}

void WorkerPool::LeavePlace(Piece* piece) {
  piece->placed = false;
  --(piece->is_short ? short_ : running_);
  Dispatch();
}

void WorkerPool::AwaitPlace(Piece* piece, const Cancellation* cancellation) {
  piece->held = cancellation;
  line_.push_back(piece);
  Dispatch();
  if (closed_) LetGoEnded();
  if (!piece->placed) waiting_.Signal();
  while (!piece->placed) piece->goes_on.Wait(&mutex_);
}

void WorkerPool::LetGoEnded() {
  for (Piece* piece : std::vector<Piece*>(line_.begin(), line_.end())) {
    if (closed_ || (piece->held != nullptr && piece->held->IsOver())) GoOn(piece, /*is_short=*/false);
  }
}

void WorkerPool::GoOn(Piece* piece, bool is_short) {
  line_.erase(std::find(line_.begin(), line_.end(), piece));
  piece->is_short = is_short;
  piece->placed = true;
  ++(is_short ? short_ : running_);
  piece->goes_on.Signal();
}

WorkerPool::Piece* WorkerPool::FirstInLine(bool short_only) const {
  Piece* first = nullptr;
  absl::Duration least = absl::InfiniteDuration();
  for (Piece* piece : line_) {
    const absl::Duration time = shares_.TimeOf(piece->client.get());
    if (time >= least || (short_only && !IsShort(*piece))) continue;
    first = piece;
    least = time;
  }
  return first;
}

WorkerPool::ClientWork* WorkerPool::FirstQueued() {
  const size_t open = static_cast<size_t>(limits_.open);
  const size_t begun = pieces_.size() + starting_.size();
  const bool first_only = begun >= open;
  if (queued_ == 0 || begun >= open + static_cast<size_t>(limits_.first)) return nullptr;
  ClientWork* first = nullptr;
  absl::Duration least = absl::InfiniteDuration();
  for (const auto& [client, work] : clients_) {
    if (work->queue.empty()) continue;
    if (first_only ? work->begun > 0 : !MayHaveMore(client, work->begun, begun, open)) continue;
    const absl::Duration time = shares_.TimeOf(client);
    const bool older =
        first != nullptr && time == least && work->queue.front().number < first->queue.front().number;
    if (time >= least && !older) continue;
    first = work.get();
    least = time;
  }
  return first;
}

void WorkerPool::Dispatch() {
  while (!closed_ && (HasPlace() || HasShortPlace())) {
    Piece* const piece = FirstInLine(!HasPlace());
    ClientWork* const queued = FirstQueued();
    if (piece == nullptr && queued == nullptr) return;
    const bool begins =
        queued != nullptr && (piece == nullptr || shares_.TimeOf(queued->queue.front().work.client.get()) <
                                                      shares_.TimeOf(piece->client.get()));
    if (begins) {
      Begin(queued);
      continue;
    }
    GoOn(piece, /*is_short=*/!HasPlace());
  }
}

void WorkerPool::Begin(ClientWork* client) {
  const bool is_short = HasShortPlace();
  ++(is_short ? short_ : running_);
  starting_.push_back({std::move(client->queue.front().work), is_short});
  client->queue.pop_front();
  ++client->begun;
  --queued_;
  if (idle_ >= starting_.size()) return work_.Signal();
  ++idle_;
  threads_.emplace_back([this] { Run(); });
}

WorkerPool::Waiting::Waiting(What what) : what_(what), piece_(current_) {
  if (piece_ == nullptr) return;
  WorkerPool& pool = *piece_->pool;
  absl::MutexLock lock(&pool.mutex_);
  if (what == What::kOther && pool.stalled_ >= pool.limits_.stalled) {
    status_ = OverloadError(
        absl::StrCat("too many wait for other servers or past graphs: the limit queries_stalled is ",
                     pool.limits_.stalled, "; try again later"));
    return;
  }
  if (what == What::kClient) piece_->client_since = absl::Now();
  if (what == What::kOther) ++pool.stalled_;
  pool.Charge(piece_);
  pool.shares_.Leave(piece_->client.get());
  pool.LeavePlace(piece_);
}

WorkerPool::Waiting::~Waiting() {
  if (piece_ == nullptr || !status_.ok()) return;
  WorkerPool& pool = *piece_->pool;
  absl::MutexLock lock(&pool.mutex_);
  if (what_ == What::kOther) --pool.stalled_;
  if (what_ == What::kClient)
    piece_->client_time += absl::Now() - std::exchange(piece_->client_since, absl::InfiniteFuture());
  pool.shares_.Enter(piece_->client.get());
  pool.Charge(piece_);
  pool.AwaitPlace(piece_, piece_->cancellation.get());
}

absl::Time WorkerPool::OldestQueued() const {
  absl::Time oldest = absl::InfiniteFuture();
  for (const auto& [client, work] : clients_) {
    if (!work->queue.empty()) oldest = std::min(oldest, work->queue.front().since);
  }
  return oldest;
}

bool WorkerPool::Waiting::Crowded() {
  if (piece_ == nullptr) return false;
  WorkerPool& pool = *piece_->pool;
  absl::MutexLock lock(&pool.mutex_);
  if (pool.closed_) return true;
  const absl::Time now = absl::Now();
  const absl::Duration least = pool.limits_.crowded_time;
  const bool crowded =
      pool.pieces_.size() >= static_cast<size_t>(pool.limits_.open) && now - pool.OldestQueued() >= least;
  if (!crowded) return false;
  const auto waited = [now](const Piece& piece) {
    const bool waits = piece.client_since != absl::InfiniteFuture();
    return piece.client_time + (waits ? now - piece.client_since : absl::ZeroDuration());
  };
  const absl::Duration mine = waited(*piece_);
  const bool first = std::all_of(pool.pieces_.begin(), pool.pieces_.end(), [&](const Piece* piece) {
    const bool waits = piece->client_since != absl::InfiniteFuture();
    return piece == piece_ || (!piece->crowded_out && (!waits || waited(*piece) <= mine));
  });
  piece_->crowded_out = first && mine >= least;
  return piece_->crowded_out;
}

void WorkerPool::Run() {
  while (true) {
    Piece piece;
    std::function<void()> run = Take(&piece);
    if (run == nullptr) return;
    current_ = &piece;
    run();
    run = nullptr;  // what it holds goes before its place is free
    current_ = nullptr;
    End(&piece);
  }
}

std::function<void()> WorkerPool::Take(Piece* piece) {
  absl::MutexLock lock(&mutex_);
  while (!closed_ && starting_.empty()) work_.Wait(&mutex_);
  --idle_;
  if (starting_.empty()) return nullptr;
  Starting next = std::move(starting_.front());
  starting_.pop_front();
  piece->pool = this;
  piece->client = std::move(next.work.client);
  piece->cancellation = std::move(next.work.cancellation);
  piece->placed = true;
  piece->is_short = next.is_short;
  piece->begun = absl::Now();
  piece->processor_time = ThreadTime();
  pieces_.push_back(piece);
  return std::move(next.work.run);
}

void WorkerPool::End(Piece* piece) {
  absl::MutexLock lock(&mutex_);
  const Client* const client = piece->client.get();
  Charge(piece);
  shares_.Leave(client);
  --(piece->is_short ? short_ : running_);
  pieces_.erase(std::find(pieces_.begin(), pieces_.end(), piece));
  --clients_.at(client)->begun;
  Forget(client);
  ++idle_;
  Dispatch();
}

WorkerPool::Load WorkerPool::load() const {
  absl::MutexLock lock(&mutex_);
  return {running_, short_, line_.size(), queued_, pieces_.size(), threads_.size(), shares_.active()};
}

}  // namespace docent::server
