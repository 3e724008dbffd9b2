#include "kb_server/door/worker_pool.h"

#include <time.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/overload.h"

namespace docent::server {
namespace {

constexpr absl::Duration kLookAtQueue = absl::Milliseconds(20);
constexpr absl::Duration kLookAtCancellation = absl::Milliseconds(50);
constexpr int kOverdue = 4;  // times the short time, by the clock

absl::Duration ThreadTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return absl::DurationFromTimespec(time);
}

}  // namespace

thread_local WorkerPool::Piece* WorkerPool::current_ = nullptr;

WorkerPoolLimits WorkerPoolLimitsOf(const Limits& limits) {
  return {limits.queries_running,
          limits.queries_open,
          limits.queries_waiting,
          limits.queries_short,
          absl::Milliseconds(limits.query_short_ms),
          absl::Milliseconds(limits.crowded_client_ms)};
}

WorkerPool::~WorkerPool() {
  while (true) {
    std::vector<std::thread> threads;
    {
      absl::MutexLock lock(&mutex_);
      closed_ = true;
      threads.swap(threads_);  // those that end may start others for what is still queued
      if (watch_.joinable()) threads.push_back(std::move(watch_));
    }
    if (threads.empty()) return;
    for (std::thread& thread : threads) thread.join();
  }
}

absl::Status WorkerPool::Submit(std::function<void()> work, Patience patience) {
  absl::MutexLock lock(&mutex_);
  if (closed_ || queue_.size() >= limits_.queue) {
    return OverloadError(absl::StrCat("too much work waits: the limit queries_waiting is ", limits_.queue,
                                      "; nothing was done, try again"));
  }
  if ((patience.over || limits_.short_running > 0) && !watch_.joinable()) {
    watch_ = std::thread([this] { WatchQueue(); });
  }
  queue_.push_back({std::move(work), std::move(patience), absl::Now()});
  StartThreadIfNeeded();
  return absl::OkStatus();
}

void WorkerPool::WatchQueue() {
  while (true) {
    std::vector<Queued> late;  // with the work that never began, which may be large
    {
      absl::MutexLock lock(&mutex_);
      mutex_.Await(absl::Condition(this, &WorkerPool::ClosedOrWaited));
      if (closed_) return;  // what is queued still runs
      mutex_.AwaitWithTimeout(absl::Condition(&closed_), kLookAtQueue);
      MoveOverdue();
      late = TakeLate();
    }
    for (const Queued& queued : late) queued.patience.over();
  }
}

std::vector<WorkerPool::Queued> WorkerPool::TakeLate() {
  std::vector<Queued> late;
  const absl::Time now = absl::Now();
  std::erase_if(queue_, [&](Queued& queued) {
    if (queued.patience.until > now || !queued.patience.over) return false;
    late.push_back(std::move(queued));
    return true;
  });
  return late;
}

void WorkerPool::MoveOverdue() {
  if (queue_.empty() || limits_.short_running == 0 || HasShortPlace()) return;
  const absl::Time overdue = absl::Now() - kOverdue * limits_.short_time;
  for (Piece* piece : pieces_) {
    if (running_ >= limits_.running + limits_.short_running) break;
    if (!piece->placed || !piece->is_short || piece->begun > overdue) continue;
    piece->is_short = false;
    --short_;
    ++running_;
  }
  StartThreadIfNeeded();
}

WorkerPool::SharedWork::SharedWork(WorkerPool* pool, Cancellation* cancellation)
    : cancellation_(*cancellation) {
  cancellation_.OnLook([pool](const Cancellation& looking) { pool->HoldUp(looking); });
}

void WorkerPool::HoldUp(const Cancellation& cancellation) {
  Piece* const piece = current_;
  if (piece == nullptr || piece->pool != this || limits_.short_running == 0) return;
  if (ThreadTime() - piece->processor_time < limits_.short_time) return;
  absl::MutexLock lock(&mutex_);
  if (!piece->is_short) return;
  LeavePlace(piece);
  piece->is_short = false;
  AwaitPlace(piece, &cancellation);
}

void WorkerPool::LeavePlace(Piece* piece) {
  piece->placed = false;
  --(piece->is_short ? short_ : running_);
  StartThreadIfNeeded();
}

bool WorkerPool::CanGoOn(const Piece* piece) const {
  return (piece->is_short && HasShortPlace()) || (HasPlace() && line_.front() == piece);
}

