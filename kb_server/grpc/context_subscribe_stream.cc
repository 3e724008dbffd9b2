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
#include "kb_server/grpc/client_of.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/write_pump.h"
#include "kb_server/subscriptions/subscriptions.h"

namespace docent::server {
namespace {

constexpr size_t kUnsettled =
    256;  // queries without an answer, or whose end is not written: beyond, reading pauses
// When so much is in a reply, the rest goes into the next.
constexpr int kPartsInReply = 1000;
constexpr size_t kBytesInMessage = size_t{256} << 10;
constexpr int kRowsInPart = 100;  // in its last part: a large answer takes long to write down

// A query is in line when it may have something to say. Each reply takes one message after the other of those in line,
// so that none waits for another's large answer; while a reply is being written the line grows, by one place a query at
// most.
using SubscribeStreamPump =
    WritePump<grpc::ServerBidiReactor<v1::SubscribeStreamRequest, v1::SubscribeStreamReply>,
              v1::SubscribeStreamReply>;

class SubscribeStreamReactor final : public SubscribeStreamPump {
 public:
  SubscribeStreamReactor(grpc::CallbackServerContext* context, const ServicePorts& ports)
      : SubscribeStreamPump(context, ports.send_budget),
        client_(ClientOf(*context, ports.clients)),
        subscriptions_(*ports.subscriptions) {
    StartSendInitialMetadata();
    StartRead(&request_);
  }

  void OnReadDone(bool ok) override {
    std::shared_ptr<Followed> ended;
    std::shared_ptr<Followed> begun;
    {
      absl::MutexLock lock(&link()->mutex);
      if (!ok) {
        reading_ended_ = true;
        return Advance();
      }
      const uint64_t tag = request_.tag();
      const auto found = followed_.find(tag);
      if (request_.has_begin()) {
        if (found != followed_.end()) return End(Invalid(absl::StrCat("tag ", tag, " is in use")));
        begun = std::make_shared<Followed>(link(), this, tag, request_.begin());
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
    absl::MutexLock lock(&link()->mutex);
    reading_ = false;
    ReadOn();
  }

 private:
  // One of its queries; outlives it. What is not const: with link->mutex held.
  struct Followed final : Subscriber, std::enable_shared_from_this<Followed> {
    Followed(std::shared_ptr<Link> stream, SubscribeStreamReactor* of, uint64_t tag_of_client,
             const v1::SubscribeRequest& request)
        : link(std::move(stream)),
          reactor(of),
          tag(tag_of_client),
          cursor(std::in_place, &of->subscriptions_, request) {}
    void Wake() override {
      absl::MutexLock lock(&link->mutex);
      if (link->pump != nullptr && !ended) reactor->Enqueue(*this);
    }
    void AllWoken() override {
      absl::MutexLock lock(&link->mutex);
      if (link->pump != nullptr) reactor->Advance();
    }
    void Fail(const absl::Status& failure) override {
      absl::MutexLock lock(&link->mutex);
      if (link->pump == nullptr) return;
      reactor->EndQuery(*this, failure);
      reactor->Advance();
    }
    const std::shared_ptr<Link> link;
    SubscribeStreamReactor* const reactor;  // while link->pump is not null
    const uint64_t tag;
    std::optional<AnswerCursor> cursor;  // until it has ended
    bool in_line = false;
    bool ended = false;
    absl::Status status;  // why
  };

  static grpc::Status Invalid(const std::string& message) {
    return {grpc::StatusCode::INVALID_ARGUMENT, message};
  }

  // Its callback may outlive the stream.
  void Open(const std::shared_ptr<Followed>& followed, const SubscribedQuery& query) {
    subscriptions_.Open(
        query, followed,
        [followed](const absl::StatusOr<SubscriptionAnswerPtr>& answer) {
          absl::MutexLock lock(&followed->link->mutex);
          const bool there = followed->link->pump != nullptr;
          if (there) followed->reactor->Begin(*followed, answer);
          return there && !followed->ended;
        },
        client_);
  }

  // Everything below: with the mutex held, but OnEnd.
  void Begin(Followed& followed, const absl::StatusOr<SubscriptionAnswerPtr>& answer) {
    if (ended()) return;
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
    if (reading_ || ended() || reading_ended_ || unsettled_ >= kUnsettled) return;
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

  bool FillNext(v1::SubscribeStreamReply* message, grpc::WriteOptions*) override {
    bool full = false;
    for (size_t bytes = 0; !line_.empty() && !full;) {
      const std::shared_ptr<Followed> followed = std::move(line_.front());
      line_.pop_front();
      followed->in_line = false;
      if (!WritePart(*followed, message)) continue;
      const v1::SubscribeStreamReply::Part& part = message->parts(message->parts_size() - 1);
      bytes += part.ByteSizeLong();
      full = bytes >= kBytesInMessage || message->parts_size() == kPartsInReply ||
             part.reply().appeared_size() + part.reply().disappeared_size() >= kRowsInPart;
    }
    return message->parts_size() > 0;
  }
  void OnIdle() override {
    if (reading_ended_ && followed_.empty()) End(grpc::Status::OK);
  }
  void OnEnd() override {
    for (const auto& [tag, followed] : followed_) subscriptions_.Close(followed);
  }

  // False: it has nothing to say now.
  bool WritePart(Followed& followed, v1::SubscribeStreamReply* message) {
    v1::SubscribeStreamReply::Part* part = message->add_parts();
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
    message->mutable_parts()->RemoveLast();
    if (due != absl::InfiniteFuture()) subscriptions_.WakeAt(due, followed.weak_from_this());
    return false;
  }

  const ClientPtr client_;
  Subscriptions& subscriptions_;
  v1::SubscribeStreamRequest request_;
  absl::flat_hash_map<uint64_t, std::shared_ptr<Followed>>
      followed_;  // by tag, until its last part is written
  std::deque<std::shared_ptr<Followed>> line_;
  size_t unsettled_ = 0;
  bool reading_ = true;
  bool reading_ended_ = false;
};

}  // namespace

grpc::ServerBidiReactor<v1::SubscribeStreamRequest, v1::SubscribeStreamReply>*
ContextService::SubscribeStream(grpc::CallbackServerContext* context) {
  return new SubscribeStreamReactor(context, ports_);
}

}  // namespace docent::server
