#include "reasoner/rules/proof_search.h"

#include <algorithm>

#include "absl/container/inlined_vector.h"
#include "graph/base/step_costs.h"

namespace docent::rules {

bool ProofSearch::IsTold(const Triple& fact) const {
  if (cancellation_ != nullptr) cancellation_->Spend(kStepsOfLookup);
  for (QuadCursor c = writer_.current().Scan({fact.subject, fact.predicate, fact.object, TermId()});
       c.Valid(); c.Next()) {
    if (c.quad().graph != inferred_graph_) return true;
  }
  return false;
}

bool Surroundings::MayMatch(const GraphVersion& graph, const Triple& pattern,
                            absl::FunctionRef<bool(const Triple&)> counts) {
  const bool by_subject = !pattern.subject.IsNone();
  if (!by_subject && pattern.object.IsNone()) return true;
  const auto [place, is_new] =
      by_subject ? of_subject_.try_emplace(pattern.subject) : of_object_.try_emplace(pattern.object);
  Facts& facts = place->second;
  if (is_new) {
    QuadPattern around;
    (by_subject ? around.subject : around.object) = place->first;
    QuadCursor c = graph.Scan(around);
    for (; c.Valid() && facts.others.size() < kFew; c.Next()) {
      const Quad q = c.quad();
      facts.others.emplace_back(by_subject ? q.predicate : q.subject, by_subject ? q.object : q.predicate);
    }
    facts.all = !c.Valid();
    if (!facts.all) facts.others.clear();
  }
  if (!facts.all) return counts(pattern);
  const TermId first = by_subject ? pattern.predicate : pattern.subject;
  const TermId second = by_subject ? pattern.object : pattern.predicate;
  return std::any_of(facts.others.begin(), facts.others.end(), [&](const auto& other) {
    if (!(first.IsNone() || first == other.first) || !(second.IsNone() || second == other.second))
      return false;
    return counts(by_subject ? Triple{pattern.subject, other.first, other.second}
                             : Triple{other.first, other.second, pattern.object});
  });
}

absl::StatusOr<ProofSearch::Answer> ProofSearch::Prove(const Triple& fact) {
  steps_left_ = kSteps;
  failures_.clear();
  open_.clear();
  const Answer answer = Search(fact, 0);
  if (!status_.ok()) return status_;
  if (answer == Answer::kProven) premises_left_ += kPremisesOfSuccess;
  return answer;
}

ProofSearch::Answer ProofSearch::Search(const Triple& fact, int depth) {
  if (proven_.contains(fact)) return Answer::kProven;
  if (failed_.contains(fact)) return Answer::kUnproven;
  if (depth > 0) {
    if (lost_.contains(fact)) return Answer::kUnproven;
    if (const auto on_way = open_.find(fact); on_way != open_.end()) {
      on_way->second = true;
      return Answer::kUnproven;
    }
  }
  if (IsTold(fact)) {
    proven_.insert(fact);
    return Answer::kProven;
  }
  const bool by_equality = program_.equality.by_classes && certain_.MayMake(fact);
  if (by_equality && certain_.Proves(fact)) {
    proven_.insert(fact);
    return Answer::kProven;
  }
  if (depth == kDepth || --steps_left_ < 0 || premises_left_ < 0) return Answer::kUndecided;
  open_.emplace(fact, false);
  const size_t failures_before = failures_.size();

  Answer answer = Answer::kUnproven;
  const Quad quad = {fact.subject, fact.predicate, fact.object, TermId()};
  absl::InlinedVector<Maker, 16> makers;
  schema_.heads().ForEachMatch(quad, [&](matching::PatternIndex::Reference r) {
    const SchemaIndex::Instance& instance = schema_.instance(r.owner);
    makers.push_back({instance.rule, r.pattern, &instance.row});
  });
  program_.heads.ForEachMatch(quad, [&](matching::PatternIndex::Reference r) {
    makers.push_back({r.owner, r.pattern, nullptr});
  });
  for (size_t i = 0; i < makers.size() && answer != Answer::kProven && status_.ok(); ++i) {
    const Answer here = SearchMaker(fact, makers[i], depth);
    if (here != Answer::kUnproven) answer = here;
  }

  if (by_equality && answer == Answer::kProven) certain_.Note(fact);
  if (by_equality && answer == Answer::kUnproven) answer = Answer::kUndecided;
  const bool asked_again = open_.find(fact)->second;
  open_.erase(fact);
  if (asked_again && answer != Answer::kUnproven) {  // facts that failed because of it may be provable
    for (size_t i = failures_before; i < failures_.size(); ++i) failed_.erase(failures_[i]);
    failures_.resize(failures_before);
  }
  if (answer == Answer::kProven) {
    proven_.insert(fact);
  } else if (answer == Answer::kUnproven) {
    failed_.insert(fact);
    failures_.push_back(fact);
  }
  return answer;
}

ProofSearch::Answer ProofSearch::SearchMaker(const Triple& fact, const Maker& maker, int depth) {
  const CompiledRule& rule = program_.rules[maker.rule];
  if (!rule.positive) return Answer::kUndecided;
  absl::InlinedVector<TermId, 16> seed;
  if (maker.row != nullptr) {
    seed.assign(maker.row->begin(), maker.row->end());
  } else {
    seed.resize(rule.body->columns().size());
  }
  const uint32_t matched = maker.row != nullptr ? rule.schema : 0;
  if (!rule.head[maker.head].SeedFrom(fact, absl::MakeSpan(seed)) || !MayMatch(rule, seed, matched))
    return Answer::kUnproven;
  Bodies bodies;
  const Answer told = Collect(rule, seed, matched, bodies);
  return told == Answer::kProven ? told : SearchBodies(bodies, depth, told == Answer::kUnproven);
}

bool ProofSearch::MayMatch(const CompiledRule& rule, absl::Span<const TermId> seed, uint32_t matched) {
  const auto counts = [this](const Triple& t) { return !lost_.contains(t) && !failed_.contains(t); };
  for (uint32_t open = rule.patterns & ~matched; open != 0; open &= open - 1) {
    const Triple premise = rule.Premise(static_cast<size_t>(__builtin_ctz(open)), seed);
    if (!surroundings_.MayMatch(writer_.current(), premise, counts)) return false;
  }
  return true;
}

ProofSearch::Answer ProofSearch::Collect(const CompiledRule& rule, absl::Span<const TermId> seed,
                                         uint32_t matched, Bodies& bodies) {
  bool too_many = false;
  bool told = false;
  const size_t count = rule.body->patterns().size();
  const sparql::RunOptions run{.version = &writer_.current(), .cancellation = cancellation_};
  const auto take = [&](absl::Span<const TermId> row) {
    std::vector<Triple> open;
    for (size_t i = 0; i < count; ++i) {
      const Triple premise = rule.Premise(i, row);
      --premises_left_;
      if (proven_.contains(premise)) continue;
      if (lost_.contains(premise) || failed_.contains(premise)) return true;
      if (IsTold(premise)) {
        proven_.insert(premise);
        continue;
      }
      open.push_back(premise);
    }
    if (open.empty()) {
      told = true;
      return false;
    }
    if (bodies.size() == kBodies) {
      too_many = true;
      return false;
    }
    bodies.push_back(std::move(open));
    return true;
  };
  status_ = rule.Named(rule.body->EvaluateRest(run, seed, matched, matching::Body::Filters::kAll, take));
  if (told) return Answer::kProven;
  return too_many ? Answer::kUndecided : Answer::kUnproven;
}

ProofSearch::Answer ProofSearch::SearchBodies(const Bodies& bodies, int depth, bool complete) {
  Answer answer = complete ? Answer::kUnproven : Answer::kUndecided;
  for (const std::vector<Triple>& body : bodies) {
    Answer all = Answer::kProven;
    for (const Triple& premise : body) {
      const Answer one = Search(premise, depth + 1);
      if (!status_.ok()) return Answer::kUndecided;
      if (one == Answer::kUnproven) {
        all = Answer::kUnproven;
        break;
      }
      if (one == Answer::kUndecided) all = Answer::kUndecided;
    }
    if (all == Answer::kProven) return Answer::kProven;
    if (all == Answer::kUndecided) answer = Answer::kUndecided;
  }
  return answer;
}

}  // namespace docent::rules
