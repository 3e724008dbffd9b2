#include "kb_server/subscriptions/subscriptions.h"

#include <pthread.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/cancellation.h"
#include "graph/base/diagnostic.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/subscriptions/subscribed_query.h"
#include "kb_server/work/condition_cost.h"
#include "kb_server/work/known_prefixes.h"

namespace docent::server {
namespace {

using sparql::Algebra;
using sparql::Expression;
using sparql::PatternTerm;

// Turns that wait are looked at before subscribers are woken, up to so many and so long after the first change.
constexpr size_t kTurnsTogether = 16;
constexpr absl::Duration kUnheard = absl::Milliseconds(5);
constexpr size_t kCopies = 3;  // of a query: itself, its plan, what is known of its triggers

void AddConstant(const PatternTerm& term, std::vector<Term>& constants) {
  const bool empty = term.term().IsIri() && term.term().lexical.empty();
  if (!term.IsVariable() && !empty) constants.push_back(term.term());
}

void AddConstants(const sparql::Path& path, std::vector<Term>& constants) {
  if (path.kind == sparql::Path::Kind::kIri) constants.push_back(path.iri);
  for (const sparql::Path& child : path.children) AddConstants(child, constants);
}

// Every term that the query names, wherever it stands.
std::vector<Term> ConstantsOf(const Algebra& whole) {
  std::vector<Term> constants;
  sparql::AnyNode(whole, [&](const Algebra& node) {
    for (const sparql::TriplePattern& t : node.triples) {
      for (const PatternTerm* term : {&t.subject, &t.predicate, &t.object}) AddConstant(*term, constants);
    }
    for (const PatternTerm* term : {&node.subject, &node.object, &node.name}) AddConstant(*term, constants);
    if (node.kind == Algebra::Kind::kPath) AddConstants(node.path, constants);
    for (const auto& row : node.rows) {
      for (const auto& value : row) {
        if (value) constants.push_back(*value);
      }
    }
    sparql::ForEachExpression(node, [&](const Expression& e) {
      if (e.kind == Expression::Kind::kTerm) constants.push_back(e.term);
    });
    return false;
  });
  return constants;
}

}  // namespace

// One evaluation: it ends at its time limit, and when all of this ends.
class Subscriptions::Evaluating {
 public:
  explicit Evaluating(Subscriptions* all)
      : all_(*all),
        cancellation_(
            std::chrono::milliseconds(all->settings_.subscription_limits.subscription_evaluation_ms)) {
    absl::MutexLock lock(&all_.mutex_);
    all_.evaluating_ = &cancellation_;
    if (all_.stopping_) cancellation_.Cancel();
  }
  ~Evaluating() {
    absl::MutexLock lock(&all_.mutex_);
    all_.evaluating_ = nullptr;
  }
  Cancellation& cancellation() { return cancellation_; }

 private:
  Subscriptions& all_;
  Cancellation cancellation_;
};

Subscriptions::Subscriptions(const Settings& settings) : settings_(settings), names_(settings.dictionary) {
  ForgetKept();
  version_ = std::make_shared<const GraphVersion>();
  newest_ = version_;
  newest_time_us_ = settings.clock->Now();
  thread_ = std::thread([this] { Run(); });
}

Subscriptions::~Subscriptions() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
    if (evaluating_ != nullptr) evaluating_->Cancel();
  }
  thread_.join();
}

void Subscriptions::Publish(GraphVersionPtr version, const Delta& delta, TimeMicros time_us) {
  absl::MutexLock lock(&mutex_);
  newest_ = version;
  newest_time_us_ = time_us;
  if (!followed_ && !busy_ && turns_.empty() && openings_.empty()) {
    counters_.revision = newest_->revision().value();
    return;  // nobody is woken for nothing
  }
  if (turns_.size() < settings_.subscription_limits.subscription_backlog) {
    turns_.emplace_back().first_us = time_us;
  } else {
    ++counters_.coalesced;
  }
  Turn& turn = turns_.back();
  turn.version = std::move(version);
  turn.changes.Add(delta);
  turn.time_us = time_us;
}

