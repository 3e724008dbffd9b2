#include "kb_server/service/subscriptions.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "kb_server/base/diagnostic.h"
#include "kb_server/sparql/algebra_walk.h"
#include "kb_server/sparql/parser.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent {
namespace {

using sparql::Algebra;
using sparql::Expression;
using sparql::PatternTerm;

constexpr absl::Duration kLinger = absl::Seconds(60);  // a query that nobody follows is kept for so long
constexpr size_t kMostSeeds = 16;                       // changes of one turn that are tried one by one
constexpr size_t kIdleKept = 1000;                     // and so many of them

void AddConstant(const PatternTerm& term, std::vector<Term>& constants) {
  const bool empty = term.term.IsIri() && term.term.lexical.empty();
  if (!term.IsVariable() && !empty) constants.push_back(term.term);
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

// A comparison of `name` with a number in the outermost filters: what its values have to satisfy.
std::optional<NumberGuard> GuardOf(const Algebra& where, const std::string& name, const Dictionary& dictionary) {
  std::optional<NumberGuard> guard;
  const auto look = [&](const Expression& e, const auto& self) -> void {
    if (e.kind == Expression::Kind::kAnd) {
      for (const auto& argument : e.arguments) self(*argument, self);
      return;
    }
    static constexpr std::pair<Expression::Kind, Comparison> kOrders[] = {
        {Expression::Kind::kLess, Comparison::kLess},
        {Expression::Kind::kLessOrEqual, Comparison::kLessOrEqual},
        {Expression::Kind::kGreater, Comparison::kGreater},
        {Expression::Kind::kGreaterOrEqual, Comparison::kGreaterOrEqual}};
    for (const auto& [kind, order] : kOrders) {
      if (e.kind != kind) continue;
      const Expression& left = *e.arguments[0];
      const Expression& right = *e.arguments[1];
      if (left.kind != Expression::Kind::kVariable || left.variable.name != name ||
          right.kind != Expression::Kind::kTerm)
        continue;
      const auto id = dictionary.Find(right.term);
      if (!id || ViewNumber(*id).kind != NumberView::Kind::kNumber) continue;
      guard = NumberGuard{order, ViewNumber(*id).value};
    }
  };
  for (const Algebra* node = &where; node->kind == Algebra::Kind::kFilter; node = node->children[0].get())
    look(*node->expression, look);
  return guard;
}

// What `quad` binds of the variables that the trigger may bind; false where it is no match after all.
bool SeedsOf(const TriggerSource& source, const Quad& quad, std::vector<std::string>& names,
                         std::vector<TermId>& values) {
  const std::array<std::pair<const PatternTerm*, TermId>, 4> places = {{{&source.pattern.subject, quad.subject},
                                                                        {&source.pattern.predicate, quad.predicate},
                                                                        {&source.pattern.object, quad.object},
                                                                        {&source.graph, quad.graph}}};
  for (const std::string& name : source.seeds) {
    if (name.empty() || name[0] == '.') continue;
    TermId value;
    for (const auto& [term, id] : places) {
      if (!term->IsVariable() || term->variable->name != name) continue;
      if (!value.IsNone() && value != id) return false;
      value = id;
    }
    if (value.IsNone()) continue;
    names.push_back(name);
    values.push_back(value);
  }
  return true;
}

}  // namespace

struct Subscriptions::Standing {
  uint32_t number = 0;
  std::string text;
  sparql::Query query;
  std::vector<Term> unknown;  // constants that the dictionary did not know when it was prepared
  std::unique_ptr<sparql::PreparedQuery> prepared;
  TriggerAnalysis analysis;
  std::vector<std::optional<MatchPattern>> matches;  // of the triggers
  std::vector<PatternIndex::Handle> watches;
  StandingAnswerPtr answer;
  // ASK: the query with what a trigger binds, by trigger, made when first needed; and while it holds a solution.
  std::vector<std::unique_ptr<sparql::PreparedQuery>> seeded;
  std::vector<std::pair<std::string, TermId>> witness;
  absl::Time idle_since = absl::InfiniteFuture();
};

Subscriptions::Subscriptions(const Settings& settings) : settings_(settings) {
  version_ = std::make_shared<const GraphVersion>();
  newest_ = version_;
  thread_ = std::thread([this] { Run(); });
}

Subscriptions::~Subscriptions() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
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
    turns_.emplace_back();
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
  turn.time_us = newest_time_us_;
  turn.whole = true;
}

