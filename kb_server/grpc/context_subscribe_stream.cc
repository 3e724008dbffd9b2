// Context.SubscribeStream: many standing queries of one client on one stream.
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "kb_server/grpc/answer_cursor.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/subscriptions/subscriptions.h"

namespace docent {
namespace {

constexpr size_t kUnsettled =
    256;  // queries without an answer, or whose end is not written: beyond, reading pauses
// When so much is in a reply, the rest goes into the next.
constexpr int kPartsInReply = 1000;
constexpr size_t kBytesInReply = size_t{256} << 10;
constexpr int kRowsInPart = 100;  // in its last part: a large answer takes long to write down

// A query is in line when it may have something to say. Each reply takes one message after the other of those in line,
// so that none waits for another's large answer; while a reply is being written the line grows, by one place a query at
// most.
class SubscribeStreamReactor final
    : public grpc::ServerBidiReactor<v1::SubscribeStreamRequest, v1::SubscribeStreamReply> {
 public:
  explicit SubscribeStreamReactor(Subscriptions* subscriptions)
      : subscriptions_(*subscriptions), link_(std::make_shared<Link>()) {
    link_->reactor = this;
    StartSendInitialMetadata();
    StartRead(&request_);
  }

  void OnReadDone(bool ok) override {
    std::shared_ptr<Followed> ended;
    std::shared_ptr<Followed> begun;
    {
      absl::MutexLock lock(&link_->mutex);
      if (!ok) {
        reading_ended_ = true;
        return Advance();
      }
      const uint64_t tag = request_.tag();
      const auto found = followed_.find(tag);
      if (request_.has_begin()) {
        if (found != followed_.end()) return End(Invalid(absl::StrCat("tag ", tag, " is in use")));
        begun = std::make_shared<Followed>(link_, &subscriptions_, tag, request_.begin());
        followed_.emplace(tag, begun);
        ++unsettled_;
      } else if (!request_.has_end()) {
        return End(Invalid(absl::StrCat("a request for tag ", tag, " neither begins nor ends a query")));
      } else if (found != followed_.end()) {
        ended = found->second;
        EndQuery(*ended, absl::OkStatus());
        Advance();
      }
    }
    if (ended != nullptr) subscriptions_.Close(ended);
    if (begun != nullptr) Open(begun, ToFollowed(request_.begin()));
    absl::MutexLock lock(&link_->mutex);
    reading_ = false;
    ReadOn();
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
    {
      absl::MutexLock lock(&link_->mutex);
      link_->reactor = nullptr;
    }
    for (const auto& [tag, followed] : followed_) subscriptions_.Close(followed);
    delete this;
  }

 private:
  // What others hold of this stream; outlives it.
  struct Link {
    absl::Mutex mutex;
    SubscribeStreamReactor* reactor = nullptr;
  };
  // One of its queries. What is not const: with link->mutex held.
  struct Followed final : Subscriber, std::enable_shared_from_this<Followed> {
    Followed(std::shared_ptr<Link> stream, Subscriptions* subscriptions, uint64_t tag_of_client,
             const v1::SubscribeRequest& request)
        : link(std::move(stream)), tag(tag_of_client), cursor(std::in_place, subscriptions, request) {}
    void Wake() override {
      absl::MutexLock lock(&link->mutex);
      if (link->reactor != nullptr && !ended) link->reactor->Enqueue(*this);
    }
    void AllWoken() override {
      absl::MutexLock lock(&link->mutex);
      if (link->reactor != nullptr) link->reactor->Advance();
    }
    void Fail(const absl::Status& failure) override {
      absl::MutexLock lock(&link->mutex);
      if (link->reactor == nullptr) return;
      link->reactor->EndQuery(*this, failure);
      link->reactor->Advance();
    }
    const std::shared_ptr<Link> link;
    const uint64_t tag;
    std::optional<AnswerCursor> cursor;  // until it has ended
    bool in_line = false;
    bool ended = false;
    absl::Status status;  // why
  };

  static grpc::Status Gone() { return {grpc::StatusCode::CANCELLED, "the client went away"}; }
  static grpc::Status Invalid(const std::string& message) {
    return {grpc::StatusCode::INVALID_ARGUMENT, message};
  }

  // Its callback may outlive the stream.
  void Open(const std::shared_ptr<Followed>& followed, const SubscribedQuery& query) {
    subscriptions_.Open(query, followed, [followed](const absl::StatusOr<SubscriptionAnswerPtr>& answer) {
      absl::MutexLock lock(&followed->link->mutex);
      SubscribeStreamReactor* const stream = followed->link->reactor;
      if (stream != nullptr) stream->Begin(*followed, answer);
      return stream != nullptr && !followed->ended;
    });
  }

  // Everything below: with link_->mutex held.
  void Begin(Followed& followed, const absl::StatusOr<SubscriptionAnswerPtr>& answer) {
    if (ended_) return;
    if (!followed.ended && answer.ok()) {
      followed.cursor->Begin(*answer);
      Enqueue(followed);
    } else {
      EndQuery(followed, answer.status());
    }
    --unsettled_;
    ReadOn();
    Advance();
  }

  void ReadOn() {
    if (reading_ || ended_ || reading_ended_ || unsettled_ >= kUnsettled) return;
    reading_ = true;
    StartRead(&request_);
  }

  // Its last part is in line.
  void EndQuery(Followed& followed, absl::Status status) {
    if (followed.ended) return;
    followed.ended = true;
    followed.status = std::move(status);
    followed.cursor.reset();
    ++unsettled_;
    Enqueue(followed);
  }

  void Enqueue(Followed& followed) {
    if (followed.in_line) return;
    followed.in_line = true;
    line_.push_back(followed.shared_from_this());
  }

  void Advance() {
    if (writing_ || ended_) return;
    message_.Clear();
    bool full = false;
    for (size_t bytes = 0; !line_.empty() && !full;) {
      const std::shared_ptr<Followed> followed = std::move(line_.front());
      line_.pop_front();
      followed->in_line = false;
      if (!WritePart(*followed)) continue;
      const v1::SubscribeStreamReply::Part& part = message_.parts(message_.parts_size() - 1);
      bytes += part.ByteSizeLong();
      full = bytes >= kBytesInReply || message_.parts_size() == kPartsInReply ||
             part.reply().appeared_size() + part.reply().disappeared_size() >= kRowsInPart;
    }
    if (message_.parts_size() > 0) {
      writing_ = true;
      StartWrite(&message_);
    } else if (reading_ended_ && followed_.empty()) {
      End(grpc::Status::OK);
    }
  }

  // False: it has nothing to say now.
  bool WritePart(Followed& followed) {
    v1::SubscribeStreamReply::Part* part = message_.add_parts();
    part->set_tag(followed.tag);
    if (followed.ended) {
      *part->mutable_ended() = ToStreamError(followed.status);
      followed_.erase(followed.tag);
      --unsettled_;
      ReadOn();
      return true;
    }
    absl::Time due;
    if (followed.cursor->Next(part->mutable_reply(), &due)) {
      Enqueue(followed);
      return true;
    }
    message_.mutable_parts()->RemoveLast();
    if (due != absl::InfiniteFuture()) subscriptions_.WakeAt(due, followed.weak_from_this());
    return false;
  }

  // Finishes now, or when the message that is being written is done.
  void End(grpc::Status status) {
    if (ended_) return;
    ended_ = true;
    status_ = std::move(status);
    if (!writing_) Finish(status_);
  }

  Subscriptions& subscriptions_;
  const std::shared_ptr<Link> link_;
  v1::SubscribeStreamRequest request_;
  absl::flat_hash_map<uint64_t, std::shared_ptr<Followed>>
      followed_;  // by tag, until its last part is written
  std::deque<std::shared_ptr<Followed>> line_;
  size_t unsettled_ = 0;
  bool reading_ = true;
  bool reading_ended_ = false;
  v1::SubscribeStreamReply message_;
  bool writing_ = false;
  bool ended_ = false;
  grpc::Status status_;
};

}  // namespace

grpc::ServerBidiReactor<v1::SubscribeStreamRequest, v1::SubscribeStreamReply>*
ContextService::SubscribeStream(grpc::CallbackServerContext*) {
  return new SubscribeStreamReactor(ports_.subscriptions);
}

}  // namespace docent