void Subscriptions::PublishWhole(GraphVersionPtr version) {
  absl::MutexLock lock(&mutex_);
  newest_ = version;
  newest_time_us_ = settings_.clock->Now();
  Turn& turn = turns_.emplace_back();
  turn.version = std::move(version);
  turn.time_us = turn.first_us = newest_time_us_;
  turn.whole = true;
}

void Subscriptions::Open(const SubscribedQuery& query, std::shared_ptr<Subscriber> subscriber, Opened done,
                         ClientPtr client) {
  const auto known = settings_.prefixes == nullptr ? nullptr : settings_.prefixes->Get();
  sparql::ParseOptions options = sparql::ParseOptionsWith(settings_.limits, settings_.functions);
  options.known = known.get();
  const auto memory =
      std::make_shared<MemoryUse>(settings_.limits.query_memory_bytes, settings_.query_memory);
  options.memory = memory.get();
  sparql::ParsedQuery parsed = sparql::ParseQuery(query.text, options);
  if (!parsed.ok()) {
    done(ToStatus(parsed, query.text));
    return;
  }
  if (parsed.query.form != sparql::Query::Form::kSelect && parsed.query.form != sparql::Query::Form::kAsk) {
    done(absl::InvalidArgumentError("only ASK and SELECT can be followed"));
    return;
  }
  size_t open = 0;
  {
    absl::MutexLock lock(&subscribers_mutex_);
    open = subscribers_.size();
  }
  {
    absl::MutexLock lock(&mutex_);
    if (open + openings_.size() < settings_.subscription_limits.subscriptions_open) {
      openings_.push_back({query, std::move(parsed.query), memory, std::move(subscriber), std::move(done),
                           std::move(client)});
      return;
    }
  }
  done(absl::ResourceExhaustedError(
      absl::StrCat("the limit subscriptions_open is ", settings_.subscription_limits.subscriptions_open)));
}

void Subscriptions::Drain() {
  const auto idle = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return turns_.empty() && openings_.empty() && !busy_;
  };
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(&idle));
}

void Subscriptions::Run() {
  pthread_setname_np(pthread_self(), "subscribers");
  size_t turns_together = 0;
  while (true) {
    std::optional<Turn> turn;
    std::deque<Opening> openings;
    std::vector<std::weak_ptr<Subscriber>> due;
    bool more_turns = false;
    {
      absl::MutexLock lock(&mutex_);
      busy_ = false;
      followed_ = !by_query_.empty();
      absl::Time until = absl::Now() + absl::Seconds(1);  // an alarm that is set meanwhile is at most so late
      if (!alarms_.empty()) until = std::min(until, alarms_.begin()->first);
      if (!ripening_.empty())
        until = std::min(until,
                         absl::Now() + absl::Microseconds(ripening_.begin()->first - settings_.clock->Now()));
      const auto work = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return HasWork(); };
      mutex_.AwaitWithDeadline(absl::Condition(&work), until);
      if (stopping_) return;
      busy_ = true;
      while (!alarms_.empty() && alarms_.begin()->first <= absl::Now()) {
        due.push_back(std::move(alarms_.begin()->second));
        alarms_.erase(alarms_.begin());
      }
      if (!turns_.empty()) {
        turn = std::move(turns_.front());
        turns_.pop_front();
      } else {
        version_ = newest_;
        time_us_ = newest_time_us_;
      }
      // who opened now has seen versions up to the newest: not before all turns are looked at
      more_turns = !turns_.empty();
      if (!more_turns) {
        openings.swap(openings_);
        now_us_ = std::max(time_us_, settings_.clock->Now());
      }
    }
    if (turn) Process(*std::move(turn));
    if (!more_turns) Ripen(now_us_);
    const bool unheard = !changed_.empty() && absl::Now() - changed_since_ > kUnheard;
    if (!more_turns || unheard || ++turns_together == kTurnsTogether) {
      WakeSubscribers();
      turns_together = 0;
    }
    for (Opening& opening : openings) OpenNow(std::move(opening));
    if (!due.empty()) WakeDue(due);
    DropIdle();
  }
}