void Subscriptions::Open(const std::string& text, std::shared_ptr<Follower> follower, Opened done) {
  sparql::ParseOptions options;
  options.prefixes = sparql::WellKnownPrefixes();
  options.limits = settings_.limits;
  sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
  if (!parsed.ok()) return done(ToStatus(parsed.diagnostics, text));
  if (parsed.query.form != sparql::Query::Form::kSelect && parsed.query.form != sparql::Query::Form::kAsk)
    return done(absl::InvalidArgumentError("only ASK and SELECT can be followed"));
  {
    absl::MutexLock lock(&followers_mutex_);
    if (followers_.size() >= settings_.subscription_limits.subscriptions_open) {
      return done(absl::ResourceExhaustedError(
          absl::StrCat("the limit subscriptions_open is ", settings_.subscription_limits.subscriptions_open)));
    }
  }
  absl::MutexLock lock(&mutex_);
  openings_.push_back({text, std::move(parsed.query), std::move(follower), std::move(done)});
}

void Subscriptions::Close(const std::shared_ptr<Follower>& follower) {
  absl::MutexLock lock(&followers_mutex_);
  const auto found = followers_.find(follower);
  if (found == followers_.end()) return;
  by_standing_[found->second].erase(follower);
  followers_.erase(found);
  counters_.open = followers_.size();
}

void Subscriptions::WakeAt(absl::Time time, std::weak_ptr<Follower> follower) {
  absl::MutexLock lock(&mutex_);
  alarms_.emplace(time, std::move(follower));
}

void Subscriptions::Drain() {
  const auto idle = [this]()
                        ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return turns_.empty() && openings_.empty() && !busy_; };
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(&idle));
}

void Subscriptions::Run() {
  while (true) {
    std::optional<Turn> turn;
    std::deque<Opening> openings;
    std::vector<std::weak_ptr<Follower>> due;
    {
      absl::MutexLock lock(&mutex_);
      busy_ = false;
      followed_ = !by_text_.empty();
      absl::Time until = absl::Now() + absl::Seconds(1);  // an alarm that is set meanwhile is at most so late
      if (!alarms_.empty()) until = std::min(until, alarms_.begin()->first);
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
      if (turns_.empty()) openings.swap(openings_);
    }
    if (turn) Process(*std::move(turn));
    for (Opening& opening : openings) OpenNow(std::move(opening));
    for (const std::weak_ptr<Follower>& follower : due) {
      const std::shared_ptr<Follower> alive = follower.lock();
      absl::MutexLock lock(&followers_mutex_);
      if (alive != nullptr && followers_.contains(alive)) alive->Wake();
    }
    DropIdle();
  }
}

void Subscriptions::Process(Turn turn) {
  version_ = turn.version;
  time_us_ = turn.time_us;
  TouchedSet touched;
  LearnConstants();
  if (turn.whole) {
    for (const auto& standing : standing_) {
      if (standing != nullptr) touched[standing->number].whole = true;
    }
  } else {
    Gather(turn.changes.Net(), touched);
  }
  for (const auto& [number, why] : touched) {
    if (standing_[number] != nullptr) Evaluate(*standing_[number], why);
  }
  counters_.revision = version_->revision().value();
}

void Subscriptions::LearnConstants() {
  if (incomplete_.empty() || settings_.dictionary->size() == dictionary_size_) return;
  dictionary_size_ = settings_.dictionary->size();
  std::vector<uint32_t> learnt;
  for (uint32_t number : incomplete_) {
    const std::vector<Term>& unknown = standing_[number]->unknown;
    if (std::any_of(unknown.begin(), unknown.end(),
                    [this](const Term& term) { return settings_.dictionary->Find(term).has_value(); }))
      learnt.push_back(number);
  }
  for (uint32_t number : learnt) {
    Standing& standing = *standing_[number];
    Unwatch(standing);
    if (absl::Status status = Prepare(standing); !status.ok()) {
      FailAll(standing, status);
      continue;
    }
    Watch(standing);
  }
}

