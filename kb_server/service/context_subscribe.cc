// Context.Subscribe: the answer of a standing query and its changes, at the client's pace.
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "kb_server/service/convert.h"
#include "kb_server/service/grpc_services.h"
#include "kb_server/service/subscriptions.h"

namespace docent {
namespace {

constexpr size_t kRowsInReply = 500;

void ToProto(const CountedRow& row, v1::CountedRow* out) {
  for (const std::optional<Term>& value : row.values) {
    v1::Term* term = out->mutable_row()->add_values();
    if (value) ToProto(*value, term);
  }
  out->set_count(row.count);
}

// One client: it holds a place in the answer's changes and the one that is being written.
class SubscribeReactor final : public grpc::ServerWriteReactor<v1::SubscribeReply> {
 public:
  SubscribeReactor(Subscriptions* subscriptions, const v1::SubscribeRequest& request)
      : subscriptions_(*subscriptions),
        interval_(absl::Milliseconds(request.min_interval_ms())),
        resume_(request.resume()),
        link_(std::make_shared<Link>()) {
    link_->reactor = this;
    StartSendInitialMetadata();
  }

  void Start(const std::string& query) {
    const std::shared_ptr<Link> link = link_;  // this may be gone before Open returns
    Subscriptions& subscriptions = subscriptions_;
    subscriptions.Open(query, link, [link, &subscriptions](const absl::StatusOr<StandingAnswerPtr>& answer) {
      bool gone = false;
      {
        absl::MutexLock lock(&link->mutex);
        gone = link->reactor == nullptr;
        if (!gone) link->reactor->Begin(answer);
      }
      if (gone) subscriptions.Close(link);
    });
  }

  void OnWriteDone(bool ok) override {
    absl::MutexLock lock(&link_->mutex);
    writing_ = false;
    if (ended_) return Finish(status_);
    if (!ok) return End(Gone());
    Advance();
  }
  void OnCancel() override {
    absl::MutexLock lock(&link_->mutex);
    End(Gone());
  }
  void OnDone() override {
    subscriptions_.Close(link_);
    {
      absl::MutexLock lock(&link_->mutex);
      link_->reactor = nullptr;
    }
    delete this;
  }

 private:
  // What the subscriptions hold of this client; outlives it.
  struct Link final : Follower {
    void Wake() override {
      absl::MutexLock lock(&mutex);
      if (reactor == nullptr) return;
      reactor->alarm_set_ = false;
      reactor->Advance();
    }
    void Fail(const absl::Status& status) override {
      absl::MutexLock lock(&mutex);
      if (reactor != nullptr) reactor->End(ToGrpc(status));
    }
    absl::Mutex mutex;
    SubscribeReactor* reactor = nullptr;
  };

  static grpc::Status Gone() { return {grpc::StatusCode::CANCELLED, "the client went away"}; }

  // Everything below: with link_->mutex held.
  void Begin(const absl::StatusOr<StandingAnswerPtr>& answer) {
    if (ended_) return;
    if (!answer.ok()) return End(ToGrpc(answer.status()));
    answer_ = *answer;
    if (!resume_.empty() && Resumed()) {
      begun_ = true;
      Advance();
    } else {
      GiveWhole();
    }
  }

  // "EPOCH.ANSWER.CHANGE". True: the client goes on after that change.
  bool Resumed() {
    const std::vector<std::string> parts = absl::StrSplit(resume_, '.');
    uint64_t answer = 0, number = 0;
    if (parts.size() != 3 || parts[0] != subscriptions_.epoch() || !absl::SimpleAtoi(parts[1], &answer) ||
        !absl::SimpleAtoi(parts[2], &number) || answer != answer_->id() || number > answer_->Whole()->number ||
        !answer_->Get(number + 1).ok())
      return false;
    position_ = number;
    return true;
  }

  void GiveWhole() {
    current_ = answer_->Whole();
    reset_ = true;
    begun_ = true;
    WriteNext();
  }