void Subscriptions::Process(Turn turn) {
  Ripen(turn.first_us);
  version_ = turn.version;
  time_us_ = turn.time_us;
  std::vector<uint32_t> anew = LearnConstants();
  if (!turn.whole) {
    const Delta delta = turn.changes.Net();
    if (!UpdateKept(delta)) {
      for (const auto& [id, number] : by_constraint_) anew.push_back(number);
      ForgetKept();
    }
    for (const uint32_t number : Touched(delta)) {
      if (by_number_[number] == nullptr) continue;  // it went to make room
      Evaluate(*by_number_[number]).IgnoreError();  // its subscribers know
    }
  } else {
    anew.clear();
    for (const auto& subscription : by_number_) {
      if (subscription != nullptr) anew.push_back(subscription->number);
    }
    ForgetKept();
  }
  for (const uint32_t number : anew) {
    if (by_number_[number] != nullptr) BeginAnew(*by_number_[number]);
  }
  counters_.revision = version_->revision().value();
}

std::vector<uint32_t> Subscriptions::LearnConstants() {
  std::vector<uint32_t> learnt;
  const size_t size = settings_.dictionary->size();
  for (; dictionary_size_ < size && !awaited_.empty(); ++dictionary_size_) {
    const TermId id = TermId::Make(settings_.dictionary->EntryAt(dictionary_size_).tag, dictionary_size_);
    const auto found = awaited_.find(settings_.dictionary->Decode(id));
    if (found == awaited_.end()) continue;
    for (const uint32_t number : std::vector<uint32_t>(found->second)) {
      Forget(*by_number_[number]);  // which forgets that it waits
      learnt.push_back(number);
    }
  }
  dictionary_size_ = size;
  return learnt;
}

absl::Status Subscriptions::Prepare(Subscription& subscription) {
  if (awaited_.empty()) dictionary_size_ = settings_.dictionary->size();  // what is in it now, Find finds
  for (Term& term : ConstantsOf(*subscription.query.algebra)) {
    if (settings_.dictionary->Find(term)) continue;
    std::vector<uint32_t>& waiting = awaited_[term];
    if (std::find(waiting.begin(), waiting.end(), subscription.number) != waiting.end()) continue;
    waiting.push_back(subscription.number);
    subscription.unknown.push_back(std::move(term));
  }
  sparql::PrepareOptions options;
  options.default_graph = settings_.default_graph;
  options.functions = settings_.functions;
  options.memory_bytes = settings_.limits.query_memory_bytes;
  auto prepared = sparql::PreparedQuery::Prepare(subscription.query, *settings_.dictionary, options);
  if (!prepared.ok()) return prepared.status();
  subscription.prepared = *std::move(prepared);
  return absl::OkStatus();
}

absl::Status Subscriptions::Begin(Subscription& subscription) {
  if (absl::Status status = Evaluate(subscription); !status.ok()) return status;
  if (!Keep(subscription)) {
    Watch(subscription);
    return absl::OkStatus();
  }
  subscription.prepared.reset();
  absl::Status fits = Charge(subscription);
  if (!fits.ok()) FailAll(subscription, fits);
  return fits;
}

void Subscriptions::BeginAnew(Subscription& subscription) {
  Forget(subscription);
  if (absl::Status status = Prepare(subscription); !status.ok()) return FailAll(subscription, status);
  Begin(subscription).IgnoreError();
}

// Evaluates once more, for the set keeps other things than rows; what it will keep, Evaluate has bounded.
bool Subscriptions::Keep(Subscription& subscription) {
  if (!subscription.form || !subscription.unknown.empty()) return false;
  names_.FollowBase();
  Evaluating evaluating(this);
  Cancellation& cancellation = evaluating.cancellation();
  const auto id =
      kept_->Register(subscription.query, *version_, {subscription.form->keys, time_us_, &cancellation});
  if (!id.ok()) {
    kept_->Rollback();
    return false;
  }
  kept_->Commit();
  subscription.kept = *id;
  by_constraint_.emplace(*id, subscription.number);
  return true;
}

