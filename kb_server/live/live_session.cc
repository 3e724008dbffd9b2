#include "kb_server/live/live_session.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/memory_budget.h"
#include "graph/base/text.h"
#include "kb_server/connect/connect_error.h"
#include "kb_server/connect/message_codec.h"

namespace docent::server {
namespace {

// Larger messages take more than about a millisecond to read.
constexpr size_t kSmallBytes = 8u << 10;

// What reading a message takes, about: itself, what the conversion takes, and the set of an object's names.
size_t BytesToRead(std::string_view text) {
  constexpr size_t kCopies = 4, kValue = 32, kName = 100;
  const auto names = static_cast<size_t>(std::count(text.begin(), text.end(), ':'));
  return kCopies * text.size() + kValue * ValuesInJson(text) + kName * names;
}

grpc::Status ToGrpcStatus(const absl::Status& status) {
  return {static_cast<grpc::StatusCode>(status.code()), std::string(status.message())};
}

std::string EndJson(const std::string& id, const grpc::Status& status) {
  return Concat("{\"id\":", id, ",\"end\":{",
                status.ok() ? "" : Concat("\"error\":", ConnectErrorJson(status)), "}}");
}

}  // namespace

LiveSession::LiveSession(const LivePorts* ports, const std::shared_ptr<HttpExchange>& exchange)
    : ports_(*ports),
      exchange_(exchange),
      reader_(ports->limits.live_message_bytes),
      heard_(absl::Now()),
      probed_(heard_) {}

void LiveSession::Begin() {
  exchange_->OnGone([weak = weak_from_this()] {
    if (const std::shared_ptr<LiveSession> self = weak.lock()) self->EndAll();
  });
  Send(absl::StrCat("{\"hello\":{\"revision\":\"", ports_.queries->Newest()->revision().value(), "\"}}"));
}

void LiveSession::Send(std::string_view json) {
  exchange_->Push(WebSocketFrame(WebSocketOpcode::kText, json));
}

void LiveSession::StreamEnded(const LiveStream* stream, const std::string& id, const grpc::Status& status) {
  if (Remove(id, stream) != nullptr) Send(EndJson(id, status));
}

std::shared_ptr<LiveStream> LiveSession::Remove(const std::string& id, const LiveStream* only) {
  std::shared_ptr<LiveStream> stream;
  {
    absl::MutexLock lock(&mutex_);
    const auto found = streams_.find(id);
    if (found == streams_.end() || (only != nullptr && found->second.stream.get() != only)) return nullptr;
    stream = std::move(found->second.stream);
    kept_bytes_ -= found->second.kept_bytes;
    streams_.erase(found);
  }
  CountHeld();
  return stream;
}

bool LiveSession::HasPatience() {
  if (!exchange_->full()) unread_ = 0;
  return ++unread_ <= ports_.limits.live_unread_requests;
}

void LiveSession::OnBytes(std::string_view bytes) {
  {
    absl::MutexLock lock(&mutex_);
    if (closed_) return;
    heard_ = absl::Now();
  }
  std::vector<WebSocketReader::Event> events = reader_.Read(bytes);
  {
    absl::MutexLock lock(&mutex_);
    begun_bytes_ = reader_.held();
    begun_ = begun_bytes_ == 0 ? absl::InfiniteFuture() : std::min(begun_, absl::Now());
  }
  if (!CountHeld()) return;
  for (WebSocketReader::Event& event : events) {
    bool patient = true;
    {
      absl::MutexLock lock(&mutex_);
      if (closed_) return;
      patient = HasPatience();
    }
    if (!patient)
      return Close(WebSocketClose(kWebSocketPolicy,
                                  "the tab asks and does not read the answers: live_unread_requests"));
    switch (event.opcode) {
      case WebSocketOpcode::kText:
        Receive(std::move(event.payload));
        break;
      case WebSocketOpcode::kPing:
        exchange_->Push(WebSocketFrame(WebSocketOpcode::kPong, event.payload));
        break;
      case WebSocketOpcode::kClose:
        Close(event.payload);
        break;
      default:
        break;
    }
  }
}

bool LiveSession::CountHeld() {
  bool has_room = true;
  {
    absl::MutexLock lock(&mutex_);
    const size_t held = begun_bytes_ + whole_bytes_ + kept_bytes_, before = std::exchange(counted_, held);
    MemoryUse* const memory = exchange_->memory();
    if (memory == nullptr) return true;
    if (held < before) memory->Release(before - held);
    if (held == kept_bytes_) memory->Settle();  // a connection that only listens reserves nothing
    has_room = held <= before || memory->Add(held - before);
  }
  if (!has_room)
    Close(WebSocketClose(kWebSocketTryAgain,
                         "too much is in work at the same time (http_bodies_bytes); try again later"));
  return has_room;
}

void LiveSession::Receive(std::string text) {
  bool at_once = false, begin = false;
  {
    absl::MutexLock lock(&mutex_);
    at_once = taking_ == nullptr && (text.size() <= kSmallBytes || ports_.workers == nullptr);
    if (!at_once) {
      const size_t bytes = BytesToRead(text);
      whole_bytes_ += bytes;
      waiting_.push_back({std::move(text), bytes});
      begin = taking_ == nullptr;
      if (begin) taking_ = std::make_shared<Cancellation>();
    }
  }
  if (at_once) return Take(text, nullptr);
  if (CountHeld() && begin) TakeNextOnWorker();
}

void LiveSession::TakeNextOnWorker() {
  std::shared_ptr<Cancellation> cancellation;
  {
    absl::MutexLock lock(&mutex_);
    cancellation = taking_;
  }
  ports_.workers->Submit(
      {.run = [self = shared_from_this(), cancellation] { self->TakeNext(cancellation.get()); },
       .refuse =
           [self = shared_from_this()](const absl::Status& why) {
             self->Close(WebSocketClose(kWebSocketTryAgain, FromAbsl(why.message())));
           },
       .client = client(),
       .cancellation = cancellation});
}

void LiveSession::TakeNext(Cancellation* cancellation) {
  Waiting next;
  {
    absl::MutexLock lock(&mutex_);
    if (waiting_.empty()) return;  // the connection is closed
    next = std::move(waiting_.front());
    waiting_.pop_front();
  }
  {
    const WorkerPool::SharedWork shared(ports_.workers, cancellation);
    Take(next.text, cancellation);
  }
  bool more = false;
  {
    absl::MutexLock lock(&mutex_);
    whole_bytes_ -= next.bytes;
    more = !waiting_.empty();
    if (!more) taking_ = nullptr;
  }
  CountHeld();
  if (more) TakeNextOnWorker();
}

void LiveSession::Take(const std::string& text, Cancellation* cancellation) {
  std::string id;
  const absl::StatusOr<LiveRequest> request = ReadLiveRequest(text, ports_.services, &id, cancellation);
  if (!request.ok()) {
    // A stream that is there under this id goes on.
    return Send(
        Concat("{\"id\":", id, ",\"refused\":", ConnectErrorJson(ToGrpcStatus(request.status())), "}"));
  }
  if (!request->end) return BeginStream(*request, cancellation);
  const std::shared_ptr<LiveStream> stream = Remove(request->id);
  if (stream == nullptr) return;  // it has ended by itself
  stream->End();
  Send(EndJson(request->id, grpc::Status::OK));
}

void LiveSession::BeginStream(const LiveRequest& request, Cancellation* cancellation) {
  const std::shared_ptr<LiveStream> stream = MakeLiveStream(shared_from_this(), request);
  absl::Status status;
  {
    absl::MutexLock lock(&mutex_);
    if (closed_) return;
    if (streams_.size() >= ports_.limits.live_streams) {
      status = absl::ResourceExhaustedError(
          absl::StrCat("this connection follows as much as it may: the limit live_streams is ",
                       ports_.limits.live_streams));
    } else if (!streams_.emplace(request.id, Followed{stream}).second) {
      status = absl::AlreadyExistsError(absl::StrCat("the id ", request.id, " is in use"));
    }
  }
  if (!status.ok())
    return Send(Concat("{\"id\":", request.id, ",\"refused\":", ConnectErrorJson(ToGrpcStatus(status)), "}"));
  status = stream->Begin(request.request, ports_.queries->Newest()->revision().value(), cancellation);
  if (!status.ok()) return StreamEnded(stream.get(), request.id, ToGrpcStatus(status));
  {
    absl::MutexLock lock(&mutex_);
    const auto found = streams_.find(request.id);
    if (found == streams_.end() || found->second.stream != stream) return;  // it has ended
    found->second.kept_bytes = stream->kept_bytes();
    kept_bytes_ += found->second.kept_bytes;
  }
  CountHeld();
}

void LiveSession::Look(absl::Time now, uint64_t newest) {
  std::vector<std::pair<absl::Time, std::shared_ptr<LiveStream>>> streams;  // and when each was asked
  bool silent = false, late = false, probe = false;
  {
    absl::MutexLock lock(&mutex_);
    if (closed_) return;
    silent = now - heard_ > absl::Milliseconds(ports_.limits.live_silence_ms);
    late = now - begun_ > absl::Milliseconds(ports_.limits.live_silence_ms);
    probe = now - std::max(heard_, probed_) > absl::Milliseconds(ports_.limits.live_ping_ms);
    if (probe) probed_ = now;
    for (const auto& [id, one] : streams_) streams.emplace_back(absl::InfinitePast(), one.stream);
  }
  if (silent)
    return Close(WebSocketClose(kWebSocketGoingAway, "nothing came for the time of live_silence_ms"));
  if (late)
    return Close(
        WebSocketClose(kWebSocketPolicy, "a message did not arrive within the time of live_silence_ms"));
  if (probe) exchange_->Push(WebSocketFrame(WebSocketOpcode::kPing, ""));
  for (auto& [asked, stream] : streams) asked = stream->asked();
  std::sort(streams.begin(), streams.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [asked, stream] : streams) stream->Look(now, newest);
}

bool LiveSession::TakeReadPlace(absl::Time now) {
  absl::MutexLock lock(&mutex_);
  std::erase_if(resting_, [now](absl::Time until) { return until <= now; });
  if (reads_asked_ + resting_.size() >= ports_.limits.live_reads_asked) return false;
  ++reads_asked_;
  return true;
}

void LiveSession::LeaveReadPlace(absl::Time asked, absl::Time answered) {
  absl::MutexLock lock(&mutex_);
  --reads_asked_;
  resting_.push_back(answered + (answered - asked));
}

void LiveSession::Stop() {
  Close(WebSocketClose(kWebSocketGoingAway, "the server stops"));
}

void LiveSession::Close(std::string_view frame) {
  EndAll();
  exchange_->Push(frame);
  exchange_->End();
}

void LiveSession::EndAll() {
  absl::flat_hash_map<std::string, Followed> streams;
  {
    absl::MutexLock lock(&mutex_);
    closed_ = true;
    streams.swap(streams_);
    for (const Waiting& one : waiting_) whole_bytes_ -= one.bytes;
    waiting_.clear();
    kept_bytes_ = 0;
    if (taking_ != nullptr) taking_->Cancel();
  }
  for (const auto& [id, one] : streams) one.stream->End();
}

}  // namespace docent::server
