#include "kb_server/door/inbox.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "graph/base/overload.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/text_bytes.h"
#include "kb_server/door/parsed_document.h"

namespace docent::server {
namespace {

size_t BytesOf(const WriteBatch& batch) {
  size_t bytes = 0;
  for (const QuadOperation& operation : batch.operations) bytes += TextBytes(operation.quad);
  for (const SensorReading& reading : batch.readings)
    bytes += reading.sensor.size() + TextBytes(reading.value);
  for (const Document& document : batch.documents) bytes += document.text.size();
  for (const CommandReport& report : batch.reports) {
    bytes += report.message.size();
    for (const auto& [name, value] : report.results) bytes += name.size() + TextBytes(value);
  }
  for (const RunRequest& request : batch.run_requests) {
    bytes += request.target.size() + request.node.size() + request.robot.size() + request.reason.size();
    for (const auto& [name, value] : request.arguments) bytes += name.size() + TextBytes(value);
  }
  return bytes;
}

std::string Beyond(std::string_view what, size_t value, std::string_view limit_name, size_t limit) {
  return absl::StrCat(ToAbsl(what), " ", value, "; the limit ", ToAbsl(limit_name), " is ", limit,
                      "; nothing was applied");
}

// "the name of the rule set …", of each name that the document gives to something.
absl::Status CheckName(std::string_view of_what, std::string_view name) {
  const std::optional<std::string> fault = DocumentNameFault(name);
  if (!fault) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("the name of the ", ToAbsl(of_what), " ", *fault, "; name it otherwise"));
}

// Workflows and robot services are named by their text.
absl::Status CheckNames(const ParsedDocument& parsed) {
  if (parsed.cawl != nullptr) return CheckName("workflow", parsed.cawl->name.value);
  if (parsed.rsel == nullptr) return absl::OkStatus();
  absl::Status status = CheckName("RSEL document", parsed.rsel->name.value);
  for (const rsel::Process& process : parsed.rsel->processes) {
    if (status.ok()) status = CheckName("process", process.name.value);
  }
  return status;
}

absl::Status CheckNames(const WriteBatch& batch) {
  for (const Document& document : batch.documents) {
    if (document.action != Document::Action::kPut) continue;
    absl::Status status;
    if (document.kind == Document::Kind::kRules) status = CheckName("rule set", document.name);
    if (document.kind == Document::Kind::kOntology) status = CheckName("ontology", document.name);
    if (const auto* parsed = dynamic_cast<const ParsedDocument*>(document.parsed.get()))
      status = CheckNames(*parsed);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status CheckSize(const WriteBatch& batch, size_t bytes, const Limits& limits) {
  bool load = batch.mode == WriteBatch::Mode::kLoad;
  size_t operations_limit = load ? limits.load_operations : limits.batch_operations;
  if (batch.OperationCount() > operations_limit) {
    return absl::ResourceExhaustedError(Beyond("the batch has operations:", batch.OperationCount(),
                                               load ? "load_operations" : "batch_operations",
                                               operations_limit));
  }
  for (const Document& document : batch.documents) {
    if (document.text.size() <= limits.document_bytes) continue;
    return absl::ResourceExhaustedError(
        Beyond("a document has bytes:", document.text.size(), "document_bytes", limits.document_bytes));
  }
  if (!load && batch.documents.empty() && bytes > limits.batch_bytes) {
    return absl::ResourceExhaustedError(
        Beyond("the batch has bytes of text:", bytes, "batch_bytes", limits.batch_bytes));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckBatch(const WriteBatch& batch, const Limits& limits) {
  const absl::Status names = CheckNames(batch);
  return names.ok() ? CheckSize(batch, BytesOf(batch), limits) : names;
}

absl::Status Inbox::CheckRoom(size_t bytes) const {
  if (closed_) return absl::UnavailableError("the server is shutting down");
  if (queue_.size() >= limits_.inbox_batches) {
    return OverloadError(Beyond("batches that wait:", queue_.size(), "inbox_batches", limits_.inbox_batches));
  }
  if (!queue_.empty() && waiting_bytes_ + bytes > limits_.inbox_bytes) {
    return OverloadError(
        Beyond("bytes of text that would wait:", waiting_bytes_ + bytes, "inbox_bytes", limits_.inbox_bytes));
  }
  return absl::OkStatus();
}

void Inbox::Push(WriteBatch batch, BatchCallback done, BatchPreparation prepare) {
  if (!done) done = [](const absl::StatusOr<BatchOutcome>&) {};
  size_t bytes = BytesOf(batch);
  absl::Status refusal = CheckNames(batch);
  if (refusal.ok()) refusal = CheckSize(batch, bytes, limits_);
  if (refusal.ok()) refusal = Add({std::move(batch), done, std::move(prepare), nullptr}, bytes);
  if (!refusal.ok()) done(refusal);
}

void Inbox::Visit(StateVisit visit, std::function<void(const absl::Status&)> done) {
  const BatchCallback seen = [done](const absl::StatusOr<BatchOutcome>& outcome) { done(outcome.status()); };
  if (absl::Status refusal = Add({WriteBatch(), seen, nullptr, std::move(visit)}, 0); !refusal.ok()) {
    done(refusal);
  }
}

absl::Status Inbox::Add(PendingBatch pending, size_t bytes) {
  absl::MutexLock lock(&mutex_);
  if (absl::Status refusal = CheckRoom(bytes); !refusal.ok()) return refusal;
  queue_.push_back({std::move(pending), bytes});
  waiting_bytes_ += bytes;
  return absl::OkStatus();
}

std::vector<PendingBatch> Inbox::PopAll(std::optional<TimeMicros> deadline, size_t max) {
  std::vector<PendingBatch> taken;
  absl::MutexLock lock(&mutex_);
  auto ready = [this]()
                   ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return closed_ || woken_ || !queue_.empty(); };
  if (deadline) {
    absl::Duration wait = absl::Microseconds(std::max<TimeMicros>(0, *deadline - clock_.Now()));
    mutex_.AwaitWithTimeout(absl::Condition(&ready), wait);
  } else {
    mutex_.Await(absl::Condition(&ready));
  }
  woken_ = false;
  last_stamp_us_ = std::max(last_stamp_us_, clock_.Now());
  while (!queue_.empty() && taken.size() < max) {
    Waiting& front = queue_.front();
    front.pending.batch.time_us = last_stamp_us_;
    waiting_bytes_ -= front.bytes;
    taken.push_back(std::move(front.pending));
    queue_.pop_front();
  }
  return taken;
}

void Inbox::Wake() {
  absl::MutexLock lock(&mutex_);
  woken_ = true;
}

void Inbox::StartAfter(TimeMicros time_us) {
  absl::MutexLock lock(&mutex_);
  last_stamp_us_ = std::max(last_stamp_us_, time_us);
}

void Inbox::Close() {
  absl::MutexLock lock(&mutex_);
  closed_ = true;
}

bool Inbox::closed() const {
  absl::MutexLock lock(&mutex_);
  return closed_;
}

size_t Inbox::size() const {
  absl::MutexLock lock(&mutex_);
  return queue_.size();
}

}  // namespace docent::server