absl::Status Subscriptions::Prepare(Standing& standing) {
  standing.unknown.clear();
  for (const Term& term : ConstantsOf(*standing.query.algebra)) {
    if (!settings_.dictionary->Find(term)) standing.unknown.push_back(term);
  }
  if (standing.unknown.empty()) {
    incomplete_.erase(standing.number);
  } else {
    incomplete_.insert(standing.number);
  }
  sparql::PrepareOptions options;
  options.default_graph = settings_.default_graph;
  options.functions = settings_.functions;
  options.memory_bytes = settings_.limits.query_memory_bytes;
  auto prepared = sparql::PreparedQuery::Prepare(standing.query, *settings_.dictionary, options);
  if (!prepared.ok()) return prepared.status();
  standing.prepared = *std::move(prepared);
  standing.seeded.clear();
  return absl::OkStatus();
}

// What a changed quad must look like to matter to a trigger; nullopt: none can yet.
std::optional<MatchPattern> Subscriptions::MatchOf(const Standing& standing, const TriggerSource& source) const {
  MatchPattern match;
  const std::array<const PatternTerm*, 4> terms = {&source.pattern.subject, &source.pattern.predicate,
                                                   &source.pattern.object, &source.graph};
  const std::array<TermId*, 4> ids = {&match.constants.subject, &match.constants.predicate,
                                      &match.constants.object, &match.constants.graph};
  for (int t = 0; t < 4; ++t) {
    if (terms[t]->IsVariable()) continue;
    const auto id = settings_.dictionary->Find(terms[t]->term);
    if (!id) return std::nullopt;
    *ids[t] = *id;
  }
  if (source.pattern.object.IsVariable()) {
    const std::string& name = source.pattern.object.variable->name;
    if (std::find(source.seeds.begin(), source.seeds.end(), name) != source.seeds.end())
      match.object_guard = GuardOf(WithoutModifiers(*standing.query.algebra), name, *settings_.dictionary);
  }
  return match;
}

void Subscriptions::Watch(Standing& standing) {
  standing.matches.clear();
  for (const TriggerSource& source : standing.analysis.triggers)
    standing.matches.push_back(MatchOf(standing, source));
  WatchMatches(standing);
  if (standing.analysis.is_volatile) volatile_.insert(standing.number);
}

// An ASK that holds looks only at what could break the solution that is known of it: of thousands that a number above
// theirs makes true, the next such number reaches none.
void Subscriptions::WatchMatches(Standing& standing) {
  const bool holds = standing.answer->is_boolean() && standing.answer->evaluated() && standing.answer->boolean();
  for (uint32_t i = 0; i < standing.matches.size(); ++i) {
    if (!standing.matches[i]) continue;
    const TriggerSource& source = standing.analysis.triggers[i];
    const bool narrowed = holds && source.polarity != Polarity::kBoth;
    standing.watches.push_back(watches_.Add(
        narrowed ? OfWitness(standing, source, *standing.matches[i]) : *standing.matches[i], {standing.number, i}));
  }
}

// `match` with the values that the known solution gives to the variables that a quad may bind.
MatchPattern Subscriptions::OfWitness(const Standing& standing, const TriggerSource& source, MatchPattern match) {
  const std::array<std::pair<const PatternTerm*, TermId*>, 4> places = {
      {{&source.pattern.subject, &match.constants.subject},
       {&source.pattern.predicate, &match.constants.predicate},
       {&source.pattern.object, &match.constants.object},
       {&source.graph, &match.constants.graph}}};
  for (const auto& [term, id] : places) {
    if (!term->IsVariable()) continue;
    const std::string& name = term->variable->name;
    if (std::find(source.seeds.begin(), source.seeds.end(), name) == source.seeds.end()) continue;
    for (const auto& [known, value] : standing.witness) {
      if (known == name) *id = value;
    }
  }
  if (!match.constants.object.IsNone()) match.object_guard.reset();
  return match;
}

void Subscriptions::UnwatchMatches(Standing& standing) {
  for (PatternIndex::Handle handle : standing.watches) watches_.Remove(handle);
  standing.watches.clear();
}

void Subscriptions::Unwatch(Standing& standing) {
  UnwatchMatches(standing);
  volatile_.erase(standing.number);
}

