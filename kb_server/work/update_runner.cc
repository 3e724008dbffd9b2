#include "kb_server/work/update_runner.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/sparql/run/update_evaluator.h"
#include "kb_server/door/await_version.h"
#include "kb_server/door/ports.h"
#include "kb_server/door/query_memory.h"
#include "kb_server/door/request_memory.h"
#include "kb_server/work/load_runner.h"
#include "kb_server/work/remote_access.h"

namespace docent::server {
// One update on its way. It is in one thread at a time: a worker's or the writer's.
class UpdateRunner::Job : public std::enable_shared_from_this<Job> {
 public:
  Job(const WritePorts& ports, UpdateRequest request, uint64_t seed, TimeMicros now_us, BatchCallback done)
      : ports_(ports), request_(std::move(request)), done_(std::move(done)), needed_(request_.min_revision) {
    run_.now_us = now_us;
    run_.seed = seed;
    options_.prepare.default_graph = ports.default_graph;
    options_.prepare.functions = ports.functions;
    options_.prepare.memory_bytes = ports.limits.query_memory_bytes;
    if (request_.memory == nullptr) request_.memory = MemoryOfRequest(ports);
    options_.prepare.memory = request_.memory.get();
    options_.load = [this](const std::string& iri) { return Document(iri); };
    deadline_ = absl::Now() + request_.timeout;
  }

  // On a worker, as soon as there is the version that is needed.
  void Begin() {
    SubmitOnVersion(ports_, needed_,
                    {.run = [self = shared_from_this()] { self->Attempt(); },
                     .refuse = done_,
                     .client = request_.client,
                     .until = deadline_,
                     .cancellation = request_.cancellation});
  }

 private:
  void Attempt() {
    ++attempts_;
    const GraphVersionPtr version = ports_.queries->Newest();
    if (attempts_ == 1) {
      if (absl::Status status = AskOthers(*version); !status.ok()) return done_(status);
    }
    if (attempts_ > ports_.limits.update_attempts) return PushUnevaluated();
    absl::StatusOr<sparql::UpdateEffect> effect = EvaluateShared(*version);
    if (!effect.ok()) return done_(effect.status());
    if (effect->operations.empty() && request_.request_id.empty()) {
      return done_(BatchOutcome{version->revision().value()});
    }
    effect_bytes_ = effect->bytes;
    Push(std::move(*effect), version->revision());
  }

  absl::StatusOr<sparql::UpdateEffect> EvaluateShared(const GraphVersion& version) {
    const WorkerPool::SharedWork shared(ports_.workers, request_.cancellation.get());
    return Evaluate(version, request_.cancellation.get());
  }

  // What other servers know is fetched once, and never on the writer's turn.
  absl::Status AskOthers(const GraphVersion& version) {
    const WorkerPool::SharedWork shared(ports_.workers, request_.cancellation.get());
    sparql::RunOptions run = run_;
    run.version = &version;
    run.cancellation = request_.cancellation.get();
    absl::Status status =
        sparql::ResolveServices(&request_.update, ports_.remote, *ports_.dictionary, options_.prepare, run);
    for (const sparql::UpdateOperation& operation : request_.update.operations) {
      if (!status.ok()) break;
      if (operation.kind != sparql::UpdateOperation::Kind::kLoad) continue;
      const std::string& iri = operation.document.lexical;
      if (documents_.contains(iri)) continue;
      if (!request_.load && ports_.remote == nullptr) continue;
      documents_.emplace(iri, request_.load ? request_.load(iri) : LoadFromOthers(iri));
    }
    return status;
  }

  absl::StatusOr<sparql::DocumentQuads> LoadFromOthers(const std::string& iri) const {
    absl::StatusOr<std::vector<TermQuad>> quads =
        ports_.remote->Load(iri, request_.cancellation.get(), request_.memory.get());
    if (!quads.ok()) return quads.status();
    return std::make_shared<const std::vector<TermQuad>>(*std::move(quads));
  }

  absl::StatusOr<sparql::DocumentQuads> Document(const std::string& iri) const {
    const auto it = documents_.find(iri);
    if (it == documents_.end()) return absl::FailedPreconditionError("LOAD is not permitted here");
    return it->second;
  }

