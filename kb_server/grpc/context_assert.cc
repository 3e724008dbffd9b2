// Context.Assert and Context.AssertStream: a message becomes a batch for the door.
#include <chrono>
#include <deque>
#include <optional>

#include "kb_server/door/query_memory.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/module_requests.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/grpc/write_pump.h"
#include "kb_server/work/load_runner.h"

namespace docent::server {
namespace {

// Whether making a batch of it takes more than moments: then a worker does it.
bool IsLarge(const v1::AssertRequest& request) {
  constexpr size_t kRdfBytes = 8192;
  constexpr int kItems = 500;
  return request.rdf().size() > kRdfBytes ||
         request.add_size() + request.remove_size() + request.readings_size() > kItems;
}

using AssertStreamPump =
    WritePump<grpc::ServerBidiReactor<v1::AssertRequest, v1::AssertStreamReply>, v1::AssertStreamReply>;

// One AssertStream. Requests are read one after the other and pushed through the door without waiting for the
// answer of the one before; answers are written in the order of the requests. At most kInFlight are open,
// then reading pauses: a fast client is slowed, memory stays bounded.
class AssertStreamReactor final : public AssertStreamPump {
 public:
  AssertStreamReactor(grpc::CallbackServerContext* context, const RunPorts& ports)
      : AssertStreamPump(context, ports.send_budget),
        ports_(ports),
        client_(ClientOf(*context, ports.clients)) {
    StartRead(&request_);
  }

  void OnReadDone(bool ok) override {
    uint64_t slot = 0;
    {
      absl::MutexLock lock(&link()->mutex);
      if (!ok) {
        reading_ended_ = true;
        return Advance();
      }
      slot = first_slot_ + slots_.size();
      slots_.emplace_back();
      slots_.back().reply.set_request_id(request_.request_id());
    }
    if (!IsLarge(request_)) {
      const LinkPtr stream = link();  // this may end with the answer
      const bool waits = WaitsForAnswers(ports_);
      Push(stream, this, ports_, client_, slot, request_);
      return waits ? void() : ReadOn(stream, this);
    }
    auto request = std::make_shared<v1::AssertRequest>(std::move(request_));
    ports_.workers->Submit(
        {.run =
             [stream = link(), self = this, &ports = ports_, client = client_, slot, request] {
               Push(stream, self, ports, client, slot, *request);
               if (!WaitsForAnswers(ports)) ReadOn(stream, self);  // the next one is read after it
             },
         .refuse =
             [stream = link(), self = this, slot](const absl::Status& why) {
               Answer(stream, self, slot, why);
               ReadOn(stream, self);
             },
         .client = client_});
  }

 private:
  static constexpr size_t kInFlight = 256;
  struct Slot {
    bool answered = false;
    v1::AssertStreamReply reply;
  };
  using LinkPtr = std::shared_ptr<Link>;

  // The stream `self` may have ended when these are called, and then they do nothing for it; a batch is pushed all the same.
  static void Push(const LinkPtr& stream, AssertStreamReactor* self, const RunPorts& ports,
                   const ClientPtr& client, uint64_t slot, const v1::AssertRequest& request) {
    Cancellation cancellation{std::chrono::milliseconds(ports.limits.query_timeout_ms)};
    const std::shared_ptr<MemoryUse> memory = IsLarge(request) ? MemoryOfRequest(ports) : nullptr;
    absl::StatusOr<WriteBatch> batch = FromProto(request, ports.limits, &cancellation, memory.get());
    if (!batch.ok()) return AnswerAndReadOn(stream, self, ports, slot, batch.status());
    BringJudged(ports, *std::move(batch), {}, nullptr, /*made_on_turn=*/false, client,
                [stream, self, &ports, slot, memory](const absl::StatusOr<BatchOutcome>& outcome) {
                  AnswerAndReadOn(stream, self, ports, slot, outcome);
                });
  }
  // What is judged beside the writer would overtake: then one batch is under way at a time.
  static bool WaitsForAnswers(const RunPorts& ports) { return ports.on_violation != OnViolation::kIgnore; }
  static void AnswerAndReadOn(const LinkPtr& stream, AssertStreamReactor* self, const RunPorts& ports,
                              uint64_t slot, const absl::StatusOr<BatchOutcome>& outcome) {
    Answer(stream, self, slot, outcome);
    if (WaitsForAnswers(ports)) ReadOn(stream, self);
  }
  static void ReadOn(const LinkPtr& stream, AssertStreamReactor* self) {
    absl::MutexLock lock(&stream->mutex);
    if (stream->pump == nullptr || self->ended()) return;
    self->paused_ = self->slots_.size() >= kInFlight;
    if (!self->paused_) self->StartRead(&self->request_);
  }
  static void Answer(const LinkPtr& stream, AssertStreamReactor* self, uint64_t slot,
                     const absl::StatusOr<BatchOutcome>& outcome) {
    absl::MutexLock lock(&stream->mutex);
    if (stream->pump == nullptr || self->ended()) return;
    Slot& place = self->slots_[slot - self->first_slot_];
    place.answered = true;
    if (outcome.ok()) {
      ToProto(*outcome, place.reply.mutable_reply());
    } else {
      *place.reply.mutable_error() = ToStreamError(outcome.status());
    }
    self->Advance();
  }

