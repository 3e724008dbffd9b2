#include "kb_server/clock/clock_source.h"

#include <pthread.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "graph/rdf/vocabulary.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

// How soon it is noticed that the wall clock was set.
constexpr TimeMicros kPollUs = 1'000'000;
// What the two clocks may drift apart without a look.
constexpr TimeMicros kSetUs = 200'000;

}  // namespace

void ClockSource::Start() {
  thread_ = std::thread([this] {
    pthread_setname_np(pthread_self(), "clock");
    Run();
  });
}

void ClockSource::Stop() {
  {
    absl::MutexLock lock(&mutex_);
    stopped_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

bool ClockSource::Due() const {
  const TimeMicros wall = wall_.Now(), steady = steady_.Now();
  const TimeMicros set = wall - steady - ahead_us_;
  return asked_ || set > kSetUs || set < -kSetUs || (next_wall_us_ && wall >= *next_wall_us_) ||
         (next_steady_us_ && steady >= *next_steady_us_);
}

void ClockSource::Run() {
  while (true) {
    {
      absl::MutexLock lock(&mutex_);
      TimeMicros wait = kPollUs;
      if (next_wall_us_) wait = std::min(wait, *next_wall_us_ - wall_.Now());
      if (next_steady_us_) wait = std::min(wait, *next_steady_us_ - steady_.Now());
      const auto wake = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
        return stopped_ || ((asked_ || woken_) && !looking_);
      };
      mutex_.AwaitWithTimeout(absl::Condition(&wake),
                              absl::Microseconds(looking_ ? kPollUs : std::max<TimeMicros>(wait, 0)));
      if (stopped_) return;
      woken_ = false;
      if (looking_ || !Due()) continue;
      looking_ = true;
      asked_ = false;
    }
    Look();
  }
}

void ClockSource::Look() {
  WriteBatch batch;
  batch.source = kClockGraph;
  batch.mode = WriteBatch::Mode::kLoad;
  const auto occurred = std::make_shared<bool>(false);
  inbox_.Push(
      std::move(batch),
      [this, occurred](const absl::StatusOr<BatchOutcome>& outcome) { Looked(outcome, *occurred); },
      [this, occurred](const TurnView& view, WriteBatch* filled) -> absl::Status {
        const ClockTimes now{wall_.Now(), steady_.Now(), simulated_};
        ClockFacts facts = ClockFactsAt(now, dictionary_, view.graph);
        *occurred = facts.occurs;
        for (const std::string& news : facts.news) spdlog::warn("{}", news);
        {
          absl::MutexLock lock(&mutex_);
          ahead_us_ = now.wall_us - now.steady_us;
          next_wall_us_ = facts.next_wall_us;
          next_steady_us_ = facts.next_steady_us;
        }
        if (facts.operations.empty()) return absl::AlreadyExistsError("the graph has the times as they are");
        filled->operations = std::move(facts.operations);
        return absl::OkStatus();
      });
}

void ClockSource::Looked(const absl::StatusOr<BatchOutcome>& outcome, bool occurred) {
  absl::MutexLock lock(&mutex_);
  looking_ = false;
  if (outcome.ok()) {
    asked_ = asked_ || occurred;  // what occurred is taken back
  } else if (!absl::IsAlreadyExists(outcome.status())) {
    // refused: the disk may be full. The next second tries again.
    next_wall_us_ = wall_.Now() + kPollUs;
  }
}

bool ClockSource::Concerns(const Quad& quad) {
  if (!type_) type_ = dictionary_.FindIri(kRdfType);
  if (type_ && quad.predicate == *type_) {
    const auto [known, is_new] = classes_.try_emplace(quad.object, false);
    if (is_new) known->second = dictionary_.Decode(quad.object) == Term::Iri(DocentIri("TimeTrigger"));
    return known->second;
  }
  const auto [known, is_new] = predicates_.try_emplace(quad.predicate, false);
  if (is_new) known->second = DescribesTime(dictionary_.Decode(quad.predicate).lexical);
  return known->second;
}

void ClockSource::Saw(const Delta& delta) {
  const auto concerns = [this](const Quad& quad) { return Concerns(quad); };
  if (!std::any_of(delta.added.begin(), delta.added.end(), concerns) &&
      !std::any_of(delta.removed.begin(), delta.removed.end(), concerns))
    return;
  absl::MutexLock lock(&mutex_);
  asked_ = true;
}

void ClockSource::Wake() {
  absl::MutexLock lock(&mutex_);
  woken_ = true;
}

std::optional<TimeMicros> ClockSource::NextDue() const {
  absl::MutexLock lock(&mutex_);
  if (asked_ || looking_) return 0;
  std::optional<TimeMicros> due = next_steady_us_;
  if (next_wall_us_) due = std::min(due.value_or(INT64_MAX), *next_wall_us_ - ahead_us_);
  return due;
}

}  // namespace docent::server