  absl::StatusOr<sparql::UpdateEffect> Evaluate(const GraphVersion& version, Cancellation* cancellation) {
    if (request_.precondition) {
      if (absl::Status status = request_.precondition(version); !status.ok()) return status;
    }
    sparql::RunOptions run = run_;
    run.version = &version;
    run.cancellation = cancellation;
    return sparql::EvaluateUpdate(request_.update, *ports_.dictionary, run, options_);
  }

  WriteBatch Batch() const {
    WriteBatch batch;
    batch.request_id = request_.request_id;
    batch.request_digest = request_.request_digest;
    batch.mode = WriteBatch::Mode::kLoad;
    return batch;
  }

  void Push(sparql::UpdateEffect effect, Revision evaluated_on) {
    WriteBatch batch = Batch();
    batch.operations = std::move(effect.operations);
    conflict_ = false;
    auto check = [self = shared_from_this(), evaluated_on, reads = std::move(effect.reads)](
                     const TurnView& view, WriteBatch*) -> absl::Status {
      if (view.revision == evaluated_on ||
          !view.changes.Touched(evaluated_on, reads, *self->ports_.dictionary)) {
        return absl::OkStatus();
      }
      self->conflict_ = true;
      self->needed_ = view.revision;
      return absl::AbortedError("what the update read has changed meanwhile");
    };
    auto done = [self = shared_from_this()](const absl::StatusOr<BatchOutcome>& outcome) {
      if (absl::IsAborted(outcome.status()) && self->conflict_) return self->Again();
      self->done_(outcome);
    };
    BringJudged(ports_, std::move(batch), request_.text, std::move(check), /*made_on_turn=*/false,
                request_.client, std::move(done));
  }

  void Again() {
    request_.memory->Release(std::exchange(effect_bytes_, 0));
    deadline_ = std::max(deadline_, absl::Now() + absl::Seconds(10));  // for a version that is on its way
    Begin();
  }

  // Whatever else is written, this version stays until the update is done.
  void PushUnevaluated() {
    auto evaluate = [self = shared_from_this()](const TurnView& view, WriteBatch* batch) -> absl::Status {
      const int limit_ms = self->ports_.limits.update_turn_ms;
      Cancellation cancellation{std::chrono::milliseconds(limit_ms)};
      absl::StatusOr<sparql::UpdateEffect> effect = self->Evaluate(view.graph, &cancellation);
      if (effect.ok()) {
        batch->operations = std::move(effect->operations);
        return absl::OkStatus();
      }
      if (effect.status().code() != absl::StatusCode::kDeadlineExceeded) return effect.status();
      return absl::AbortedError(absl::StrCat(
          "what the update reads was changed by others during each of ", self->attempts_ - 1,
          " evaluations, and the one while they waited took longer than the limit update_turn_ms = ",
          limit_ms, "; nothing was changed, try again or make it smaller"));
    };
    BringJudged(ports_, Batch(), request_.text, std::move(evaluate), /*made_on_turn=*/true, request_.client,
                done_);
  }

  const WritePorts& ports_;
  UpdateRequest request_;
  std::map<std::string, absl::StatusOr<sparql::DocumentQuads>> documents_;  // of LOAD
  const BatchCallback done_;
  sparql::RunOptions run_;
  sparql::UpdateOptions options_;
  absl::Time deadline_;
  Revision needed_;
  int attempts_ = 0;
  bool conflict_ = false;
  size_t effect_bytes_ = 0;  // of the operations at the door, counted in the request's memory
};

void UpdateRunner::Submit(UpdateRequest request, BatchCallback done) {
  if (absl::Status id = CheckRequestId(request.request_id); !id.ok()) return done(id);
  const TimeMicros now_us = ports_.clock->Now();
  // No two updates of a log share a seed: the time to the microsecond, and a count within it.
  const uint64_t seed = (static_cast<uint64_t>(now_us) << 12) + (count_++ & 4095);
  std::make_shared<Job>(ports_, std::move(request), seed, now_us, std::move(done))->Begin();
}

}  // namespace docent::server