void Subscriptions::Touch(PatternIndex::Reference reference, const Quad& quad, bool added, TouchedSet& touched) {
  const Standing& standing = *standing_[reference.owner];
  const TriggerSource& source = standing.analysis.triggers[reference.pattern];
  if (!standing.answer->is_boolean() || source.polarity == Polarity::kBoth) {
    touched[reference.owner].whole = true;
    return;
  }
  const bool helps = added == (source.polarity == Polarity::kPositive);
  const bool holds = standing.answer->boolean();
  if (helps == holds) return;  // it is so already
  if (holds) {  // it matches the known solution
    touched[reference.owner].whole = true;
    return;
  }
  std::vector<std::string> names;
  std::vector<TermId> values;
  if (!SeedsOf(source, quad, names, values)) return;
  Touched& why = touched[reference.owner];
  if (names.empty() || why.seeds.size() >= kMostSeeds) {
    why.whole = true;
  } else {
    why.seeds.emplace_back(reference.pattern, quad);
  }
}

// The queries whose answer the change may change.
void Subscriptions::Gather(const Delta& delta, TouchedSet& touched) {
  for (uint32_t number : volatile_) touched[number].whole = true;
  const auto look = [&](const Quad& quad, bool added) {
    watches_.ForEachMatch(quad,
                          [&](PatternIndex::Reference reference) { Touch(reference, quad, added, touched); });
  };
  for (const Quad& quad : delta.added) look(quad, true);
  for (const Quad& quad : delta.removed) look(quad, false);
}

absl::StatusOr<bool> Subscriptions::HoldsNow(Standing& standing, const Touched& touched,
                                             const sparql::RunOptions& run) {
  standing.witness.clear();
  const auto ask = [&](sparql::PreparedQuery& query, absl::Span<const TermId> bound,
                       const std::vector<std::string>& names) -> absl::StatusOr<bool> {
    if (absl::Status status = query.Start(run, bound); !status.ok()) return status;
    if (!query.Next()) {
      if (!query.status().ok()) return query.status();
      return false;
    }
    for (size_t i = 0; i < query.variables().size(); ++i) {
      const TermId id = query.row()[i];
      if (!id.IsNone() && id.tag() != TermId::Tag::kLocal) standing.witness.emplace_back(query.variables()[i], id);
    }
    for (size_t i = 0; i < names.size(); ++i) standing.witness.emplace_back(names[i], bound[i]);
    return true;
  };
  if (touched.whole) return ask(*standing.prepared, {}, {});
  standing.seeded.resize(standing.analysis.triggers.size());
  for (const auto& [trigger, quad] : touched.seeds) {
    std::vector<std::string> names;
    std::vector<TermId> values;
    SeedsOf(standing.analysis.triggers[trigger], quad, names, values);
    if (standing.seeded[trigger] == nullptr) {
      sparql::PrepareOptions options;
      options.default_graph = settings_.default_graph;
      options.functions = settings_.functions;
      options.memory_bytes = settings_.limits.query_memory_bytes;
      options.bound = names;
      auto prepared = sparql::PreparedQuery::Prepare(standing.query, *settings_.dictionary, options);
      if (!prepared.ok()) return ask(*standing.prepared, {}, {});
      standing.seeded[trigger] = *std::move(prepared);
    }
    auto holds = ask(*standing.seeded[trigger], values, names);
    if (!holds.ok() || *holds) return holds;
  }
  return false;
}

void Subscriptions::Evaluate(Standing& standing, const Touched& touched) {
  ++counters_.evaluations;
  Cancellation cancellation{std::chrono::milliseconds(settings_.subscription_limits.subscription_evaluation_ms)};
  sparql::RunOptions run;
  run.version = version_.get();
  run.cancellation = &cancellation;
  run.now_us = time_us_;
  run.seed = version_->revision().value();
  bool changed = false;
  absl::Status status;
  if (standing.answer->is_boolean()) {
    auto holds = HoldsNow(standing, touched, run);
    status = holds.status();
    if (holds.ok()) changed = standing.answer->SetBoolean(version_->revision(), *holds);
  } else {
    StandingAnswer::Rows rows;
    size_t count = 0;
    status = standing.prepared->Select(run, {}, [&](absl::Span<const TermId> row) {
      StandingAnswer::Row ids(row.begin(), row.end());
      for (TermId& id : ids) {
        if (id.tag() == TermId::Tag::kLocal) id = standing.answer->Local(standing.prepared->Decode(id));
      }
      ++rows[ids];
      return ++count <= settings_.subscription_limits.subscription_rows;
    });
    if (status.ok() && count > settings_.subscription_limits.subscription_rows) {
      status = absl::ResourceExhaustedError(absl::StrCat("the answer has more rows than the limit subscription_rows = ",
                                                         settings_.subscription_limits.subscription_rows));
    }
    if (status.ok()) changed = standing.answer->SetRows(version_->revision(), std::move(rows));
  }
  if (absl::IsDeadlineExceeded(status)) {
    status = absl::DeadlineExceededError(
        absl::StrCat("the query took longer than the limit subscription_evaluation_ms = ",
                     settings_.subscription_limits.subscription_evaluation_ms, "; ask for less, or query now and then"));
  }
  if (!status.ok()) return FailAll(standing, status);
  if (standing.answer->is_boolean()) {
    UnwatchMatches(standing);
    WatchMatches(standing);
  }
  if (!changed) return;
  ++counters_.changes;
  absl::MutexLock lock(&followers_mutex_);
  for (const auto& follower : by_standing_[standing.number]) follower->Wake();
}

