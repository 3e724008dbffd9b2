// The two kinds of what a tab follows: a stream of a service, and a read that is asked again when its answer may have changed.
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/fingerprint.h"
#include "graph/base/text.h"
#include "kb_server/connect/connect_error.h"
#include "kb_server/connect/message_codec.h"
#include "kb_server/live/live_session.h"
#include "kb_server/live/resume_point.h"

namespace docent::server {
namespace {

namespace pb = google::protobuf;

constexpr size_t kLargeBytes = 64u << 10;  // beyond, a worker writes the JSON
constexpr absl::Duration kReadTime = absl::Seconds(30);
constexpr double kBytesPerSecond = 2e6;  // of one read that is followed: larger answers come less often

std::string PathOf(const pb::MethodDescriptor& method) {
  return absl::StrCat("/", method.service()->full_name(), "/", method.name());
}

std::unique_ptr<pb::Message> Parse(const pb::Descriptor& type, const std::string& bytes) {
  std::unique_ptr<pb::Message> message(pb::MessageFactory::generated_factory()->GetPrototype(&type)->New());
  if (!message->ParseFromString(bytes)) return nullptr;
  return message;
}

std::string MessageJson(const std::string& id, std::string_view json,
                        const std::optional<std::string>& resume) {
  return Concat("{\"id\":", id, ",\"message\":", json,
                resume ? Concat(",\"resume\":", JsonString(*resume)) : "", "}");
}

grpc::Status ToGrpcStatus(const absl::Status& status) {
  return {static_cast<grpc::StatusCode>(status.code()), std::string(status.message())};
}

void RunWhereThereIsTime(WorkerPool* workers, size_t bytes, Work work) {
  if (workers == nullptr || bytes <= kLargeBytes) return work.run();
  workers->Submit(std::move(work));
}

// What both kinds have: one call at a time, whose sink lets go of the stream when the tab has ended it.
class StreamBase : public LiveStream, public std::enable_shared_from_this<StreamBase> {
 public:
  StreamBase(std::shared_ptr<LiveSession> session, const LiveRequest& request)
      : session_(std::move(session)), id_(request.id), resume_(request.resume), method_(*request.method) {}

  void End() override {
    std::shared_ptr<RpcCall> call;
    {
      absl::MutexLock lock(&mutex_);
      ended_ = true;
      call = call_.lock();
    }
    if (call != nullptr) call->Cancel();
  }

 protected:
  // Sends unless the tab has ended the stream: with the mutex held, so that nothing comes after its end.
  void SendLive(std::string_view json) {
    absl::MutexLock lock(&mutex_);
    if (!ended_) session_->Send(json);
  }
  void EndLive(const grpc::Status& status) {
    {
      absl::MutexLock lock(&mutex_);
      if (std::exchange(ended_, true)) return;
    }
    session_->StreamEnded(this, id_, status);
  }
  void Start(std::string request, absl::Time deadline, std::shared_ptr<RpcSink> sink,
             const std::string& trace = "") {
    const std::shared_ptr<RpcCall> call = session_->ports().calls->Start(
        PathOf(method_), {std::move(request)}, deadline, std::move(sink), session_->client(), trace);
    bool ended = false;
    {
      absl::MutexLock lock(&mutex_);
      call_ = call;
      ended = ended_;
    }
    if (ended) call->Cancel();
  }

  const std::shared_ptr<LiveSession> session_;
  const std::string id_, resume_;
  const pb::MethodDescriptor& method_;
  absl::Mutex mutex_;
  std::weak_ptr<RpcCall> call_ ABSL_GUARDED_BY(mutex_);
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;
};

class ServiceStream final : public StreamBase {
 public:
  ServiceStream(std::shared_ptr<LiveSession> session, const LiveRequest& request)
      : StreamBase(std::move(session), request), place_(*request.method) {}

