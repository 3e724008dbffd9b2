#include "kb_server/writer/writer.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/log/record_codec.h"
#include "kb_server/robots/robot_records.h"
#include "kb_server/writer/run_events.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

// A clock tick that was refused (a full disk, a rule that explodes) is tried again after this time, not at
// once.
constexpr TimeMicros kTickPauseUs = 1'000'000;
constexpr uint64_t kTurnsPerProgress = 10000;
// Handed over together: while the disk syncs them, the next ones are decided.
constexpr size_t kTurnsPerGroup = 256;
constexpr size_t kLarge = 10000;  // operations
// Old versions that wait to be freed until no batch waits, and what they alone may hold.
constexpr size_t kGoneAtMost = 64;
constexpr size_t kGoneBytes = 4u << 20;

// For counters alone.
uint64_t MonotonicNanos() {
  return static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                   std::chrono::steady_clock::now().time_since_epoch())
                                   .count());
}

// What its client is told of a turn.
BatchOutcome OutcomeOf(const TurnResult& result) {
  BatchOutcome outcome;
  outcome.offset = result.record.offset;
  outcome.added = result.delta.added.size() + result.told_again;
  outcome.removed = result.delta.removed.size();
  outcome.inferred = result.inferred;
  outcome.started = result.started;
  outcome.cancelled_runs = result.undeployed.size();
  outcome.steered = result.steered;
  return outcome;
}

}  // namespace

Writer::Writer(const Ports& ports)
    : ports_(ports),
      requests_(ports.limits.request_ids_remembered),
      committer_(ports, ports.limits.turns_per_commit, &counters_, [inbox = ports.inbox] { inbox->Wake(); }) {
}

absl::Status Writer::Recover(const std::function<void(uint64_t, uint64_t)>& progress) {
  absl::Status status = Replay(progress);
  if (!status.ok()) return status;
  GraphVersionPtr version = stages_->writer.Freeze(Revision(newest_));
  if (ports_.followed != nullptr) ports_.followed->Add(*version, {}, /*others=*/true);
  ports_.catalog->Publish(stages_->documents.MakeCatalog(stages_->engine));
  ports_.queries->Publish(version);
  if (ports_.subscriptions != nullptr) ports_.subscriptions->PublishWhole(std::move(version));
  committer_.TellAddresses(AdapterAddresses(*ports_.dictionary, stages_->writer.current()));
  committer_.Start(newest_, epoch_);
  PublishCounters();
  return absl::OkStatus();
}

absl::Status Writer::Replay(const std::function<void(uint64_t, uint64_t)>& progress) {
  changes_.Clear();
  requests_.Clear();
  if (ports_.history != nullptr) ports_.history->Clear();
  auto head = ports_.log->Head();
  if (!head.ok()) return head.status();
  epoch_ = std::max<uint64_t>(head->epoch, 1);
  auto start = FindStart(ports_.log, head->offset, ports_.dictionary, ports_.functions, ports_.limits);
  if (!start.ok()) return start.status();
  stages_ = std::move(start->stages);
  stages_->standing_conditions.SetStopWatch(MonotonicNanos);
  newest_ = start->offset;
  newest_time_us_ = start->time_us;
  for (const RememberedRequestPtr& request : start->requests)
    requests_.Remember(request->id, request->outcome, request->digest);
  ports_.inbox->StartAfter(newest_time_us_);
  FillFeed(newest_);
  uint64_t bytes = 0;
  absl::Status status = ReplayTurns(
      ports_.log, newest_ + 1, head->offset, stages_.get(), [&](TurnResult turn, size_t record_bytes) {
        requests_.Remember(turn.record.batch.request_id, OutcomeOf(turn), turn.record.batch.request_digest);
        newest_time_us_ = turn.record.time_us;
        ports_.feed->Keep(EventsOf(turn.record));
        newest_ = turn.record.offset;
        bytes += record_bytes;
        if (progress && newest_ % kTurnsPerProgress == 0) progress(newest_, head->offset);
        return absl::OkStatus();
      });
  if (!status.ok()) return status;
  ports_.inbox->StartAfter(newest_time_us_);
  if (progress && newest_ > start->offset) progress(newest_, head->offset);
  stages_->cancellation = &cancellation_;
  if (ports_.snapshots != nullptr) ports_.snapshots->Recovered(newest_ - start->offset, bytes);
  return absl::OkStatus();
}