// The query cannot be followed any more.
void Subscriptions::FailAll(Standing& standing, const absl::Status& status) {
  {
    absl::MutexLock lock(&followers_mutex_);
    for (const auto& follower : by_standing_[standing.number]) {
      followers_.erase(follower);
      follower->Fail(status);
    }
    by_standing_.erase(standing.number);
    counters_.open = followers_.size();
  }
  Drop(standing.number);
}

absl::StatusOr<Subscriptions::Standing*> Subscriptions::FindOrMake(const std::string& text, sparql::Query query) {
  if (const auto known = by_text_.find(text); known != by_text_.end()) return standing_[known->second].get();
  auto standing = std::make_unique<Standing>();
  standing->text = text;
  standing->query = std::move(query);
  standing->analysis = AnalyseTriggers(WithoutModifiers(*standing->query.algebra));
  if (free_.empty()) {
    standing->number = static_cast<uint32_t>(standing_.size());
    standing_.emplace_back();
  } else {
    standing->number = free_.back();
    free_.pop_back();
  }
  const uint32_t number = standing->number;
  Standing* made = standing.get();
  standing_[number] = std::move(standing);
  by_text_[text] = number;
  counters_.queries = by_text_.size();
  if (absl::Status status = Prepare(*made); !status.ok()) {
    Drop(number);
    return status;
  }
  made->answer = std::make_shared<StandingAnswer>(next_answer_++, made->query.form == sparql::Query::Form::kAsk,
                                                  made->prepared->variables(), settings_.dictionary,
                                                  settings_.subscription_limits);
  Watch(*made);
  return made;
}

void Subscriptions::OpenNow(Opening opening) {
  auto standing = FindOrMake(opening.text, std::move(opening.query));
  if (!standing.ok()) return opening.done(standing.status());
  const uint32_t number = (*standing)->number;
  const StandingAnswerPtr answer = (*standing)->answer;
  {
    absl::MutexLock lock(&followers_mutex_);
    followers_[opening.follower] = number;
    by_standing_[number].insert(opening.follower);
    counters_.open = followers_.size();
  }
  (*standing)->idle_since = absl::InfiniteFuture();
  if (!answer->evaluated()) Evaluate(**standing, Touched{true, {}});  // fails the follower where it cannot
  if (answer->evaluated()) opening.done(answer);
}

void Subscriptions::DropIdle() {
  const absl::Time now = absl::Now();
  if (now < next_idle_check_) return;
  next_idle_check_ = now + absl::Seconds(1);
  std::vector<uint32_t> drop;
  size_t idle = 0;
  {
    absl::MutexLock lock(&followers_mutex_);
    for (auto it = by_standing_.begin(); it != by_standing_.end();) {
      Standing* standing = standing_[it->first].get();
      if (!it->second.empty() || standing == nullptr) {
        ++it;
        continue;
      }
      if (standing->idle_since == absl::InfiniteFuture()) standing->idle_since = now;
      if (++idle > kIdleKept || now - standing->idle_since > kLinger) {
        drop.push_back(it->first);
        by_standing_.erase(it++);
      } else {
        ++it;
      }
    }
  }
  for (uint32_t number : drop) Drop(number);
}

void Subscriptions::Drop(uint32_t number) {
  Standing& standing = *standing_[number];
  Unwatch(standing);
  incomplete_.erase(number);
  by_text_.erase(standing.text);
  counters_.queries = by_text_.size();
  standing_[number].reset();
  free_.push_back(number);
}

}  // namespace docent