void WorkerPool::AwaitPlace(Piece* piece, const Cancellation* cancellation) {
  line_.push_back(piece);
  const auto ready = [this, piece]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return CanGoOn(piece); };
  while (!mutex_.AwaitWithTimeout(absl::Condition(&ready), kLookAtCancellation)) {
    if (cancellation != nullptr && cancellation->IsOver()) break;  // it ends by itself now
  }
  piece->is_short = piece->is_short && HasShortPlace();
  piece->placed = true;
  ++(piece->is_short ? short_ : running_);
  line_.erase(std::find(line_.begin(), line_.end(), piece));
  StartThreadIfNeeded();
}

WorkerPool::Waiting::Waiting(WorkerPool* pool, What what) : pool_(*pool) {
  if (current_ == nullptr) return;  // not on a thread of the pool's
  absl::MutexLock lock(&pool_.mutex_);
  if (what == What::kClient) current_->client_since = absl::Now();
  pool_.LeavePlace(current_);
}

WorkerPool::Waiting::~Waiting() {
  if (current_ == nullptr) return;
  absl::MutexLock lock(&pool_.mutex_);
  Piece& piece = *current_;
  if (piece.client_since != absl::InfiniteFuture()) {
    piece.client_time += absl::Now() - std::exchange(piece.client_since, absl::InfiniteFuture());
  }
  pool_.AwaitPlace(&piece, nullptr);
}

bool WorkerPool::Waiting::Crowded() {
  if (current_ == nullptr) return false;
  absl::MutexLock lock(&pool_.mutex_);
  const absl::Time now = absl::Now();
  const std::deque<Queued>& queue = pool_.queue_;
  const bool crowded = !queue.empty() && pool_.idle_ == 0 &&
                       pool_.threads_.size() >= static_cast<size_t>(pool_.limits_.open) &&
                       now - queue.front().since >= pool_.limits_.crowded_time;
  if (!crowded) return false;
  const auto waited = [now](const Piece& piece) {
    const bool waits = piece.client_since != absl::InfiniteFuture();
    return piece.client_time + (waits ? now - piece.client_since : absl::ZeroDuration());
  };
  const absl::Duration mine = waited(*current_);
  const bool first = std::all_of(pool_.pieces_.begin(), pool_.pieces_.end(), [&](const Piece* piece) {
    const bool waits = piece->client_since != absl::InfiniteFuture();
    return piece == current_ || (!piece->crowded_out && (!waits || waited(*piece) <= mine));
  });
  current_->crowded_out = first && mine >= pool_.limits_.crowded_time;
  return current_->crowded_out;
}

void WorkerPool::StartThreadIfNeeded() {
  if (!CanBegin() || idle_ > 0 || threads_.size() >= static_cast<size_t>(limits_.open)) return;
  ++idle_;  // it is on its way
  threads_.emplace_back([this] { Run(); });
}

void WorkerPool::Run() {
  while (true) {
    Piece piece;
    std::function<void()> work = Take(&piece);
    if (work == nullptr) return;
    current_ = &piece;
    work();
    work = nullptr;  // what it holds goes before its place is free
    current_ = nullptr;
    End(&piece);
  }
}

std::function<void()> WorkerPool::Take(Piece* piece) {
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(this, &WorkerPool::CanBeginOrEnd));
  --idle_;
  if (queue_.empty()) return nullptr;
  std::function<void()> work = std::move(queue_.front().work);
  queue_.pop_front();
  piece->pool = this;
  piece->placed = true;
  piece->is_short = HasShortPlace();
  piece->begun = absl::Now();
  piece->processor_time = ThreadTime();
  ++(piece->is_short ? short_ : running_);
  pieces_.push_back(piece);
  StartThreadIfNeeded();
  return work;
}

void WorkerPool::End(Piece* piece) {
  absl::MutexLock lock(&mutex_);
  --(piece->is_short ? short_ : running_);
  pieces_.erase(std::find(pieces_.begin(), pieces_.end(), piece));
  ++idle_;
}

absl::Status NotBegun(int timeout_ms) {
  return absl::DeadlineExceededError(
      absl::StrCat("it waited for others to end until its limit query_timeout_ms = ", timeout_ms,
                   ", and was not begun; try again"));
}

}  // namespace docent::server