// What watchers may ask for of the turns that a snapshot stands for, as far as the log still has them. The feed
// knows them already where this is not the first recovery.
void Writer::FillFeed(uint64_t up_to) {
  const uint64_t wanted = std::min<uint64_t>(up_to, ports_.limits.run_events_kept);
  const absl::StatusOr<uint64_t> first = ports_.log->First();
  const uint64_t from = std::max<uint64_t>(up_to - wanted + 1, first.ok() ? *first : up_to + 1);
  std::vector<std::vector<RunEvent>> turns;
  for (uint64_t next = from; next <= up_to;) {
    auto entries = ports_.log->Read(next, up_to - next + 1);
    if (!entries.ok() || entries->empty()) break;
    for (const log::LogEntry& entry : *entries) {
      auto record = log::DecodeTurnRecord(entry.offset, entry.data);
      if (!record.ok()) break;
      turns.push_back(EventsOf(*record));
      next = entry.offset + 1;
    }
    if (entries->back().offset + 1 != next) break;
  }
  if (from + turns.size() <= up_to) turns.clear();  // not readable: the state needs none of it
  ports_.feed->BeginAfter(Revision(up_to - turns.size()));
  for (const std::vector<RunEvent>& events : turns) ports_.feed->Keep(events);
}

ServerState Writer::State() const {
  return TakeState(*stages_, requests_, stages_->writer.Freeze(Revision(newest_)), newest_time_us_);
}

void Writer::ResumeCommands() {
  if (ports_.notifications != nullptr) {
    for (const Notification& open : stages_->engine.OpenNotifications()) ports_.notifications->Send(open);
  }
  if (ports_.proxies == nullptr) return;
  for (const engine::CommandUnderWay& open : stages_->engine.OpenCommands()) {
    ports_.proxies->Resume(open.command, open.ending     ? proxy::CommandWish::kEnd
                                         : open.recalled ? proxy::CommandWish::kNotBegin
                                                         : proxy::CommandWish::kDone);
  }
}

absl::Status Writer::Run() {
  const size_t at_most = std::min(ports_.limits.turns_per_commit, kTurnsPerGroup);
  while (fatal_.ok()) {
    std::optional<TimeMicros> deadline = stages_->NextDeadline();
    if (deadline) deadline = std::max(*deadline, next_tick_us_);
    FreeGone();
    next_due_us_ = deadline.value_or(kNever);
    std::vector<PendingBatch> batches = ports_.inbox->PopAll(deadline, at_most);
    if (!batches.empty()) next_due_us_ = 0;
    if (committer_.halted()) fatal_ = Reconcile();
    if (refused_ && batches.empty()) LogTakesNothing(&batches);
    if (!batches.empty()) {
      TakeGroup(std::move(batches));
      GoOnWithRuns();
    } else if (ports_.inbox->closed()) {
      break;
    } else if (deadline && ports_.inbox->Passed(*deadline)) {
      WriteBatch tick;
      tick.clock_tick = true;
      ports_.inbox->Push(std::move(tick), nullptr);
    }
  }
  return End();
}

std::optional<TimeMicros> Writer::NextDue() const {
  if (ports_.inbox->size() > 0 || !committer_.idle()) return 0;
  const TimeMicros due = next_due_us_;
  return due == kNever ? std::nullopt : std::make_optional(due);
}

absl::Status Writer::End() {
  committer_.Wait();
  if (committer_.halted()) {
    const absl::Status status = Reconcile();
    if (fatal_.ok()) fatal_ = status;
  }
  ports_.inbox->Close();
  for (PendingBatch& pending : ports_.inbox->PopAll(0, SIZE_MAX)) pending.done(fatal_);
  return fatal_;
}

