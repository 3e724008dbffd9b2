#include "reasoner/rules/proof_search.h"

#include <algorithm>

#include "absl/container/inlined_vector.h"

namespace docent {

bool ProofSearch::IsTold(const Triple& fact) const {
  for (QuadCursor c = writer_.current().Scan({fact.subject, fact.predicate, fact.object, TermId()});
       c.Valid(); c.Next()) {
    if (c.quad().graph != inferred_graph_) return true;
  }
  return false;
}

absl::StatusOr<ProofSearch::Answer> ProofSearch::Prove(const Triple& fact) {
  steps_left_ = kSteps;
  failed_.clear();
  failures_.clear();
  open_.clear();
  const Answer answer = Search(fact, 0);
  if (!status_.ok()) return status_;
  return answer;
}

ProofSearch::Answer ProofSearch::Search(const Triple& fact, int depth) {
  if (proven_.contains(fact)) return Answer::kProven;
  if (depth > 0) {
    if (lost_.contains(fact) || failed_.contains(fact)) return Answer::kUnproven;
    if (const auto on_way = open_.find(fact); on_way != open_.end()) {
      on_way->second = true;
      return Answer::kUnproven;
    }
  }
  if (IsTold(fact)) {
    proven_.insert(fact);
    return Answer::kProven;
  }
  if (depth == kDepth || --steps_left_ < 0) return Answer::kUndecided;
  open_.emplace(fact, false);
  const size_t failures_before = failures_.size();

  Answer answer = Answer::kUnproven;
  const Quad quad = {fact.subject, fact.predicate, fact.object, TermId()};
  const auto try_maker = [&](const CompiledRule& rule, const HeadTriple& head, std::vector<TermId> seed,
                             uint32_t matched) {
    if (!rule.positive) {
      answer = Answer::kUndecided;
      return;
    }
    if (!head.SeedFrom(fact, seed)) return;
    Bodies bodies;
    Answer here = Collect(rule, seed, matched, bodies);
    if (here != Answer::kProven) here = SearchBodies(bodies, depth, here == Answer::kUnproven);
    if (here != Answer::kUnproven) answer = here;
  };
  absl::InlinedVector<PatternIndex::Reference, 8> makers;
  schema_.heads().ForEachMatch(quad, [&](PatternIndex::Reference r) { makers.push_back(r); });
  const size_t of_schema = makers.size();
  program_.heads.ForEachMatch(quad, [&](PatternIndex::Reference r) { makers.push_back(r); });
  for (size_t i = 0; i < makers.size() && answer != Answer::kProven && status_.ok(); ++i) {
    const auto& [owner, number] = makers[i];
    if (i < of_schema) {
      const SchemaIndex::Instance& instance = schema_.instance(owner);
      const CompiledRule& rule = program_.rules[instance.rule];
      try_maker(rule, rule.head[number], instance.row, rule.schema);
    } else {
      const CompiledRule& rule = program_.rules[owner];
      try_maker(rule, rule.head[number], std::vector<TermId>(rule.body->columns().size()), 0);
    }
  }

  const bool asked_again = open_.find(fact)->second;
  open_.erase(fact);
  if (answer == Answer::kProven) {
    proven_.insert(fact);
    if (asked_again) {  // who failed because of this fact may not have to
      for (size_t i = failures_before; i < failures_.size(); ++i) failed_.erase(failures_[i]);
      failures_.resize(failures_before);
    }
  } else if (answer == Answer::kUnproven) {
    failed_.insert(fact);
    failures_.push_back(fact);
  }
  return answer;
}

ProofSearch::Answer ProofSearch::Collect(const CompiledRule& rule, absl::Span<const TermId> seed,
                                         uint32_t matched, Bodies& bodies) {
  bool too_many = false;
  bool told = false;
  const size_t count = rule.body->patterns().size();
  status_ = rule.body->EvaluateRest({.version = &writer_.current()}, seed, matched, /*filters=*/true,
                                    [&](absl::Span<const TermId> row) {
                                      std::vector<Triple> open;
                                      for (size_t i = 0; i < count; ++i) {
                                        const Triple premise = rule.Premise(i, row);
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
                                    });
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

}  // namespace docent
