// The abductive part of Solver: what is taken as missing, and the rules that would infer it.
#include <optional>

#include "graph/rdf/vocabulary.h"
#include "reasoner/explain/solver.h"
#include "reasoner/rules/schema_words.h"

namespace docent::explain {

// Whether the goal asks again for what it is to help to infer, whatever its open variables are: through a rule it
// would go round in circles.
bool Solver::IsInOwnChain(int goal) const {
  const QuadPattern self = PatternOf(goals_[goal]);
  for (int above = goals_[goal].chain; above >= 0; above = goals_[above].chain) {
    const QuadPattern other = PatternOf(goals_[above]);
    if (self.subject == other.subject && self.predicate == other.predicate && self.object == other.object)
      return true;
  }
  return false;
}

// Whether a rule may help though nothing more may be missing: by an absence, or as it asks for what is missing already.
bool Solver::MayServe(const RuleClause& rule) {
  if (rule.rests_on_absence) return true;
  for (const int goal : missing_) {
    const TermId predicate = PatternOf(goals_[goal]).predicate;
    if (rule.rests_on.contains(predicate)) return true;
    left_out_rules_ = left_out_rules_ || rule.rests_on.contains(TermId());
  }
  return false;
}

// Through a rule. With every fact of its body there its head would be, too, so this is for bodies that lack
// something, or where something is in the way of an absence.
bool Solver::TryRules(int goal, bool room) {
  const int frame = goals_[goal].frame;
  const int base = frames_[frame].base;
  const int depth = frames_[frame].depth;
  const Atom& atom = *goals_[goal].atom;
  if (IsInOwnChain(goal)) return true;
  if (atom.terms[3].variable >= 0) return true;  // GRAPH ?g: nobody asks for the graph of what is inferred
  std::vector<RuleBase::Head> heads;
  options_.rules->ForEachHead(TermOf(atom.terms[1], base), [&](RuleBase::Head h) { heads.push_back(h); });
  for (const RuleBase::Head& head : heads) {
    const RuleClause& rule = options_.rules->clauses()[head.clause];
    if (!rule.tells || (!room && !MayServe(rule))) continue;
    if (depth >= options_.rule_depth) {
      left_out_rules_ = true;
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

// An axiom that a rule asks for has to be there where none may be told; its closure is in the graph.
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
  // people tell it, too
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