// After a refusal, whether the log still refuses: then these are refused, too, before anything is decided that
// would have to be undone by a recovery.
bool Writer::LogTakesNothing(std::vector<PendingBatch>* batches) {
  absl::Status status = fatal_.ok() ? ports_.log->Probe() : fatal_;
  if (status.ok() && lost_) {
    status = fatal_ = Recover(nullptr);
    lost_ = !status.ok();
  }
  refused_ = !status.ok();
  SetLogStatus(status);
  if (status.ok()) return false;
  for (PendingBatch& pending : *batches) {
    if (pending.batch.clock_tick) next_tick_us_ = pending.batch.time_us + kTickPauseUs;
    ++counters_.refused;
    pending.done(status);
  }
  return true;
}

void Writer::SetLogStatus(const absl::Status& status) {
  absl::MutexLock lock(&log_status_mutex_);
  log_status_ = status;
}

absl::Status Writer::LogStatus() const {
  absl::MutexLock lock(&log_status_mutex_);
  return log_status_;
}

void Writer::TakeGroup(std::vector<PendingBatch> batches) {
  if ((refused_ || !ports_.log->CheckPlace().ok()) && LogTakesNothing(&batches)) return;
  DecidedGroup group;
  // A version for each turn costs more than most turns do: only for those who follow queries.
  stages_->freezes = ports_.subscriptions != nullptr && ports_.subscriptions->counters().open > 0;
  for (PendingBatch& pending : batches) Decide(std::move(pending), &group);
  if (!group.turns.empty()) group.version = stages_->writer.Freeze(Revision(newest_));
  Commit(std::move(group));
  PublishCounters();
}

// Runs that had more to do than their turn allows go on between groups, too, not only when no batch waits.
void Writer::GoOnWithRuns() {
  if (!stages_->engine.AwaitsTick() || newest_time_us_ < next_tick_us_) return;
  PendingBatch tick;
  tick.batch.clock_tick = true;
  tick.batch.time_us = newest_time_us_;
  tick.done = [](const absl::StatusOr<BatchOutcome>&) {};
  std::vector<PendingBatch> group;
  group.push_back(std::move(tick));
  TakeGroup(std::move(group));
}

// What is due is tried again after a pause. Said once: no client hears of it.
void Writer::RefusedTick(TimeMicros time_us, const absl::Status& why) {
  next_tick_us_ = time_us + kTickPauseUs;
  const std::string refusal(why.message());
  if (!absl::IsCancelled(why) && refusal != tick_refusal_)
    spdlog::error(
        "what is due by time, or goes on with workflows, is refused and tried again each second: {}",
        refusal);
  tick_refusal_ = refusal;
}

void Writer::Decide(PendingBatch pending, DecidedGroup* group) {
  if (pending.visit) {
    pending.visit(stages_.get(), Revision(newest_));
    group->answers.push_back({BatchOutcome{newest_}, std::move(pending.done)});
    return;
  }
  if (const RememberedRequest* first = requests_.Find(pending.batch.request_id)) {
    if (!first->IsRepeatedBy(pending.batch)) {
      group->answers.push_back(
          {absl::AlreadyExistsError("this request_id was that of another request; take a new one"),
           std::move(pending.done)});
      return;
    }
    BatchOutcome outcome = first->outcome;
    outcome.repeated = true;
    group->answers.push_back({std::move(outcome), std::move(pending.done)});
    return;
  }
  if (pending.prepare) {
    const auto has_document = [this](Document::Kind kind, const std::string& name) {
      return stages_->documents.entries().count({kind, name}) > 0;
    };
    const TurnView view{stages_->writer.current(), Revision(newest_), changes_, has_document};
    if (absl::Status status = pending.prepare(view, &pending.batch); !status.ok()) {
      group->answers.push_back({std::move(status), std::move(pending.done)});
      return;
    }
  }
  // What a large batch changed is taken back most cheaply to a version.
  if (pending.batch.OperationCount() > kLarge) stages_->writer.Freeze(Revision(newest_));
  const bool tick = pending.batch.clock_tick;
  const TimeMicros time_us = pending.batch.time_us;
  DecidedTurn turn;
  auto result = RunTurn(stages_.get(), std::move(pending.batch), newest_ + 1, &turn.record);
  if (!result.ok()) {
    if (tick) RefusedTick(time_us, result.status());
    ++counters_.refused;
    const bool ending = absl::IsCancelled(result.status());
    group->answers.push_back(
        {ending ? absl::UnavailableError("the server ends; the batch was not applied: send it again")
                : result.status(),
         std::move(pending.done)});
    return;
  }
  if (tick) tick_refusal_.clear();
  ++newest_;
  newest_time_us_ = time_us;
  changes_.Add(Revision(newest_), result->delta);
  if (ports_.saw) ports_.saw(result->delta);
  turn.result = *std::move(result);
  turn.outcome = OutcomeOf(turn.result);
  turn.done = std::move(pending.done);
  const WriteBatch& batch = turn.result.record.batch;
  requests_.Remember(batch.request_id, turn.outcome, batch.request_digest);
  group->turns.push_back(std::move(turn));
}

