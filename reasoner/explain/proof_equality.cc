// Proofs by the rules of equality, over pairs that are asserted, or that another rule makes of asserted
// facts. See proof.h.
#include <algorithm>
#include <array>

#include "reasoner/explain/proof.h"

namespace docent::explain {
namespace {

constexpr size_t kManyNames = 1 << 16;  // for a fact with more names no asserted one is searched

}  // namespace

void Prover::AddEqual(rules::EqualityRule rule, const std::vector<std::pair<const char*, TermId>>& values,
                      const std::vector<Quad>& facts, std::vector<Derivation>& found) {
  const uint32_t clause = rules_.equality()[static_cast<size_t>(rule)];
  const Clause& body = rules_.clauses()[clause].body;
  Derivation derivation{clause, {}, {}};
  derivation.row.clause = &body;
  derivation.row.values.resize(body.names.size());
  derivation.row.open.resize(body.names.size(), MissingFact::kBound);
  for (const auto& [name, value] : values)
    derivation.row.values[static_cast<size_t>(body.Find(name))] = value;
  for (const Quad& fact : facts) {
    if (std::find(derivation.facts.begin(), derivation.facts.end(), fact) == derivation.facts.end())
      derivation.facts.push_back(fact);
  }
  found.push_back(std::move(derivation));
}

// Adds the pairs of the class of `term` that other rules make of asserted facts to ways_. True if any is new.
absl::StatusOr<bool> Prover::ConnectByRules(TermId term) {
  bool any = false;
  for (const TermId name : ways_.NamesOf(term)) {
    if (!connected_.insert(name).second) continue;
    absl::Status status;
    rules_.ForEachHead(same_as_, [&](RuleBase::Head place) {
      const RuleClause& rule = rules_.clauses()[place.clause];
      if (!rule.proves || rule.equality || !status.ok()) return;
      const auto& head = rule.heads[place.head].terms;
      std::vector<TermId> seed(rule.body.names.size());
      const auto bind = [&](const AtomTerm& at, TermId value) {
        TermId constant = at.constant;
        TermId& is = at.variable < 0 ? constant : seed[static_cast<size_t>(at.variable)];
        if (!is.IsNone() && is != value) return false;
        is = value;
        return true;
      };
      if (!bind(head[1], same_as_) || !bind(head[0], name)) return;
      status = solver().Solve(rule.body, seed, SolveOptions(), [&](const Solution& solution) {
        const bool told = std::all_of(solution.facts.begin(), solution.facts.end(),
                                      [&](const Quad& fact) { return !ToldQuads(fact).empty(); });
        const TermId other = head[2].variable < 0
                                 ? head[2].constant
                                 : solution.row.values[static_cast<size_t>(head[2].variable)];
        if (!told || other.IsNone() || other == name) return true;
        any = ways_.Connect(name, other) || any;
        return true;
      });
    });
    if (!status.ok()) return status;
    if (any) break;
  }
  return any;
}

absl::StatusOr<bool> Prover::DerivePair(const Quad& pair, std::vector<Derivation>& found) {
  const TermId a = pair.subject, b = pair.object;
  const auto pair_of = [this](TermId x, TermId y) { return Quad{x, same_as_, y, TermId()}; };
  std::vector<TermId> way = ways_.Way(a, b);
  while (way.empty()) {
    const auto connected = ConnectByRules(a);
    if (!connected.ok()) return connected.status();
    if (!*connected) return false;
    way = ways_.Way(a, b);
  }
  if (way.size() == 2) {  // asserted, or made by another rule, in one of the directions
    AddEqual(rules::EqualityRule::kSymmetry, {{"x", b}, {"y", a}}, {pair_of(b, a)}, found);
    return true;
  }
  // Half way, so that the depth of a proof is logarithmic in the length; only the last step may lead to a
  // literal.
  const TermId between = b.IsLiteral() ? way[way.size() - 2] : way[way.size() / 2];
  AddEqual(rules::EqualityRule::kTransitivity, {{"x", a}, {"y", between}, {"z", b}},
           {pair_of(a, between), pair_of(between, b)}, found);
  return true;
}

// The asserted fact that differs from `fact` in the fewest terms.
std::optional<Quad> Prover::ToldUnderOtherNames(const Quad& fact) {
  const std::vector<TermId> subjects = ways_.NamesOf(fact.subject),
                            predicates = ways_.NamesOf(fact.predicate), objects = ways_.NamesOf(fact.object);
  if (subjects.size() * predicates.size() * objects.size() > kManyNames) return std::nullopt;
  std::optional<Quad> best;
  int fewest = 4;
  for (const TermId s : subjects) {
    for (const TermId p : predicates) {
      for (const TermId o : objects) {
        const int others = (s != fact.subject) + (p != fact.predicate) + (o != fact.object);
        const Quad named = {s, p, o, TermId()};
        if (others == 0 || others >= fewest || ToldQuads(named).empty()) continue;
        fewest = others;
        best = named;
      }
    }
  }
  return best;
}

absl::StatusOr<bool> Prover::DeriveEqual(const Quad& fact, std::vector<Derivation>& found) {
  if (fact.predicate == same_as_ && version_.Count({fact.subject, same_as_, fact.object, TermId()}) > 0) {
    auto pair = DerivePair(fact, found);
    if (!pair.ok() || *pair) return pair;
  }
  const std::optional<Quad> told = ToldUnderOtherNames(fact);
  if (!told) return false;
  const Quad& s_p_o = *told;
  Quad maker = fact;
  if (s_p_o.subject != fact.subject) {
    maker.subject = s_p_o.subject;
    AddEqual(rules::EqualityRule::kSubject,
             {{"s", maker.subject}, {"s2", fact.subject}, {"p", fact.predicate}, {"o", fact.object}},
             {{maker.subject, same_as_, fact.subject, TermId()}, maker}, found);
  } else if (s_p_o.object != fact.object) {
    maker.object = s_p_o.object;
    AddEqual(rules::EqualityRule::kObject,
             {{"o", maker.object}, {"o2", fact.object}, {"s", fact.subject}, {"p", fact.predicate}},
             {{maker.object, same_as_, fact.object, TermId()}, maker}, found);
  } else {
    maker.predicate = s_p_o.predicate;
    AddEqual(rules::EqualityRule::kPredicate,
             {{"p", maker.predicate}, {"p2", fact.predicate}, {"s", fact.subject}, {"o", fact.object}},
             {{maker.predicate, same_as_, fact.predicate, TermId()}, maker}, found);
  }
  return true;
}

}  // namespace docent::explain