std::string Subscriptions::WarningOf(const Subscription& subscription, absl::Duration took) const {
  if (subscription.analysis.is_volatile) {
    return "it asks for the time or for chance: both are those of the newest change, and the passing of time "
           "alone tells nothing; to "
           "wait for what lasts use at_least_ms";
  }
  const std::string why = WhyWhole(subscription.analysis);
  if (why.empty()) return "";
  return absl::StrCat("it is expensive: ", why, "; beginning it took ",
                      absl::FormatDuration(absl::Trunc(took, absl::Microseconds(1))), " on ",
                      version_->size(), " facts; see docent_subscription_seconds_total in /metrics");
}

void Subscriptions::ForgetKept() {
  for (const auto& [id, number] : by_constraint_) by_number_[number]->kept.reset();
  by_constraint_.clear();
  kept_ = std::make_unique<conditions::StandingConditions>(names_, settings_.functions);
}

// What a changed quad must look like to matter to a trigger; nullopt: none can yet.
std::optional<matching::MatchPattern> Subscriptions::MatchOf(const matching::TriggerSource& source) const {
  matching::MatchPattern match;
  const std::array<std::pair<const PatternTerm*, TermId*>, 4> places = {
      {{&source.pattern.subject, &match.constants.subject},
       {&source.pattern.predicate, &match.constants.predicate},
       {&source.pattern.object, &match.constants.object},
       {&source.graph, &match.constants.graph}}};
  for (const auto& [term, id] : places) {
    if (term->IsVariable()) continue;
    const auto known = settings_.dictionary->Find(term->term());
    if (!known) return std::nullopt;
    *id = *known;
  }
  return match;
}

void Subscriptions::Watch(Subscription& subscription) {
  const std::vector<matching::TriggerSource>& triggers = subscription.analysis.triggers;
  for (uint32_t i = 0; i < triggers.size(); ++i) {
    if (const auto match = MatchOf(triggers[i])) {
      subscription.watches.push_back(watches_.Add(*match, {subscription.number, i}));
    } else if (triggers[i].required) {
      return Unwatch(subscription);  // without that term there is no solution
    }
  }
  if (subscription.analysis.is_volatile) volatile_.insert(subscription.number);
}

void Subscriptions::Unwatch(Subscription& subscription) {
  for (const matching::PatternIndex::Handle handle : subscription.watches) watches_.Remove(handle);
  subscription.watches.clear();
  volatile_.erase(subscription.number);
}

void Subscriptions::Forget(Subscription& subscription) {
  Unwatch(subscription);
  if (subscription.kept) {
    kept_->Remove(*subscription.kept);
    kept_->Commit();
    by_constraint_.erase(*subscription.kept);
    subscription.kept.reset();
  }
  for (const Term& term : subscription.unknown) {
    const auto found = awaited_.find(term);
    std::erase(found->second, subscription.number);
    if (found->second.empty()) awaited_.erase(found);
  }
  subscription.unknown.clear();
}

bool Subscriptions::UpdateKept(const Delta& delta) {
  if (by_constraint_.empty()) return true;
  names_.FollowBase();
  Evaluating evaluating(this);
  Cancellation& cancellation = evaluating.cancellation();
  const uint64_t before = kept_->evaluations();
  const auto changes = kept_->Update(*version_, delta, time_us_, &cancellation);
  counters_.evaluations += kept_->evaluations() - before;
  if (!changes.ok()) return false;
  kept_->Commit();
  for (const conditions::ConditionChange& change : *changes) {
    const auto found = by_constraint_.find(change.id);
    if (found == by_constraint_.end()) continue;  // it went to make room
    Subscription& subscription = *by_number_[found->second];
    bool changed = false;
    if (subscription.answer->is_boolean()) {
      changed = subscription.answer->SetBoolean(
          version_->revision(), change.edge == conditions::ConditionChange::Edge::kRose, time_us_);
    } else {
      changed =
          subscription.answer->ChangeRows(version_->revision(), subscription.form->RowsOf(change.appeared),
                                          subscription.form->RowsOf(change.disappeared), time_us_);
      absl::Status fits = subscription.answer->size() > settings_.subscription_limits.subscription_rows
                              ? TooManyRows()
                              : Charge(subscription);
      if (!fits.ok()) {
        FailAll(subscription, fits);
        continue;
      }
    }
    NoteRipening(subscription);
    if (changed) Changed(subscription);
  }
  return true;
}

