#include "kb_server/http/http_exchange.h"

#include <utility>

#include "absl/time/time.h"

namespace docent::server {
namespace {

constexpr absl::Duration kLookAround = absl::Milliseconds(100);

}  // namespace

HttpAnswer::Progress HttpAnswer::Take() {
  std::vector<std::function<void()>> on_room;
  Progress taken;
  {
    absl::MutexLock lock(&mutex_);
    woken_ = false;
    std::swap(taken, progress_);
    progress_.ended = taken.ended;
    progress_.aborted = taken.aborted;
    on_room.swap(on_room_);
  }
  for (const auto& callback : on_room) callback();
  return taken;
}

void HttpAnswer::OnProgress(std::function<void()> wake) {
  absl::MutexLock lock(&mutex_);
  wake_ = std::move(wake);
  if (begun_) Wake();
}

void HttpAnswer::CountIn(SendBudget::Share* share) {
  absl::MutexLock lock(&mutex_);
  share_ = share;
}

void HttpAnswer::SetGone() {
  std::vector<std::function<void()>> callbacks;
  std::vector<std::function<void()>> dropped;  // after the mutex, which what they hold may need
  {
    absl::MutexLock lock(&mutex_);
    if (gone_) return;
    gone_ = true;
    if (share_ != nullptr) share_->Release(progress_.bytes());
    share_ = nullptr;
    wake_ = nullptr;
    dropped.swap(on_room_);
    if (!progress_.ended) callbacks.swap(on_gone_);
    on_gone_.clear();
  }
  for (const auto& callback : callbacks) callback();
}

void HttpAnswer::Wake() {
  if (woken_ || !wake_) return;
  woken_ = true;
  wake_();
}

HttpExchange::~HttpExchange() {
  bool begun;
  bool ended;
  {
    absl::MutexLock lock(&answer_->mutex_);
    begun = answer_->begun_;
    ended = answer_->progress_.ended;
  }
  if (!begun) Respond(TextResponse(500, "the request was dropped without an answer"));
  if (begun && !ended) Abort();
}

void HttpExchange::Respond(HttpResponse response) {
  absl::MutexLock lock(&answer_->mutex_);
  if (answer_->begun_) return;
  answer_->begun_ = true;
  answer_->Count(response.body.size());
  answer_->progress_.head = std::move(response);
  answer_->progress_.ended = true;
  answer_->on_gone_.clear();
  answer_->Wake();
}

void HttpExchange::Begin(HttpResponse head) {
  absl::MutexLock lock(&answer_->mutex_);
  if (answer_->begun_) return;
  answer_->begun_ = true;
  answer_->Count(head.body.size());
  answer_->progress_.streamed = true;
  answer_->progress_.head = std::move(head);
  answer_->progress_.data = std::move(answer_->progress_.head->body);
  answer_->progress_.head->body.clear();
  answer_->Wake();
}

bool HttpExchange::begun() const {
  absl::MutexLock lock(&answer_->mutex_);
  return answer_->begun_;
}

bool HttpExchange::full() const {
  absl::MutexLock lock(&answer_->mutex_);
  return !answer_->HasRoom();
}

bool HttpExchange::Write(std::string_view piece, const std::function<bool()>& give_up) {
  const absl::Duration patience = give_up ? kLookAround : absl::InfiniteDuration();
  absl::MutexLock lock(&answer_->mutex_);
  while (!answer_->mutex_.AwaitWithTimeout(absl::Condition(answer_.get(), &HttpAnswer::HasRoom), patience)) {
    if (!give_up()) continue;
    answer_->progress_.ended = answer_->progress_.aborted = true;
    answer_->on_gone_.clear();
    answer_->Wake();
    return false;
  }
  if (answer_->gone_ || answer_->progress_.ended) return false;
  answer_->progress_.data.append(piece);
  answer_->Count(piece.size());
  answer_->Wake();
  return true;
}

bool HttpExchange::Push(std::string_view piece) {
  absl::MutexLock lock(&answer_->mutex_);
  if (answer_->gone_ || answer_->progress_.ended) return false;
  answer_->progress_.data.append(piece);
  answer_->Count(piece.size());
  answer_->Wake();
  return true;
}

void HttpExchange::OnRoom(std::function<void()> callback) {
  {
    absl::MutexLock lock(&answer_->mutex_);
    if (!answer_->HasRoom()) {
      answer_->on_room_.push_back(std::move(callback));
      return;
    }
  }
  callback();
}

void HttpExchange::Upgrade(HttpFields headers, std::shared_ptr<HttpUpgradeReader> reader) {
  absl::MutexLock lock(&answer_->mutex_);
  if (answer_->begun_) return;
  answer_->begun_ = true;
  answer_->progress_.streamed = true;
  answer_->progress_.upgraded = std::move(reader);
  HttpResponse& head = answer_->progress_.head.emplace();
  head.status = 101;
  head.content_type.clear();
  head.headers = std::move(headers);
  answer_->Wake();
}

void HttpExchange::End() {
  absl::MutexLock lock(&answer_->mutex_);
  answer_->progress_.ended = true;
  answer_->on_gone_.clear();
  answer_->Wake();
}

void HttpExchange::Abort() {
  absl::MutexLock lock(&answer_->mutex_);
  if (answer_->progress_.ended) return;
  answer_->progress_.ended = true;
  answer_->progress_.aborted = true;
  answer_->on_gone_.clear();
  answer_->Wake();
}

void HttpExchange::OnGone(std::function<void()> callback) {
  {
    absl::MutexLock lock(&answer_->mutex_);
    if (answer_->progress_.ended) return;
    if (!answer_->gone_) {
      answer_->on_gone_.push_back(std::move(callback));
      return;
    }
  }
  callback();
}

}  // namespace docent::server
