#include "robot_adapters/sdk/fact_sender.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/rdf/number_literal.h"
#include "graph/wire/term_proto.h"

namespace docent::robot {
namespace {

// Errors that say nothing about the batch itself: the same batch may be accepted later.
bool IsTransient(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kDeadlineExceeded:
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kCancelled:
    case absl::StatusCode::kUnknown:
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kUnimplemented:  // something else listens there, for now
      return true;
    default:
      return false;
  }
}

// The server refuses a batch for one number that is not finite.
bool IsMeasure(const Term& value) {
  return !IsNumberLiteral(value) || FiniteNumber(value);
}

TermQuad StateQuad(const std::string& subject, const std::string& predicate, const Term& value) {
  return {Term::Iri(subject), Term::Iri(predicate), value, Term::Iri("")};
}

}  // namespace

FactSender::FactSender(FactSenderOptions options, AssertCall call)
    : options_(std::move(options)), call_(std::move(call)), thread_([this] { Run(); }) {}

FactSender::~FactSender() {
  Stop(absl::ZeroDuration());
}

void FactSender::Set(const std::string& subject, const std::string& predicate, Term value) {
  SetAll(subject, {{predicate, std::move(value)}});
}

void FactSender::Clear(const std::string& subject, const std::string& predicate) {
  SetAll(subject, {{predicate, std::nullopt}});
}

void FactSender::SetAll(const std::string& subject,
                        std::vector<std::pair<std::string, std::optional<Term>>> values) {
  absl::MutexLock lock(&mutex_);
  if (ended_.contains(subject)) return;
  for (const auto& [predicate, value] : values) {
    if (value && !IsMeasure(*value)) return Refuse({subject, predicate}, *value);
  }
  for (auto& [predicate, value] : values) {
    StateKey key(subject, predicate);
    auto told = told_.find(key);
    if (told == told_.end() ? !value : told->second == value) continue;
    told_[key] = value;
    unmeasured_.erase(key);
    PutState(std::move(key), std::move(value));
  }
}

// Logged once for each state until it has a good value again.
void FactSender::Refuse(const StateKey& key, const Term& value) {
  ++refused_;
  if (!unmeasured_.insert(key).second) return;
  spdlog::error("{} of {} is {}, which is not a finite number; it is not told", key.second, key.first,
                ToDisplay(value));
}

void FactSender::WithdrawLeftover(const std::string& subject, const std::string& predicate, Term value) {
  absl::MutexLock lock(&mutex_);
  StateKey key(subject, predicate);
  auto told = told_.find(key);
  if ((told != told_.end() && told->second) || sent_.contains(key)) return;
  sent_[key] = std::move(value);
  PutState(std::move(key), std::nullopt);
}

// Into the last batch if it holds nothing but states, so that no state overtakes another batch.
void FactSender::PutState(StateKey key, std::optional<Term> value) {
  if (queue_.empty() || !queue_.back().StatesOnly()) queue_.emplace_back();
  queue_.back().states[std::move(key)] = std::move(value);
}

absl::Status FactSender::Tell(std::vector<TermQuad> add, std::vector<TermQuad> remove,
                              std::vector<Reading> readings) {
  const auto unmeasured = [](const Term& value) {
    return absl::InvalidArgumentError(
        absl::StrCat(ToDisplay(value), " is not a finite number; the server takes no such fact"));
  };
  for (const TermQuad& quad : add) {
    if (!IsMeasure(quad.object)) return unmeasured(quad.object);
  }
  for (const Reading& reading : readings) {
    if (!IsMeasure(reading.value)) return unmeasured(reading.value);
  }
  absl::MutexLock lock(&mutex_);
  if (queue_.size() >= options_.queue_limit) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "the server has not taken the last queue_limit = ", options_.queue_limit, " batches of facts"));
  }
  Batch batch;
  batch.add = std::move(add);
  batch.remove = std::move(remove);
  batch.readings = std::move(readings);
  queue_.push_back(std::move(batch));
  return absl::OkStatus();
}

void FactSender::EndStatesOf(const std::string& subject) {
  absl::MutexLock lock(&mutex_);
  ended_.insert(subject);
}

void FactSender::ResendStates() {
  absl::MutexLock lock(&mutex_);
  for (const auto& [key, value] : told_) {
    if (value && !ended_.contains(key.first)) PutState(key, value);
  }
}

v1::AssertRequest FactSender::Build(const Batch& batch) {
  v1::AssertRequest request;
  request.set_request_id(absl::StrCat(options_.request_id_prefix, "/", ++requests_));
  request.set_source(options_.source);
  for (const auto& [key, value] : batch.states) {
    if (value) {
      ToProto(StateQuad(key.first, key.second, *value), request.add_add());
      sent_[key] = *value;
    } else if (auto sent = sent_.find(key); sent != sent_.end()) {
      ToProto(StateQuad(key.first, key.second, sent->second), request.add_remove());
      sent_.erase(sent);
    }
  }
  for (const TermQuad& quad : batch.add) ToProto(quad, request.add_add());
  for (const TermQuad& quad : batch.remove) ToProto(quad, request.add_remove());
  for (const Reading& reading : batch.readings) {
    v1::SensorReading* out = request.add_readings();
    out->set_sensor(reading.sensor);
    ToProto(reading.value, out->mutable_value());
  }
  return request;
}

void FactSender::Run() {
  auto has_work = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return stopped_ || !queue_.empty(); };
  while (true) {
    v1::AssertRequest request;
    {
      absl::MutexLock lock(&mutex_);
      mutex_.Await(absl::Condition(&has_work));
      if (stopped_ || queue_.empty()) return;
      request = Build(queue_.front());
      queue_.pop_front();
      if (request.add_size() + request.remove_size() + request.readings_size() == 0) continue;
      sending_ = true;
    }
    if (!SendUntilAnswered(request)) return;  // what was on its way stays counted as such
    absl::MutexLock lock(&mutex_);
    sending_ = false;
  }
}

bool FactSender::Interrupted() const {
  return stopped_;
}

// False: stopped before the server answered.
bool FactSender::SendUntilAnswered(const v1::AssertRequest& request) {
  absl::Duration retry = options_.first_retry;
  for (bool said = false;; said = true) {
    v1::AssertReply reply;
    absl::Status status = call_(request, &reply);
    absl::MutexLock lock(&mutex_);
    if (status.ok()) {
      if (said) spdlog::info("the server takes facts again");
      return true;
    }
    if (!IsTransient(status)) {
      ++refused_;
      spdlog::error("the server refused facts ({}): {}", request.request_id(), std::string(status.message()));
      return true;
    }
    if (!said) spdlog::warn("the server does not take facts, trying on: {}", std::string(status.message()));
    if (mutex_.AwaitWithTimeout(absl::Condition(this, &FactSender::Interrupted), retry)) return false;
    retry = std::min(2 * retry, options_.last_retry);
  }
}

bool FactSender::Flush(absl::Duration timeout) {
  auto idle = [this]()
                  ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return stopped_ || (queue_.empty() && !sending_); };
  absl::MutexLock lock(&mutex_);
  return mutex_.AwaitWithTimeout(absl::Condition(&idle), timeout) && queue_.empty() && !sending_;
}

void FactSender::Stop(absl::Duration linger) {
  if (linger > absl::ZeroDuration()) Flush(linger);
  {
    absl::MutexLock lock(&mutex_);
    stopped_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

uint64_t FactSender::refused() const {
  absl::MutexLock lock(&mutex_);
  return refused_;
}

}  // namespace docent::robot
