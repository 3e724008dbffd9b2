// Equality: writing out new facts under all names of their terms, and splitting classes. See materialiser.h.
#include <algorithm>
#include <utility>

#include "absl/container/inlined_vector.h"
#include "graph/base/step_costs.h"
#include "reasoner/rules/certain_equality.h"
#include "reasoner/rules/materialiser.h"

namespace docent::rules {
namespace {

constexpr size_t kPairsAsked =
    256;  // names of a class that lost a pair for which proofs by other rules are searched

using Blocks = absl::InlinedVector<absl::Span<const TermId>, 8>;

// The blocks of a term's class; without a class the term alone, which must stay at its address.
Blocks BlocksOf(const EqualityClasses& classes, const TermId& term, bool as_object) {
  Blocks blocks;
  const EqualityClasses::Class* of_term = classes.Find(term);
  if (of_term == nullptr) {
    blocks.push_back(absl::MakeConstSpan(&term, 1));
    return blocks;
  }
  for (size_t i = 0; i < of_term->blocks.size(); ++i) blocks.push_back(of_term->block(i));
  for (size_t i = 0; as_object && i < of_term->literals.size(); ++i)
    blocks.push_back(absl::MakeConstSpan(&of_term->literals[i], 1));
  return blocks;
}

}  // namespace

// ---- new facts

void Materialiser::BeginEquality() {
  unwritten_.clear();
  if (!program_.ClosesEquality(stratum_)) return;
  unwritten_ = gained_;
  EqualityClasses& classes = context_.classes;
  if (!before_.equality.by_classes && !are_unsettled_) {  // not written out yet, or by other rules
    are_unsettled_ = true;
    classes.ForEach([&](const EqualityClasses::Class& each) { joined_.push_back(each.representative()); });
  }
  // Facts that classes made in an earlier stratum may have been put off to this one.
  for (const TermId member : joined_) classes.Unsettle(member);
}

// True if a class grew by new pairs.
bool Materialiser::JoinNew() {
  bool any = false;
  for (const std::vector<Triple>* facts : {&unwritten_, &candidates_}) {
    for (const Triple& t : *facts) {
      if (t.predicate != program_.equality.same_as || !context_.classes.Join(t.subject, t.object)) continue;
      any = true;
      if (!program_.ordered.empty()) joined_.push_back(t.subject);
    }
  }
  return any;
}

// Distinct facts under representatives: the new facts, and the graph's facts about classes that grew.
std::vector<Triple> Materialiser::FactsToWriteOut() {
  const EqualityClasses& classes = context_.classes;
  std::vector<Triple> facts;
  absl::flat_hash_set<Triple> known;
  const auto note = [&](const Triple& t) {
    if (!HasOtherNames(t)) return;
    const Triple under = UnderRepresentatives(classes, t);
    if (known.insert(under).second) facts.push_back(under);
  };
  for (const TermId representative : classes.Joined()) {
    const EqualityClasses::Class& joined = *classes.Find(representative);
    for (size_t i = 0; i < joined.blocks.size(); ++i) {
      const TermId term = joined.block(i)[0];
      for (const QuadPattern& about :
           {QuadPattern{term, TermId(), TermId(), TermId()}, QuadPattern{TermId(), term, TermId(), TermId()},
            QuadPattern{TermId(), TermId(), term, TermId()}}) {
        Spend(kStepsOfLookup);
        for (QuadCursor c = graph().Scan(about); c.Valid(); c.Next()) {
          Spend(kStepsOfLookup);
          note({c.quad().subject, c.quad().predicate, c.quad().object});
        }
      }
    }
  }
  for (const Triple& t : unwritten_) note(t);
  for (const Triple& t : candidates_) note(t);
  return facts;
}

absl::Status Materialiser::WriteOutEquals() {
  if (!program_.ClosesEquality(stratum_)) return absl::OkStatus();
  for (bool again = true; again;) {
    JoinNew();
    if (context_.classes.empty()) break;
    unwritten_set_.clear();
    for (const Triple& t : unwritten_) {
      if (HasOtherNames(t)) unwritten_set_.insert(t);
    }
    for (const Triple& fact : FactsToWriteOut()) {
      if (!WriteOut(fact)) return status_;
    }
    if (!TakeMade()) return status_;
    // Properties equal to owl:sameAs make pairs.
    again = context_.classes.Find(program_.equality.same_as) != nullptr && JoinNew();
  }
  unwritten_.clear();
  unwritten_set_.clear();
  return absl::OkStatus();
}

// Calls `visit(subjects, predicates, objects)` for each combination of blocks that the graph does not hold
// completely. It holds all or none of a combination, except for facts new in this turn and, for classes that
// lost terms, facts found by Rederive.
template <typename Visit>
bool Materialiser::ForEachOpenBlock(const Triple& fact, Visit visit) {
  const Blocks subjects = BlocksOf(context_.classes, fact.subject, false);
  const Blocks predicates = BlocksOf(context_.classes, fact.predicate, false);
  const Blocks objects = BlocksOf(context_.classes, fact.object, true);
  for (const auto& s : subjects) {
    for (const auto& p : predicates) {
      const auto iri = std::find_if(p.begin(), p.end(), [](TermId id) { return id.IsIri(); });
      if (iri == p.end()) continue;
      for (const auto& o : objects) {
        const Triple first = {s[0], *iri, o[0]};
        const bool one = s.size() * p.size() * o.size() == 1;
        Spend(one ? 1 : kStepsOfLookup);
        if (!one && !unwritten_set_.contains(first) && IsPresent(first)) continue;
        if (!visit(s, p, o)) return false;
      }
    }
  }
  return true;
}

// False if the remaining steps cannot be enough; checked before the names take memory.
bool Materialiser::CanWriteOut(const Triple& fact) {
  constexpr size_t kMany = 100000;
  constexpr uint64_t kStepsOfName = kStepsOfHead + kStepsOfCandidate + kStepsOfLookup + kStepsOfFact;
  if (context_.cancellation == nullptr || CountNames(context_.classes, fact) < kMany) return true;
  uint64_t names = 0;
  ForEachOpenBlock(fact, [&](const auto& s, const auto& p, const auto& o) {
    names += s.size() * p.size() * o.size();
    return true;
  });
  if (context_.cancellation->CanSpend(names * kStepsOfName)) return true;
  Spend(names * kStepsOfName);
  status_ =
      CheckSteps(program_.rules[fact.predicate == program_.equality.same_as ? program_.equality.transitivity
                                                                            : program_.equality.replacement]);
  return false;
}

bool Materialiser::WriteOut(const Triple& fact) {
  if (!CanWriteOut(fact)) return false;
  return ForEachOpenBlock(fact, [&](const auto& subjects, const auto& predicates, const auto& objects) {
    for (const TermId subject : subjects) {
      for (const TermId predicate : predicates) {
        for (const TermId object : objects) {
          if (!EmitEqual({subject, predicate, object})) return false;
        }
      }
    }
    return true;
  });
}

bool Materialiser::EmitEqual(const Triple& made) {
  if (!made.predicate.IsIri() || context_.inconsistencies.IsOfReport(made)) return true;
  const bool pair = made.predicate == program_.equality.same_as;
  const CompiledRule& rule =
      program_.rules[pair ? program_.equality.transitivity : program_.equality.replacement];
  return MayEmit(rule, made, Phase::kAdd) ? Collect(rule, made, Phase::kAdd) : true;
}

// ---- lost facts

// If equality is no longer a rule: collects all facts that it may have made.
void Materialiser::CollectFactsWithOtherNames() {
  graph().ForEach({TermId(), TermId(), TermId(), context_.inferred_graph}, [&](const Quad& q) {
    const Triple t = {q.subject, q.predicate, q.object};
    const bool may_be = HasOtherNames(t) || context_.classes.IsName(t.object);
    if (may_be) made_.push_back(t);
    return true;
  });
}

// Adds the facts that may rest on a lost fact by equality to made_.
absl::Status Materialiser::LoseEquals(const Triple& lost) {
  const EqualityClasses& classes = context_.classes;
  if (!program_.ClosesEquality(stratum_) || !HasOtherNames(lost)) return absl::OkStatus();
  const bool pair = lost.predicate == program_.equality.same_as && lost.subject != lost.object &&
                    classes.AreEqual(lost.subject, lost.object);
  if (pair) {
    const EqualityClasses::Class& of_pair = *classes.Find(lost.subject);
    if (shrunk_terms_.contains(of_pair.representative())) return absl::OkStatus();
    return Doubt(of_pair);
  }
  if (!lost_names_.insert(UnderRepresentatives(classes, lost)).second) return absl::OkStatus();
  ForEachName(classes, lost, NamesOf::kMade, [&](const Triple& t) {
    AskAboutEqual(t);
    return true;
  });
  return absl::OkStatus();
}

// Adds a fact that equality may have made to made_.
void Materialiser::AskAboutEqual(const Triple& fact) {
  const CompiledRule& rule = program_.rules[program_.equality.replacement];
  Spend(kStepsOfLookup);
  if (MayMake(rule, fact, Phase::kTakeAway) && IsInferred(fact) && !context_.inconsistencies.IsOfReport(fact))
    made_.push_back(fact);
}

// A class that lost a pair: its other pairs and all facts about its terms are tested.
absl::Status Materialiser::Doubt(const EqualityClasses::Class& doubted) {
  shrunk_classes_.push_back(doubted);
  shrunk_terms_.insert(doubted.members.begin(), doubted.members.end());
  CertainEquality& certain = proofs_.certain();
  size_t asked = 0;
  std::vector<Triple> pairs;
  for (const TermId member : doubted.members) {
    graph().ForEach({member, program_.equality.same_as, TermId(), context_.inferred_graph},
                    [&](const Quad& q) {
                      const Triple pair = {q.subject, q.predicate, q.object};
                      if (!marked_.contains(pair)) pairs.push_back(pair);
                      return true;
                    });
    Spend(pairs.size() * 2);
    if (absl::Status status = CheckSteps(program_.rules[program_.equality.transitivity]); !status.ok())
      return status;
    for (const Triple& pair : std::exchange(pairs, {})) {
      if (certain.Proves(pair)) continue;
      if (++asked <= kPairsAsked || pair.subject == pair.object) {
        if (absl::Status status = Consider(pair); !status.ok()) return status;
      } else {
        marked_.insert(pair);
        queue_.push_back(pair);
      }
    }
  }
  CollectFactsAbout(doubted);
  return absl::OkStatus();
}

void Materialiser::CollectFactsAbout(const EqualityClasses::Class& doubted) {
  const TermId inferred = context_.inferred_graph;
  for (const TermId term : doubted.members) {
    for (const QuadPattern& about :
         {QuadPattern{term, TermId(), TermId(), inferred}, QuadPattern{TermId(), term, TermId(), inferred},
          QuadPattern{TermId(), TermId(), term, inferred}}) {
      graph().ForEach(about, [&](const Quad& q) {
        const bool pair = q.predicate == program_.equality.same_as && shrunk_terms_.contains(q.subject) &&
                          shrunk_terms_.contains(q.object);
        const Triple t = {q.subject, q.predicate, q.object};
        if (!pair) AskAboutEqual(t);
        return true;
      });
    }
    if (doubted.literals.empty()) continue;
    graph().ForEach({TermId(), TermId(), term, TermId()}, [&](const Quad& q) {
      for (const TermId literal : doubted.literals) AskAboutEqual({q.subject, q.predicate, literal});
      return true;
    });
  }
}

// Splits classes that lost a pair into certainly equal parts; other rules may join these again
// (RederivePairs).
void Materialiser::SplitShrunk() {
  if (shrunk_classes_.empty()) return;
  CertainEquality& certain = proofs_.certain();
  std::vector<EqualityClasses::Class> parts;
  for (const EqualityClasses::Class& doubted : shrunk_classes_) {
    for (EqualityClasses::Class& part : certain.PartsOf(doubted.members[0])) parts.push_back(std::move(part));
  }
  for (const EqualityClasses::Class& doubted : shrunk_classes_) {
    context_.classes.Dissolve(doubted.members[0]);
    reopened_.insert(reopened_.end(), doubted.members.begin(), doubted.members.end());
  }
  for (const EqualityClasses::Class& part : parts) {
    for (const std::vector<TermId>* terms : {&part.members, &part.literals}) {
      for (const TermId term : *terms) context_.classes.Join(part.representative(), term);
    }
  }
  context_.classes.Settle();
  // It was removed before it was known to be certain.
  for (size_t i = ghosts_; i < queue_.size(); ++i) {
    const Triple& t = queue_[i];
    if (t.predicate == program_.equality.same_as && context_.classes.AreEqual(t.subject, t.object))
      rederivable_.push_back(t);
  }
  shrunk_classes_.clear();
  shrunk_terms_.clear();
}

// True if equality makes the fact from one that the graph holds.
bool Materialiser::IsWrittenOut(const Triple& fact) {
  const EqualityClasses& classes = context_.classes;
  if (!program_.ClosesEquality(stratum_) || classes.empty()) return false;
  if (!HasOtherNames(fact) && !classes.IsName(fact.object)) return false;
  if (!MayMake(program_.rules[program_.equality.replacement], fact, Phase::kAdd)) return false;
  if (fact.predicate == program_.equality.same_as) {
    const EqualityClasses::Class* of_subject = classes.Find(fact.subject);
    if (of_subject != nullptr && of_subject->members.size() > 1 &&
        classes.AreEqual(fact.subject, fact.object))
      return true;
  }
  const Triple under = UnderRepresentatives(classes, fact);
  const std::vector<TermId> objects = ObjectsThatMake(classes, fact.object);
  return std::any_of(objects.begin(), objects.end(), [&](TermId object) {
    const Triple maker = {under.subject, under.predicate, object};
    const auto [place, is_new] = is_written_out_.try_emplace(maker, false);
    if (is_new) {
      place->second = !ForEachName(classes, maker, NamesOf::kMakers, [&](const Triple& t) {
        Spend(kStepsOfLookup);
        return !IsPresent(t);
      });
    }
    return place->second;
  });
}

// If owl:sameAs has another name, facts with that name make pairs.
bool Materialiser::RederivePairsByName() {
  const TermId same_as = program_.equality.same_as;
  const EqualityClasses::Class* names = context_.classes.Find(same_as);
  if (names == nullptr) return true;
  bool goes_on = true;
  for (const TermId name : names->members) {
    for (const TermId term : reopened_) {
      graph().ForEach({term, name, TermId(), TermId()}, [&](const Quad& q) {
        goes_on = goes_on && EmitEqual({q.subject, same_as, q.object});
        return goes_on;
      });
    }
  }
  return goes_on;
}

// Derives the pairs that rules make of terms whose classes were split.
absl::Status Materialiser::RederivePairs(int stratum) {
  if (reopened_.empty() || !program_.ClosesEquality(stratum)) return absl::OkStatus();
  if (!RederivePairsByName()) return status_;
  const QuadPattern pair = {TermId(), program_.equality.same_as, TermId(), TermId()};
  absl::Status status;
  for (uint32_t r = 0; r < program_.rules.size() && status.ok(); ++r) {
    const CompiledRule& rule = program_.rules[r];
    if (rule.of_equality || rule.stratum > stratum) continue;
    for (const HeadTriple& head : rule.head) {
      if (!CanUnify(head.Pattern(), pair) || !status.ok()) continue;
      if (rule.schema == 0) {
        status = RederivePairsOf(rule, head, nullptr);
        continue;
      }
      context_.schema.ForEachInstance(r, [&](const SchemaIndex::Instance& instance) {
        if (status.ok()) status = RederivePairsOf(rule, head, &instance.row);
      });
    }
  }
  reopened_.clear();
  return status;
}

absl::Status Materialiser::RederivePairsOf(const CompiledRule& rule, const HeadTriple& head,
                                           const std::vector<TermId>* instance) {
  std::vector<TermId> of_pair(rule.body->columns().size());
  if (instance != nullptr) of_pair = *instance;
  const auto bind = [](const HeadTriple& to, int position, TermId term, std::vector<TermId>& row) {
    const int16_t column = to.columns[static_cast<size_t>(position)];
    TermId& place = column == matching::Trigger::kNoColumn ? term : row[static_cast<size_t>(column)];
    if (column == matching::Trigger::kNoColumn) return to.constants[static_cast<size_t>(position)] == term;
    if (!place.IsNone() && place != term) return false;
    place = term;
    return true;
  };
  if (!bind(head, 1, program_.equality.same_as, of_pair)) return absl::OkStatus();
  for (const TermId term : reopened_) {
    seed_ = of_pair;
    if (!bind(head, 0, term, seed_)) continue;
    const auto visit = [&](absl::Span<const TermId> row) { return Emit(rule, row, Phase::kAdd); };
    const absl::Status status =
        instance != nullptr
            ? rule.body->EvaluateRest(Now(), seed_, rule.schema, matching::Body::Filters::kAll, visit)
            : rule.body->Evaluate(Now(), seed_, visit);
    if (!status.ok()) return rule.Named(status);
    if (!status_.ok()) return status_;
  }
  return absl::OkStatus();
}

}  // namespace docent::rules