  bool FillNext(v1::AssertStreamReply* message, grpc::WriteOptions* options) override {
    if (slots_.empty() || !slots_.front().answered) return false;
    *message = std::move(slots_.front().reply);
    // The answers of a group of turns come one after the other: gRPC sends those together that wait here.
    if (slots_.size() > 1 && slots_[1].answered) options->set_buffer_hint();
    return true;
  }
  void OnTaken(bool) override {
    slots_.pop_front();
    ++first_slot_;
    if (!paused_ || ended() || slots_.size() >= kInFlight) return;
    paused_ = false;
    StartRead(&request_);
  }
  void OnIdle() override {
    if (reading_ended_ && slots_.empty()) End(grpc::Status::OK);
  }

  const RunPorts& ports_;
  const ClientPtr client_;
  v1::AssertRequest request_;
  std::deque<Slot> slots_;  // open requests, in order; references stay valid
  uint64_t first_slot_ = 0;
  bool paused_ = false;
  bool reading_ended_ = false;
};

}  // namespace

grpc::ServerUnaryReactor* ContextService::Assert(grpc::CallbackServerContext* context,
                                                 const v1::AssertRequest* request, v1::AssertReply* reply) {
  std::shared_ptr<Cancellation> cancellation;  // of a large one
  if (IsLarge(*request)) {
    cancellation = std::make_shared<Cancellation>(std::chrono::milliseconds(ports_.limits.query_timeout_ms));
  }
  const ClientPtr client = ClientOf(*context, ports_.clients);
  const auto push = [this, client, cancellation, request, reply](grpc::ServerUnaryReactor* reactor) {
    const std::shared_ptr<MemoryUse> memory = cancellation ? MemoryOfRequest(ports_) : nullptr;
    absl::StatusOr<WriteBatch> batch = [&] {
      std::optional<WorkerPool::SharedWork> shared;
      if (cancellation) shared.emplace(ports_.workers, cancellation.get());
      return FromProto(*request, ports_.limits, cancellation.get(), memory.get());
    }();
    if (!batch.ok()) return reactor->Finish(ToGrpc(batch.status()));
    BringJudged(ports_, *std::move(batch), TextOf(*request, ports_.limits), nullptr, /*made_on_turn=*/false,
                client, [reactor, reply, memory](const absl::StatusOr<BatchOutcome>& outcome) {
                  if (outcome.ok()) ToProto(*outcome, reply);
                  reactor->Finish(ToGrpc(outcome.status()));
                });
  };
  if (cancellation) return OnWorker(ports_, context, cancellation, push);
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  push(reactor);
  return reactor;
}

grpc::ServerBidiReactor<v1::AssertRequest, v1::AssertStreamReply>* ContextService::AssertStream(
    grpc::CallbackServerContext* context) {
  return new AssertStreamReactor(context, ports_);
}

}  // namespace docent::server