  absl::Status Begin(std::string_view json, uint64_t newest, Cancellation* cancellation) override {
    const absl::StatusOr<std::string> binary =
        ToBinary(*method_.input_type(), MessageCodec::kJson, json, nullptr, cancellation);
    if (!binary.ok()) return binary.status();
    const std::unique_ptr<pb::Message> request = Parse(*method_.input_type(), *binary);
    if (request == nullptr) return absl::InternalError("the request cannot be read back");
    if (absl::Status status = place_.Begin(resume_, newest, request.get()); !status.ok()) return status;
    const std::optional<std::string> first = place_.first();
    SendLive(Concat("{\"id\":", id_, ",\"begun\":true",
                    first ? Concat(",\"resume\":", JsonString(*first)) : "", "}"));
    Start(request->SerializeAsString(), absl::InfiniteFuture(), std::make_shared<Sink>(Self()));
    return absl::OkStatus();
  }

 private:
  struct Sink final : RpcSink {
    explicit Sink(std::shared_ptr<ServiceStream> of) : stream(std::move(of)) {}
    void OnMessage(std::string bytes, const std::shared_ptr<RpcCall>& call) override {
      const size_t size = bytes.size();
      RunWhereThereIsTime(
          stream->session_->ports().workers, size,
          {.run = [stream = stream, bytes = std::move(bytes), call] { stream->Tell(bytes, call); },
           .refuse =
               [stream = stream, call](const absl::Status& why) {
                 stream->EndLive(ToGrpcStatus(why));
                 call->Cancel();
               },
           .client = stream->session_->client()});
    }
    void OnEnd(const grpc::Status& status) override { stream->EndLive(status); }
    const std::shared_ptr<ServiceStream> stream;
  };

  std::shared_ptr<ServiceStream> Self() {
    return std::static_pointer_cast<ServiceStream>(shared_from_this());
  }

  void Tell(const std::string& bytes, const std::shared_ptr<RpcCall>& call) {
    const std::unique_ptr<pb::Message> reply = Parse(*method_.output_type(), bytes);
    if (reply != nullptr && place_.IsNew(*reply)) {
      const absl::StatusOr<std::string> json = FromBinary(*method_.output_type(), MessageCodec::kJson, bytes);
      if (json.ok()) SendLive(MessageJson(id_, *json, place_.Next(*reply)));
    }
    // Weak: a tab that does not read does not keep a call that has ended.
    session_->exchange()->OnRoom([waiting = std::weak_ptr<RpcCall>(call)] {
      if (const std::shared_ptr<RpcCall> there = waiting.lock()) there->Next();
    });
  }

  ResumePoint place_;  // of one event at a time
};

class FollowedRead final : public StreamBase {
 public:
  FollowedRead(const std::shared_ptr<LiveSession>& session, const LiveRequest& request)
      : StreamBase(session, request),
        every_(std::max(request.every, absl::Milliseconds(session->ports().limits.live_follow_ms))) {}

  absl::Status Begin(std::string_view json, uint64_t newest, Cancellation* cancellation) override {
    absl::StatusOr<std::string> binary =
        ToBinary(*method_.input_type(), MessageCodec::kJson, json, nullptr, cancellation);
    if (!binary.ok()) return binary.status();
    binary_ = *std::move(binary);
    SendLive(Concat("{\"id\":", id_, ",\"begun\":true}"));
    {
      absl::MutexLock lock(&state_mutex_);
      begun_ = true;
    }
    Look(absl::Now(), newest);
    return absl::OkStatus();
  }
  // A tab that reads slowly, or follows much, gets the newest answer later.
  void Look(absl::Time now, uint64_t newest) override {
    FollowedReads::Begun begun;
    {
      absl::MutexLock lock(&state_mutex_);
      if (!begun_ || asking_ || now < due_ || !MayBeNew(newest)) return;
      if (session_->exchange()->full() || !session_->TakeReadPlace(now)) return;
      asking_ = true;
      asked_ = newest;
      asked_at_ = now;
      due_ = now + every_;
      if (session_->ports().followed != nullptr) begun = session_->ports().followed->Begin();
      trace_ = begun.trace;
    }
    Start(binary_, now + kReadTime,
          std::make_shared<Sink>(std::static_pointer_cast<FollowedRead>(shared_from_this())), begun.name);
  }
  size_t kept_bytes() const override { return binary_.size(); }
  absl::Time asked() const override {
    absl::MutexLock lock(&state_mutex_);
    return asked_at_;
  }

