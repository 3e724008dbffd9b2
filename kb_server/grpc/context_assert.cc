// Context.Assert and Context.AssertStream: a message becomes a batch for the door.
#include <chrono>
#include <deque>

#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/unary_reactors.h"

namespace docent {
namespace {

// Whether making a batch of it takes more than moments: then a worker does it.
bool IsLarge(const v1::AssertRequest& request) {
  constexpr size_t kRdfBytes = 8192;
  constexpr int kItems = 500;
  return request.rdf().size() > kRdfBytes ||
         request.add_size() + request.remove_size() + request.readings_size() > kItems;
}

// One AssertStream. Requests are read one after the other and pushed through the door without waiting for the
// answer of the one before; answers are written in the order of the requests. At most kInFlight are open,
// then reading pauses: a fast client is slowed, memory stays bounded.
class AssertStreamReactor final : public grpc::ServerBidiReactor<v1::AssertRequest, v1::AssertStreamReply> {
 public:
  explicit AssertStreamReactor(const ServicePorts& ports) : ports_(ports) { StartRead(&request_); }

  void OnReadDone(bool ok) override {
    if (!ok) {
      absl::MutexLock lock(&mutex_);
      reading_ended_ = true;
      Pump();
      return;
    }
    uint64_t slot = 0;
    {
      absl::MutexLock lock(&mutex_);
      slot = first_slot_ + slots_.size();
      slots_.emplace_back();
      slots_.back().reply.set_request_id(request_.request_id());
    }
    if (!IsLarge(request_)) return Push(slot);
    if (ports_.workers->Submit([this, slot] { Push(slot); })) return;  // the next one is read after it
    Answer(slot, absl::ResourceExhaustedError("too much work waits; try again"));
    ReadOn();
  }

  void OnWriteDone(bool ok) override {
    absl::MutexLock lock(&mutex_);
    writing_ = false;
    broken_ = broken_ || !ok;
    slots_.pop_front();
    ++first_slot_;
    if (paused_ && slots_.size() < kInFlight) {
      paused_ = false;
      StartRead(&request_);
    }
    Pump();
  }

  void OnCancel() override {
    absl::MutexLock lock(&mutex_);
    gone_ = true;
    if (reading_rdf_ != nullptr) reading_rdf_->Cancel();
  }

  void OnDone() override {
    mutex_.Lock();  // the committer thread may still be on its way out of the Answer that finished this
    mutex_.Unlock();
    delete this;
  }

 private:
  static constexpr size_t kInFlight = 256;
  struct Slot {
    bool answered = false;
    v1::AssertStreamReply reply;
  };

  // On gRPC's thread or a worker; nothing is read meanwhile.
  void Push(uint64_t slot) {
    Cancellation cancellation{std::chrono::milliseconds(ports_.limits.query_timeout_ms)};
    {
      absl::MutexLock lock(&mutex_);
      reading_rdf_ = &cancellation;
      if (gone_) cancellation.Cancel();
    }
    absl::StatusOr<WriteBatch> batch = FromProto(request_, ports_.limits, &cancellation);
    {
      absl::MutexLock lock(&mutex_);
      reading_rdf_ = nullptr;
    }
    if (batch.ok()) {
      ports_.inbox->Push(*std::move(batch), [this, slot](const absl::StatusOr<BatchOutcome>& outcome) {
        Answer(slot, outcome);
      });
    } else {
      Answer(slot, batch.status());
    }
    ReadOn();
  }

  void ReadOn() {
    absl::MutexLock lock(&mutex_);
    if (slots_.size() < kInFlight)
      StartRead(&request_);
    else
      paused_ = true;
  }

  // Every batch that was pushed is answered, also when the client has gone: only then may this object die.
  void Answer(uint64_t slot, const absl::StatusOr<BatchOutcome>& outcome) {
    absl::MutexLock lock(&mutex_);
    Slot& place = slots_[slot - first_slot_];
    place.answered = true;
    if (outcome.ok()) {
      ToProto(*outcome, place.reply.mutable_reply());
    } else {
      *place.reply.mutable_error() = ToStreamError(outcome.status());
    }
    Pump();
  }

  void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (writing_ || finished_) return;
    while (broken_ && !slots_.empty() && slots_.front().answered) {
      slots_.pop_front();
      ++first_slot_;
    }
    if (!slots_.empty() && slots_.front().answered) {
      writing_ = true;
      // The answers of a group of turns come one after the other: gRPC sends those together that wait here.
      const bool more = slots_.size() > 1 && slots_[1].answered;
      StartWrite(&slots_.front().reply, more ? grpc::WriteOptions().set_buffer_hint() : grpc::WriteOptions());
    } else if (reading_ended_ && slots_.empty()) {
      finished_ = true;
      Finish(grpc::Status::OK);
    }
  }

  const ServicePorts& ports_;
  v1::AssertRequest request_;
  absl::Mutex mutex_;
  std::deque<Slot> slots_ ABSL_GUARDED_BY(mutex_);  // open requests, in order; references stay valid
  uint64_t first_slot_ ABSL_GUARDED_BY(mutex_) = 0;
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool paused_ ABSL_GUARDED_BY(mutex_) = false;
  bool reading_ended_ ABSL_GUARDED_BY(mutex_) = false;
  bool broken_ ABSL_GUARDED_BY(mutex_) = false;
  bool gone_ ABSL_GUARDED_BY(mutex_) = false;                    // the client
  Cancellation* reading_rdf_ ABSL_GUARDED_BY(mutex_) = nullptr;  // of the request that becomes a batch
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace

grpc::ServerUnaryReactor* ContextService::Assert(grpc::CallbackServerContext* context,
                                                 const v1::AssertRequest* request, v1::AssertReply* reply) {
  std::shared_ptr<Cancellation> cancellation;  // of a large one
  if (IsLarge(*request)) {
    cancellation = std::make_shared<Cancellation>(std::chrono::milliseconds(ports_.limits.query_timeout_ms));
  }
  const auto push = [this, cancellation, request, reply](grpc::ServerUnaryReactor* reactor) {
    absl::StatusOr<WriteBatch> batch = FromProto(*request, ports_.limits, cancellation.get());
    if (!batch.ok()) return reactor->Finish(ToGrpc(batch.status()));
    ports_.inbox->Push(*std::move(batch), [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
      if (outcome.ok()) ToProto(*outcome, reply);
      reactor->Finish(ToGrpc(outcome.status()));
    });
  };
  if (cancellation) return OnWorker(new CancellableReactor(cancellation), ports_.workers, push);
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  push(reactor);
  return reactor;
}

grpc::ServerBidiReactor<v1::AssertRequest, v1::AssertStreamReply>* ContextService::AssertStream(
    grpc::CallbackServerContext*) {
  return new AssertStreamReactor(ports_);
}

}  // namespace docent