bool Subscriptions::MayTurn(matching::PatternIndex::Reference reference, bool added) const {
  const Subscription& subscription = *by_number_[reference.owner];
  const matching::Polarity polarity = subscription.analysis.triggers[reference.pattern].polarity;
  if (!subscription.answer->is_boolean() || polarity == matching::Polarity::kBoth) return true;
  const bool helps = added == (polarity == matching::Polarity::kPositive);
  return helps != subscription.answer->boolean();
}

absl::btree_set<uint32_t> Subscriptions::Touched(const Delta& delta) const {
  absl::btree_set<uint32_t> touched(volatile_.begin(), volatile_.end());
  const auto look = [&](const Quad& quad, bool added) {
    watches_.ForEachMatch(quad, [&](matching::PatternIndex::Reference reference) {
      if (MayTurn(reference, added)) touched.insert(reference.owner);
    });
  };
  for (const Quad& quad : delta.added) look(quad, true);
  for (const Quad& quad : delta.removed) look(quad, false);
  return touched;
}

absl::Status Subscriptions::TooManyRows() const {
  return absl::ResourceExhaustedError(
      absl::StrCat("the answer has more rows than the limit subscription_rows = ",
                   settings_.subscription_limits.subscription_rows));
}

absl::Status Subscriptions::Evaluate(Subscription& subscription) {
  ++counters_.evaluations;
  const absl::Time start = absl::Now();
  Evaluating evaluating(this);
  Cancellation& cancellation = evaluating.cancellation();
  sparql::RunOptions run;
  run.version = version_.get();
  run.cancellation = &cancellation;
  run.now_us = time_us_;
  run.seed = version_->revision().value();
  bool changed = false;
  absl::Status status;
  if (subscription.answer->is_boolean()) {
    const auto holds = subscription.prepared->Ask(run);
    status = holds.status();
    if (holds.ok()) changed = subscription.answer->SetBoolean(version_->revision(), *holds, time_us_);
  } else {
    SubscriptionAnswer::Rows rows;
    size_t count = 0;
    status = subscription.prepared->Select(run, {}, [&](absl::Span<const TermId> row) {
      SubscriptionAnswer::Row ids(row.begin(), row.end());
      for (TermId& id : ids) {
        if (id.tag() == TermId::Tag::kLocal)
          id = subscription.answer->Local(subscription.prepared->Decode(id));
      }
      ++rows[ids];
      return ++count <= settings_.subscription_limits.subscription_rows;
    });
    if (status.ok() && count > settings_.subscription_limits.subscription_rows) status = TooManyRows();
    if (status.ok()) changed = subscription.answer->SetRows(version_->revision(), std::move(rows), time_us_);
  }
  if (status.ok()) status = Charge(subscription);
  subscription.prepared->Stop();
  counters_.evaluation_ns +=
      static_cast<uint64_t>(std::max<int64_t>(0, absl::ToInt64Nanoseconds(absl::Now() - start)));
  if (absl::IsDeadlineExceeded(status)) {
    status = absl::DeadlineExceededError(absl::StrCat(
        "the query took longer than the limit subscription_evaluation_ms = ",
        settings_.subscription_limits.subscription_evaluation_ms, "; ask for less, or query now and then"));
  }
  if (!status.ok()) {
    FailAll(subscription, status);
    return status;
  }
  NoteRipening(subscription);
  if (changed) Changed(subscription);
  return status;
}

