// The abductive part of Solver: facts taken as missing, and rules that would infer them.
#include <optional>

#include "graph/rdf/vocabulary.h"
#include "reasoner/explain/solver.h"
#include "reasoner/rules/schema_words.h"

namespace docent::explain {

// True if the goal repeats, up to open variables, a goal that it would help to infer: the rule would then be
// circular.
bool Solver::IsInOwnChain(int goal) const {
  const QuadPattern self = PatternOf(goals_[goal]);
  for (int above = goals_[goal].chain; above >= 0; above = goals_[above].chain) {
    const QuadPattern other = PatternOf(goals_[above]);
    if (self.subject == other.subject && self.predicate == other.predicate && self.object == other.object)
      return true;
  }
  return false;
}

// True if a rule may help although no further fact may be missing: by an absence, or by using a fact already
// missing.
bool Solver::MayServe(uint32_t clause) {
  if (options_.rules->clauses()[clause].rests_on_absence) return true;
  for (const int goal : missing_) {
    if (RestsOn(clause, PatternOf(goals_[goal]).predicate)) return true;
    rules_skipped_ = rules_skipped_ || RestsOn(clause, TermId());
  }
  return false;
}

bool Solver::RestsOn(uint32_t clause, TermId predicate) {
  const auto [known, is_new] = resting_on_.try_emplace(predicate);
  if (is_new) known->second = options_.rules->RestingOn(predicate);
  return known->second[clause];
}

// Tries the rules. If every fact of a body held, its head would hold, too; so this is for bodies with missing
// facts or with an absence that does not hold.
bool Solver::TryRules(int goal, bool room) {
  const int frame = goals_[goal].frame;
  const int base = frames_[frame].base;
  const int depth = frames_[frame].depth;
  const Atom& atom = *goals_[goal].atom;
  if (IsInOwnChain(goal)) return true;
  if (atom.terms[3].variable >= 0) return true;  // GRAPH ?g: the graph of an inferred fact is not a goal
  std::vector<RuleBase::Head> heads;
  options_.rules->ForEachHead(TermOf(atom.terms[1], base), [&](RuleBase::Head h) { heads.push_back(h); });
  for (const RuleBase::Head& head : heads) {
    const RuleClause& rule = options_.rules->clauses()[head.clause];
    if (!rule.tells || (!room && !MayServe(head.clause))) continue;
    if (depth >= options_.rule_depth) {
      rules_skipped_ = true;
      break;
    }
    const size_t mark = Mark();
    PushFrame(rule.body, goal, depth + 1, rule.rule);
    const int own = frames_.back().base;
    bool fits = true;
    for (int i = 0; i < 3 && fits; ++i)
      fits = Unify(atom.terms[i], base, rule.heads[head.head].terms[i], own);
    const bool go_on = !fits || Step();
    Rewind(mark);
    PopFrame();
    if (!go_on) return false;
  }
  return true;
}

// True for an axiom in a rule body that must exist, because axioms may not be asserted; the graph holds their
// closure.
bool Solver::IsGivenAxiom(const Goal& goal) const {
  if (options_.tell_schema || frames_[goal.frame].depth == 0) return false;
  const QuadPattern p = PatternOf(goal);
  const auto text = [&](TermId id) { return id.IsIri() ? dictionary_.Lexical(id) : std::string_view(); };
  return rules::IsSchemaPattern(text(p.predicate), text(p.object));
}

bool Solver::IsTellable(const Goal& goal) const {
  if (options_.tell_derived || options_.rules == nullptr) return true;
  const QuadPattern p = PatternOf(goal);
  if (!options_.rules->IsMadeByName(p.predicate, p.object)) return true;
  // facts that people also assert
  QuadPattern alike{TermId(), p.predicate, TermId(), TermId()};
  const std::optional<TermId> type = dictionary_.FindIri(kRdfType);
  const std::optional<TermId> inferred = dictionary_.FindIri(kInferredGraph);
  if (type && p.predicate == *type) alike.object = p.object;
  bool told = false;
  size_t looked = 0;
  version_.ForEach(alike, [&](const Quad& quad) {
    told = quad.graph != inferred.value_or(TermId());
    return !told && ++looked < 1000;
  });
  return told;
}

// One missing fact may serve several patterns.
bool Solver::TryMissingAlready(int goal) {
  for (size_t i = 0; i < missing_.size(); ++i) {
    const Goal& other = goals_[missing_[i]];
    const size_t mark = Mark();
    bool fits = true;
    for (int t = 0; t < 4 && fits; ++t) {
      fits = Unify(goals_[goal].atom->terms[t], frames_[goals_[goal].frame].base, other.atom->terms[t],
                   frames_[other.frame].base);
    }
    const bool go_on = !fits || Step();
    Rewind(mark);
    if (!go_on) return false;
  }
  return true;
}

bool Solver::TryMissing(int goal) {
  missing_.push_back(goal);
  const bool go_on = Step();
  missing_.pop_back();
  return go_on;
}

}  // namespace docent::explain
