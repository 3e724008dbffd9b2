#include "kb_server/app/turn_teller.h"

#include <optional>
#include <utility>

#include "kb_server/app/run_events.h"
#include "kb_server/rdf/vocabulary.h"

namespace docent {
namespace {

RobotCommand ToCommand(const CommandEntry& entry) {
  return {entry.id,
          entry.robot,
          entry.operation,
          entry.arguments,
          entry.expected_incarnation,
          entry.guard_revision,
          entry.deadline_us,
          entry.idempotent};
}

}  // namespace

TurnTeller::TurnTeller(RunFeed* feed, RobotProxies* proxies, const Dictionary* dictionary)
    : feed_(*feed), proxies_(proxies), dictionary_(*dictionary), thread_([this] { Loop(); }) {}

TurnTeller::~TurnTeller() {
  {
    absl::MutexLock lock(&mutex_);
    ending_ = true;
  }
  thread_.join();
}

void TurnTeller::Tell(std::vector<DurableTurn> group) {
  const auto room = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return groups_.size() < kGroupsAhead; };
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(&room));
  groups_.push_back(std::move(group));
}

void TurnTeller::WaitUntilTold() {
  const auto told = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return groups_.empty(); };
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(&told));
}

void TurnTeller::Loop() {
  const auto work = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return ending_ || !groups_.empty(); };
  while (true) {
    std::vector<DurableTurn>* group;
    {
      absl::MutexLock lock(&mutex_);
      mutex_.Await(absl::Condition(&work));
      if (groups_.empty()) return;
      group = &groups_.front();  // stays where it is: only this thread takes from the front
    }
    for (DurableTurn& turn : *group) TellTurn(&turn);
    std::vector<DurableTurn> told;
    absl::MutexLock lock(&mutex_);
    told.swap(groups_.front());
    groups_.pop_front();
  }
}

void TurnTeller::TellTurn(DurableTurn* turn) {
  const TurnResult& result = turn->result;
  if (proxies_ != nullptr) {
    // Where the proxies find the adapters is a fact like any other.
    if (std::optional<TermId> address = dictionary_.FindIri(DocentIri("adapterAddress"))) {
      for (const Quad& quad : result.delta.added) {
        if (quad.predicate == *address) TellAddress(quad);
      }
    }
    for (const CommandId& id : result.cancels) proxies_->Cancel(id);
    for (const CommandEntry& entry : result.record.commands) proxies_->Send(ToCommand(entry));
  }
  feed_.Publish(EventsOf(result.record));
  turn->done(turn->outcome);
}

void TurnTeller::TellAddresses(const GraphVersion& version) {
  if (proxies_ == nullptr) return;
  std::optional<TermId> address = dictionary_.FindIri(DocentIri("adapterAddress"));
  if (!address) return;
  version.ForEach({{}, *address, {}, {}}, [this](const Quad& quad) {
    TellAddress(quad);
    return true;
  });
}

void TurnTeller::TellAddress(const Quad& fact) {
  proxies_->SetAddress(RobotId(dictionary_.Decode(fact.subject).lexical),
                       dictionary_.Decode(fact.object).lexical);
}

}  // namespace docent