  void Advance() {
    if (answer_ == nullptr || !begun_ || writing_ || ended_) return;
    if (current_ != nullptr) return WriteNext();
    auto next = answer_->Get(position_ + 1);
    if (!next.ok()) {
      ++subscriptions_.counters().resets;
      return GiveWhole();
    }
    if (*next == nullptr) return;
    if (interval_ > absl::ZeroDuration()) {
      const absl::Time due = last_sent_ + interval_;
      if (absl::Now() < due) {
        if (!alarm_set_) subscriptions_.WakeAt(due, link_);
        alarm_set_ = true;
        return;
      }
      next = answer_->Sum(position_ + 1);
      if (!next.ok()) {
        ++subscriptions_.counters().resets;
        return GiveWhole();
      }
      const bool nothing = answer_->is_boolean()
                               ? (*next)->boolean == last_boolean_ && told_boolean_
                               : (*next)->appeared.empty() && (*next)->disappeared.empty();
      if (nothing) {
        position_ = (*next)->number;
        return;
      }
    }
    current_ = *next;
    WriteNext();
  }

  // The next part of the current change.
  void WriteNext() {
    message_.Clear();
    const size_t appeared = current_->appeared.size();
    const size_t all = appeared + current_->disappeared.size();
    const bool first = offset_ == 0;
    if (first && reset_) {
      for (const std::string& name : answer_->variables()) message_.add_variables(name);
    }
    const size_t end = std::min(all, offset_ + kRowsInReply);
    for (; offset_ < end; ++offset_) {
      if (offset_ < appeared) {
        ToProto(current_->appeared[offset_], message_.add_appeared());
      } else {
        ToProto(current_->disappeared[offset_ - appeared], message_.add_disappeared());
      }
    }
    const bool whole = offset_ == all;
    const auto token = [this](uint64_t number) {
      return absl::StrCat(subscriptions_.epoch(), ".", answer_->id(), ".", number);
    };
    message_.set_sequence(++sequence_);
    message_.set_revision(current_->revision.value());
    message_.set_id(absl::StrCat(token(current_->number), reset_ ? ".whole" : "", first && whole ? "" : "#",
                                 first && whole ? "" : absl::StrCat(offset_)));
    message_.set_reset(reset_ && first);
    message_.set_more(!whole);
    if (whole) {
      message_.set_resume(token(current_->number));
    } else if (!reset_) {
      message_.set_resume(token(position_));
    }
    message_.set_is_boolean(answer_->is_boolean());
    message_.set_boolean(current_->boolean);
    if (whole) {
      position_ = current_->number;
      last_boolean_ = current_->boolean;
      told_boolean_ = true;
      current_ = nullptr;
      offset_ = 0;
      reset_ = false;
      last_sent_ = absl::Now();
    }
    ++subscriptions_.counters().replies;
    writing_ = true;
    StartWrite(&message_);
  }

  // Finishes now, or when the message that is being written is done.
  void End(grpc::Status status) {
    if (ended_) return;
    ended_ = true;
    status_ = std::move(status);
    if (!writing_) Finish(status_);
  }

  Subscriptions& subscriptions_;
  const absl::Duration interval_;
  const std::string resume_;
  const std::shared_ptr<Link> link_;
  StandingAnswerPtr answer_;
  bool begun_ = false;
  uint64_t position_ = 0;    // number of the newest change that the client has
  AnswerChangePtr current_;  // being written; null: none
  size_t offset_ = 0;        // of its rows, those that are written
  bool reset_ = false;       // it is the whole answer
  bool last_boolean_ = false;
  bool told_boolean_ = false;
  uint64_t sequence_ = 0;
  absl::Time last_sent_ = absl::InfinitePast();
  bool alarm_set_ = false;
  v1::SubscribeReply message_;
  bool writing_ = false;
  bool ended_ = false;
  grpc::Status status_;
};

}  // namespace

grpc::ServerWriteReactor<v1::SubscribeReply>* ContextService::Subscribe(grpc::CallbackServerContext*,
                                                                        const v1::SubscribeRequest* request) {
  auto* reactor = new SubscribeReactor(ports_.subscriptions, *request);
  reactor->Start(request->query());
  return reactor;
}

}  // namespace docent