void Subscriptions::NoteRipening(Subscription& subscription) {
  const std::optional<TimeMicros> next = subscription.answer->ripens_at_us();
  if (next == subscription.ripens_at_us) return;
  if (subscription.ripens_at_us) ripening_.erase({*subscription.ripens_at_us, subscription.number});
  if (next) ripening_.emplace(*next, subscription.number);
  subscription.ripens_at_us = next;
}

void Subscriptions::Ripen(TimeMicros now_us) {
  while (!ripening_.empty() && ripening_.begin()->first <= now_us) {
    Subscription& subscription = *by_number_[ripening_.begin()->second];
    if (subscription.answer->Ripen(version_->revision(), now_us)) Changed(subscription);
    NoteRipening(subscription);
  }
}

absl::StatusOr<Subscriptions::Subscription*> Subscriptions::FindOrMake(Opening* opening) {
  const SubscribedQuery& followed = opening->followed;
  if (const auto known = by_query_.find(followed); known != by_query_.end())
    return by_number_[known->second].get();
  auto subscription = std::make_unique<Subscription>();
  subscription->followed = followed;
  subscription->payer = opening->client.get();
  subscription->query = std::move(opening->query);
  subscription->query_bytes = followed.text.size() + kCopies * opening->memory->used();
  subscription->analysis =
      matching::AnalyseTriggers(matching::WithoutModifiers(*subscription->query.algebra));
  if (settings_.default_graph == sparql::DefaultGraph::kUnion)
    subscription->form = SubscribedFormOf(subscription->query, subscription->analysis);
  if (free_.empty()) {
    subscription->number = static_cast<uint32_t>(by_number_.size());
    by_number_.emplace_back();
  } else {
    subscription->number = free_.back();
    free_.pop_back();
  }
  const uint32_t number = subscription->number;
  Subscription* made = subscription.get();
  by_number_[number] = std::move(subscription);
  by_query_[followed] = number;
  counters_.queries = by_query_.size();
  if (absl::Status status = Prepare(*made); !status.ok()) {
    Drop(number);
    return status;
  }
  made->answer = std::make_shared<SubscriptionAnswer>(
      next_answer_++, made->query.form == sparql::Query::Form::kAsk, made->prepared->variables(),
      settings_.dictionary, settings_.subscription_limits, followed.at_least_us, all_kept_, all_wholes_);
  return made;
}

void Subscriptions::OpenNow(Opening opening) {
  auto subscription = FindOrMake(&opening);
  if (!subscription.ok()) {
    opening.done(subscription.status());
    return;
  }
  const uint32_t number = (*subscription)->number;
  const SubscriptionAnswerPtr answer = (*subscription)->answer;
  {
    absl::MutexLock lock(&subscribers_mutex_);
    subscribers_of_.resize(by_number_.size());
    subscribers_[opening.subscriber] = {number, static_cast<uint32_t>(subscribers_of_[number].size())};
    subscribers_of_[number].push_back(opening.subscriber);
    counters_.open = subscribers_.size();
  }
  NoteIdle(**subscription, absl::InfiniteFuture());
  absl::Status status;
  if (!answer->evaluated()) {
    const absl::Time start = absl::Now();
    status = Begin(**subscription);
    if (status.ok()) answer->SetWarning(WarningOf(**subscription, absl::Now() - start));
  }
  Ripen(now_us_);  // what has been so since before the last turn
  const bool there = opening.done(status.ok() ? absl::StatusOr<SubscriptionAnswerPtr>(answer) : status);
  if (!there) Close(opening.subscriber);
}

void Subscriptions::Drop(uint32_t number) {
  Subscription& subscription = *by_number_[number];
  Forget(subscription);
  if (subscription.ripens_at_us) ripening_.erase({*subscription.ripens_at_us, number});
  NoteIdle(subscription, absl::InfiniteFuture());
  SetCharged(subscription, 0);
  by_query_.erase(subscription.followed);
  counters_.queries = by_query_.size();
  by_number_[number].reset();
  free_.push_back(number);
}

}  // namespace docent::server
