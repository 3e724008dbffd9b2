#include "kb_server/grpc/answer_cursor.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/time/clock.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {
namespace {

// Of one reply; what is more goes into the next.
constexpr size_t kRowsInReply = 500;
constexpr size_t kBytesInReply = size_t{1} << 20;

void ToProto(const CountedRow& row, v1::CountedRow* out) {
  for (const std::optional<Term>& value : row.values) {
    v1::Term* term = out->mutable_row()->add_values();
    if (value) ToProto(*value, term);
  }
  out->set_count(row.count);
}

}  // namespace

SubscribedQuery ToFollowed(const v1::SubscribeRequest& request) {
  return {request.query(), TimeMicros{request.at_least_ms()} * 1000};
}

void AnswerCursor::Begin(SubscriptionAnswerPtr answer) {
  answer_ = std::move(answer);
  reset_ = !Resume(std::exchange(resume_, {}));
}

bool AnswerCursor::Next(v1::SubscribeReply* reply, absl::Time* due) {
  *due = absl::InfiniteFuture();
  if (answer_ == nullptr || (current_ == nullptr && !TakeNext(due))) return false;
  Write(reply);
  return true;
}

// "EPOCH.ANSWER.CHANGE". True: the client goes on after that change.
bool AnswerCursor::Resume(const std::string& token) {
  const std::vector<std::string> parts = absl::StrSplit(token, '.');
  uint64_t answer = 0, number = 0;
  if (parts.size() != 3 || parts[0] != subscriptions_.epoch() || !absl::SimpleAtoi(parts[1], &answer) ||
      !absl::SimpleAtoi(parts[2], &number) || answer != answer_->id() || number > answer_->newest() ||
      !answer_->Get(number + 1).ok())
    return false;
  position_ = number;
  return true;
}

std::string AnswerCursor::Token(uint64_t number) const {
  return absl::StrCat(subscriptions_.epoch(), ".", answer_->id(), ".", number);
}

bool AnswerCursor::TakeNext(absl::Time* due) {
  if (reset_) {
    current_ = answer_->Whole();
    return true;
  }
  auto next = answer_->Get(position_ + 1);
  if (next.ok() && *next == nullptr) return false;
  if (interval_ > absl::ZeroDuration()) {
    const absl::Time free = last_sent_ + interval_;
    if (absl::Now() < free) {
      if (told_due_ != free) *due = told_due_ = free;
      return false;
    }
    next = answer_->Sum(position_ + 1);
  }
  if (!next.ok()) {
    ++subscriptions_.counters().resets;
    reset_ = true;
    current_ = answer_->Whole();
    return true;
  }
  if (interval_ > absl::ZeroDuration()) {
    const bool nothing = answer_->is_boolean() ? (*next)->boolean == last_boolean_ && told_boolean_
                                               : (*next)->appeared.empty() && (*next)->disappeared.empty();
    if (nothing) {
      position_ = (*next)->number;
      return false;
    }
  }
  current_ = *next;
  return true;
}

// The next part of the current change.
void AnswerCursor::Write(v1::SubscribeReply* reply) {
  const size_t appeared = current_->appeared.size();
  const size_t all = appeared + current_->disappeared.size();
  const bool first = offset_ == 0;
  if (first && reset_) reply->set_warning(answer_->warning());
  if (first && reset_ && !answer_->is_boolean()) {
    for (const std::string& name : answer_->variables()) reply->add_variables(name);
  }
  const size_t end = std::min(all, offset_ + kRowsInReply);
  for (size_t bytes = 0; offset_ < end && bytes < kBytesInReply; ++offset_) {
    const bool comes = offset_ < appeared;
    v1::CountedRow* row = comes ? reply->add_appeared() : reply->add_disappeared();
    ToProto(comes ? current_->appeared[offset_] : current_->disappeared[offset_ - appeared], row);
    bytes += row->ByteSizeLong();
  }
  const bool whole = offset_ == all;
  reply->set_sequence(++sequence_);
  reply->set_revision(current_->revision.value());
  const bool part = !first || !whole;
  reply->set_id(absl::StrCat(Token(current_->number), reset_ ? ".whole" : "", part ? "#" : "",
                             part ? absl::StrCat(offset_) : ""));
  reply->set_reset(reset_ && first);
  reply->set_more(!whole);
  if (whole) {
    reply->set_resume(Token(current_->number));
  } else if (!reset_) {
    reply->set_resume(Token(position_));
  }
  reply->set_is_boolean(answer_->is_boolean());
  reply->set_boolean(current_->boolean);
  ++subscriptions_.counters().replies;
  if (!whole) return;
  position_ = current_->number;
  last_boolean_ = current_->boolean;
  told_boolean_ = true;
  current_ = nullptr;
  offset_ = 0;
  reset_ = false;
  last_sent_ = absl::Now();
}

}  // namespace docent::server