void Writer::Commit(DecidedGroup group) {
  const bool documents = std::any_of(group.turns.begin(), group.turns.end(),
                                     [](const DecidedTurn& t) { return t.result.documents_changed; });
  if (documents) group.catalog = stages_->documents.MakeCatalog(stages_->engine);
  if (ports_.snapshots != nullptr && !group.turns.empty()) {
    size_t bytes = 0;
    for (const DecidedTurn& turn : group.turns) bytes += turn.record.size();
    ports_.snapshots->Appended(group.turns.size(), bytes);
    // Written once the log has these turns.
    if (ports_.snapshots->Due()) {
      ports_.snapshots->Take(TakeState(*stages_, requests_, group.version, newest_time_us_));
    }
  }
  for (GraphVersionPtr& version : committer_.Commit(std::move(group))) {
    if (version.use_count() == 1)
      gone_.push_back(std::move(version));  // others are the history's, or a reader's
  }
}

// Freeing what only an old version holds takes about a tenth of the time of a turn. Nobody waits for it.
void Writer::FreeGone() {
  const auto too_many = [this] {
    return gone_.size() > kGoneAtMost ||
           gone_.back()->replaced_bytes() - gone_.front()->replaced_bytes() > kGoneBytes;
  };
  while (!gone_.empty() && (too_many() || ports_.inbox->size() == 0)) gone_.pop_front();
}

// The log refused what is in flight, or cannot say what it did. What it does not have did not happen; what it
// has did.
absl::Status Writer::Reconcile() {
  Committer::Refused refused = committer_.TakeRefused();
  spdlog::error("the log refused the turns after {}: {}", refused.head,
                std::string(refused.status.message()));
  next_tick_us_ = newest_time_us_ + kTickPauseUs;
  refused_ = true;
  SetLogStatus(refused.status);
  if (ports_.snapshots != nullptr) ports_.snapshots->Discard();
  const absl::Status state = refused.replaced ? refused.status : Recover(nullptr);
  if (state.ok() && newest_ > refused.head) ResumeCommands();
  // What went into files that the next start will not find did not happen either, as far as anybody is told.
  const bool lasts = state.ok() && ports_.log->CheckPlace().ok();
  const auto happened = [&](const BatchOutcome& outcome) { return lasts && outcome.offset <= newest_; };
  for (DecidedGroup& group : refused.groups) {
    for (DecidedTurn& turn : group.turns) {
      if (happened(turn.outcome)) {
        ++counters_.turns;
        ports_.feed->Publish(EventsOf(turn.result.record));
        turn.done(turn.outcome);
      } else {
        ++counters_.refused;
        turn.done(refused.status);
      }
    }
    // A refusal may suppose what did not happen.
    for (HeldAnswer& answer : group.answers) {
      answer.done(answer.outcome.ok() && happened(*answer.outcome) ? answer.outcome : refused.status);
    }
  }
  if (state.ok() || refused.replaced || ports_.log->CheckPlace().ok()) return state;
  lost_ = true;  // what is known can be read on, and the log may be put back
  return absl::OkStatus();
}

void Writer::PublishCounters() {
  counters_.condition_candidates = stages_->standing_conditions.counters().candidates;
  counters_.condition_evaluations = stages_->standing_conditions.counters().evaluations;
  counters_.condition_whole_evaluations = stages_->standing_conditions.counters().whole_evaluations;
  counters_.condition_whole_ns = stages_->standing_conditions.counters().whole_ns;
  counters_.conditions = stages_->standing_conditions.size();
  counters_.live_runs = stages_->engine.live_runs();
}

}  // namespace docent::server