 private:
  struct Sink final : RpcSink {
    explicit Sink(std::shared_ptr<FollowedRead> of) : read(std::move(of)) {}
    void OnMessage(std::string bytes, const std::shared_ptr<RpcCall>& call) override {
      answer = std::move(bytes);
      call->Next();
    }
    void OnEnd(const grpc::Status& status) override {
      read->LeavePlace();
      if (!status.ok()) return read->EndLive(status);
      const size_t size = answer.size();
      RunWhereThereIsTime(
          read->session_->ports().workers, size,
          {.run = [read = read, answer = std::move(answer)] { read->Tell(answer); },
           .refuse = [read = read](const absl::Status& why) { read->EndLive(ToGrpcStatus(why)); },
           .client = read->session_->client()});
    }
    const std::shared_ptr<FollowedRead> read;
    std::string answer;
  };

  // Whether the answer of `newest` may be another one than that of asked_; where it is not, it is as if `newest` had been asked.
  bool MayBeNew(uint64_t newest) ABSL_EXCLUSIVE_LOCKS_REQUIRED(state_mutex_) {
    if (newest == asked_) return false;
    if (trace_ == nullptr || session_->ports().followed->MayHaveChanged(*trace_, *asked_, newest))
      return true;
    asked_ = newest;
    return false;
  }

  // What tells answers apart. Where the turns that change an answer are known, others are not asked, and its revision is not news.
  std::string MarkOf(const std::string& answer) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(state_mutex_) {
    const pb::FieldDescriptor* revision = method_.output_type()->FindFieldByName("revision");
    if (revision == nullptr || trace_ == nullptr || !trace_->whole())
      return absl::StrCat(absl::Hex(Fingerprint(answer), absl::kZeroPad16));
    const std::unique_ptr<pb::Message> message = Parse(*method_.output_type(), answer);
    if (message != nullptr) message->GetReflection()->ClearField(message.get(), revision);
    return absl::StrCat(
        absl::Hex(Fingerprint(message == nullptr ? answer : message->SerializeAsString()), absl::kZeroPad16));
  }

  // The answer is there, or will not come.
  void LeavePlace() {
    absl::MutexLock lock(&state_mutex_);
    session_->LeaveReadPlace(asked_at_, absl::Now());
  }

  void Tell(const std::string& answer) {
    std::string mark;
    bool is_new = false;
    {
      absl::MutexLock lock(&state_mutex_);
      mark = MarkOf(answer);
      is_new = mark != told_ && !(told_.empty() && mark == resume_);
      told_ = mark;
    }
    if (is_new) {
      const absl::StatusOr<std::string> json =
          FromBinary(*method_.output_type(), MessageCodec::kJson, answer);
      if (json.ok()) SendLive(MessageJson(id_, *json, mark));
    }
    absl::MutexLock lock(&state_mutex_);
    asking_ = false;
    due_ = std::max(due_, absl::Now() + absl::Seconds(static_cast<double>(answer.size()) / kBytesPerSecond));
  }

  std::string binary_;  // the request
  const absl::Duration every_;
  mutable absl::Mutex state_mutex_;
  bool begun_ ABSL_GUARDED_BY(state_mutex_) = false;
  bool asking_ ABSL_GUARDED_BY(state_mutex_) = false;
  std::optional<uint64_t> asked_ ABSL_GUARDED_BY(state_mutex_);     // the revision
  std::shared_ptr<ReadTrace> trace_ ABSL_GUARDED_BY(state_mutex_);  // of the newest asking
  absl::Time asked_at_ ABSL_GUARDED_BY(state_mutex_) = absl::InfinitePast();
  absl::Time due_ ABSL_GUARDED_BY(state_mutex_) = absl::InfinitePast();
  std::string told_ ABSL_GUARDED_BY(state_mutex_);  // mark of the answer that the tab has
};

}  // namespace

std::shared_ptr<LiveStream> MakeLiveStream(const std::shared_ptr<LiveSession>& session,
                                           const LiveRequest& request) {
  if (request.method->server_streaming()) return std::make_shared<ServiceStream>(session, request);
  return std::make_shared<FollowedRead>(session, request);
}

}  // namespace docent::server
