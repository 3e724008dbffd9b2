#include "reasoner/explain/proof.h"

#include <algorithm>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "reasoner/explain/display.h"

namespace docent::explain {
namespace {

constexpr int kDeepest = 1000;  // depth of a proof; deeper ones are not searched
constexpr int kIdleRounds = 8;  // without a new fact or proof: made by unknown rules

GraphVersionPtr SeenByRules(const GraphVersion& version, rules::InconsistencyFacts& reports) {
  reports.InternWords();
  return version.Without(reports);
}

sparql::RunOptions On(const GraphVersionPtr& version, sparql::RunOptions run) {
  run.version = version.get();
  return run;
}

}  // namespace

Prover::Prover(const GraphVersion& version, Dictionary& dictionary, const RuleBase& rules,
               const sparql::FunctionRegistry* functions, const sparql::RunOptions& run,
               const ExplainLimits& limits, std::vector<std::pair<std::string, std::string>> prefixes)
    : version_(version),
      dictionary_(dictionary),
      rules_(rules),
      functions_(functions),
      reports_of_checks_(dictionary),
      seen_by_rules_(SeenByRules(version, reports_of_checks_)),
      rule_run_(On(seen_by_rules_, run)),
      limits_(limits),
      inferred_(dictionary.InternIri(kInferredGraph)),
      prefixes_(std::move(prefixes)),
      reports_(version, dictionary, rules, functions, rule_run_),
      solver_(*seen_by_rules_, dictionary, functions, rule_run_, limits.explain_steps),
      part_facts_(version, dictionary, functions, run, limits.explain_steps),
      rule_parts_(*seen_by_rules_, dictionary, functions, rule_run_, limits.explain_steps),
      same_as_(dictionary.InternIri(rules::kOwlSameAs)),
      ways_(version, same_as_, inferred_) {}

std::vector<Quad> Prover::ToldQuads(const Quad& fact) const {
  std::vector<Quad> told;
  version_.ForEach({fact.subject, fact.predicate, fact.object, TermId()}, [&](const Quad& quad) {
    if (quad.graph != inferred_) told.push_back(quad);
    return true;
  });
  return told;
}

// By rule heads; also the checks whose report contains the fact.
absl::StatusOr<std::vector<Prover::Maker>> Prover::MakersOf(const Quad& fact) {
  std::vector<Maker> makers;
  const std::array<TermId, 3> terms = {fact.subject, fact.predicate, fact.object};
  rules_.ForEachHead(fact.predicate, [&](RuleBase::Head place) {
    const RuleClause& rule = rules_.clauses()[place.clause];
    if (!rule.proves) return;
    std::vector<TermId> seed(rule.body.names.size());
    for (int i = 0; i < 3; ++i) {
      const AtomTerm& head = rule.heads[place.head].terms[i];
      TermId constant = head.constant;
      TermId& value = head.variable < 0 ? constant : seed[head.variable];
      if (!value.IsNone() && value != terms[i]) return;
      value = terms[i];
    }
    makers.push_back({place.clause, std::move(seed)});
  });
  auto origins = reports_.Of(fact);
  if (!origins.ok()) return origins.status();
  for (const ReportOrigins::Origin& origin : *origins) {
    for (uint32_t c = 0; c < rules_.clauses().size(); ++c) {
      const RuleClause& check = rules_.clauses()[c];
      if (check.rule != origin.rule || !check.proves) continue;
      std::vector<TermId> seed(check.body.names.size());
      for (const auto& [name, value] : origin.values) {
        if (const int variable = check.body.Find(name); variable >= 0) seed[variable] = value;
      }
      makers.push_back({c, std::move(seed)});
    }
  }
  return makers;
}

Prover::Known& Prover::KnownOf(const Quad& fact) {
  std::unique_ptr<Known>& place = known_[fact];
  if (place == nullptr) {
    place = std::make_unique<Known>();
    if (!ToldQuads(fact).empty()) place->proven = 0;
  }
  return *place;
}

// Ways in which one rule makes the fact from facts of the version, until they are enough.
absl::Status Prover::Derive(const Quad& fact, Enough enough, std::vector<Derivation>& found) {
  auto makers = MakersOf(fact);
  if (!makers.ok()) return makers.status();
  if (!rules_.equality().empty()) {
    const auto equality = std::stable_partition(makers->begin(), makers->end(), [&](const Maker& maker) {
      return !rules_.clauses()[maker.clause].equality;
    });
    const std::vector<Maker> others(makers->begin(), equality);
    if (absl::Status status = DeriveBy(others, fact, enough, found); !status.ok()) return status;
    const auto equal = DeriveEqual(fact, found);
    if (!equal.ok()) return equal.status();
    if (*equal) return absl::OkStatus();
    makers->erase(makers->begin(), equality);  // all ways in which equality makes it
  }
  return DeriveBy(*makers, fact, enough, found);
}

absl::Status Prover::DeriveBy(const std::vector<Maker>& makers, const Quad& fact, Enough enough,
                              std::vector<Derivation>& found) {
  const size_t first = found.size();
  for (const Maker& maker : makers) {
    if (enough(found)) break;
    const Clause& body = rules_.clauses()[maker.clause].body;
    absl::Status status = solver().Solve(body, maker.seed, SolveOptions(), [&](const Solution& solution) {
      Derivation derivation{maker.clause, solution.row, {}};
      for (const Quad& quad : solution.facts) {
        const Quad premise = WithoutGraph(quad);
        if (premise == fact) return true;  // a circular proof
        if (std::find(derivation.facts.begin(), derivation.facts.end(), premise) == derivation.facts.end())
          derivation.facts.push_back(premise);
      }
      found.push_back(std::move(derivation));
      return !enough(found);
    });
    if (!status.ok()) return status;
  }
  for (size_t i = first; i < found.size(); ++i) {
    Derivation& derivation = found[i];
    if (derivation.row.clause->parts.empty()) continue;
    auto further = FurtherSupportOf(derivation.row, rule_parts_);
    if (!further.ok()) return further.status();
    derivation.whole = further->whole;
    for (const Quad& quad : further->facts) {
      const Quad premise = WithoutGraph(quad);
      if (std::find(derivation.facts.begin(), derivation.facts.end(), premise) == derivation.facts.end())
        derivation.facts.push_back(premise);
    }
  }
  return absl::OkStatus();
}

absl::Status Prover::TooManySteps() const {
  return absl::ResourceExhaustedError(absl::StrCat(
      "the search for a proof took more than explain_steps = ", limits_.explain_steps, " steps"));
}

// True if there is a proof of at most this depth. Iterative deepening finds a proof of minimum depth first.
absl::StatusOr<bool> Prover::Prove(const Quad& fact, int depth) {
  if (solver_.exhausted() || ++calls_ > limits_.explain_steps) return TooManySteps();
  Known& known = KnownOf(fact);
  if (known.proven >= 0) return known.proven <= depth;
  for (int d = known.refuted + 1; d <= depth; ++d) {
    if (d > 0 && !known.derived) {
      known.derived = true;
      const auto enough = [](const std::vector<Derivation>& found) {
        return found.size() >= kDerivationsLooked;
      };
      if (absl::Status status = Derive(fact, enough, known.derivations); !status.ok()) return status;
      if (solver_.exhausted()) {  // there may be others
        known.derived = false;
        known.derivations.clear();
        return TooManySteps();
      }
    }
    known.refuted = d;  // a proof that contains the fact itself does not count
    for (size_t i = 0; d > 0 && i < known.derivations.size(); ++i) {
      bool all = true;
      for (size_t p = 0; all && p < known.derivations[i].facts.size(); ++p) {
        auto proven = Prove(known.derivations[i].facts[p], d - 1);
        if (!proven.ok()) return proven;
        all = *proven;
      }
      if (!all) continue;
      known.proven = d;
      ++proven_;
      known.best = i;
      return true;
    }
  }
  return false;
}

// The derivation on which the step rests; null: it is told, or made by rules that are not known here.
absl::StatusOr<const Prover::Derivation*> Prover::WriteStep(const Quad& fact, ProofStep& step) {
  step.fact = {dictionary_.Decode(fact.subject), dictionary_.Decode(fact.predicate),
               dictionary_.Decode(fact.object), Term()};
  for (const Quad& quad : ToldQuads(fact)) step.told.push_back({dictionary_.Decode(quad.graph), 0, 0, ""});
  if (!step.told.empty()) return nullptr;
  const Known& known = *known_.at(fact);
  if (known.proven < 0) return nullptr;
  const Derivation& derivation = known.derivations[known.best];
  const RuleClause& rule = rules_.clauses()[derivation.clause];
  step.rule = rules_.rules()[rule.rule].label;
  step.depth = static_cast<size_t>(known.proven);
  for (size_t v = 0; v < rule.body.names.size(); ++v) {
    if (rule.body.written[v].empty() || derivation.row.values[v].IsNone()) continue;
    step.bindings.emplace_back(rule.body.written[v], dictionary_.Decode(derivation.row.values[v]));
  }
  auto further = FurtherSupportOf(derivation.row, rule_parts_);
  if (!further.ok()) return further.status();
  step.conditions = std::move(further->conditions);
  return &derivation;
}

// Depth first, without recursion: a proof may be thousands of steps deep.
absl::StatusOr<size_t> Prover::Write(const Quad& fact, Proof& proof,
                                     absl::flat_hash_map<Quad, size_t>& placed) {
  struct Open {
    size_t number;
    const Derivation* derivation;
    size_t written = 0;  // premises
  };
  std::vector<Open> open;
  const auto place = [&](const Quad& quad) -> absl::StatusOr<size_t> {
    const auto [at, is_new] = placed.try_emplace(quad, proof.steps.size());
    if (!is_new) return at->second;
    if (proof.steps.size() >= limits_.explain_facts) {
      return absl::ResourceExhaustedError(
          absl::StrCat("the proof has more facts than explain_facts = ", limits_.explain_facts));
    }
    const size_t number = at->second;
    auto derivation = WriteStep(quad, proof.steps.emplace_back());
    if (!derivation.ok()) return derivation.status();
    if (*derivation != nullptr) open.push_back({number, *derivation});
    return number;
  };
  const absl::StatusOr<size_t> root = place(fact);
  while (root.ok() && !open.empty()) {
    Open& at = open.back();
    if (at.written == at.derivation->facts.size()) {
      open.pop_back();
      continue;
    }
    const size_t number = at.number;
    const absl::StatusOr<size_t> premise = place(at.derivation->facts[at.written++]);
    if (!premise.ok()) return premise;
    proof.steps[number].premises.push_back(*premise);
  }
  return root;
}

// Finds a proof of any depth, if there is one.
absl::Status Prover::Prove(const Quad& fact) {
  size_t before = 0;
  int idle = 0;
  for (int depth = 0; depth <= kDeepest && idle < kIdleRounds; ++depth) {
    auto proven = Prove(fact, depth);
    if (!proven.ok()) return proven.status();
    if (*proven) break;
    const size_t learnt = known_.size() + proven_;
    idle = learnt == before ? idle + 1 : 0;
    before = learnt;
  }
  return absl::OkStatus();
}

absl::StatusOr<std::optional<size_t>> Prover::Add(const Quad& quad, Proof& proof) {
  const Quad fact = WithoutGraph(quad);
  if (version_.Count({fact.subject, fact.predicate, fact.object, TermId()}) == 0)
    return std::optional<size_t>();
  absl::Status proven = Prove(fact);
  if (absl::IsResourceExhausted(proven)) proven = ProveByGoals(fact);
  if (!proven.ok()) return proven;
  absl::flat_hash_map<Quad, size_t> placed;
  for (size_t i = 0; i < proof.steps.size(); ++i) {
    const TermQuad& f = proof.steps[i].fact;
    placed[{*dictionary_.Find(f.subject), *dictionary_.Find(f.predicate), *dictionary_.Find(f.object),
            TermId()}] = i;
  }
  auto number = Write(fact, proof, placed);
  if (!number.ok()) return number.status();
  return std::optional<size_t>(*number);
}

absl::StatusOr<Support> Prover::SupportOf(const Quad& quad) {
  Support support;
  std::vector<Quad> open = {WithoutGraph(quad)};
  if (absl::Status status = Prove(open[0]); !status.ok()) return status;
  absl::flat_hash_set<Quad> seen = {open[0]};
  while (!open.empty()) {
    const Quad fact = open.back();
    open.pop_back();
    if (!ToldQuads(fact).empty()) {
      support.told.push_back(fact);
      continue;
    }
    const Known& known = *known_.at(fact);
    if (known.proven < 0) {
      support.whole = false;
      continue;
    }
    const Derivation& derivation = known.derivations[known.best];
    support.whole = support.whole && derivation.whole;
    for (const Absence& absence : derivation.row.clause->absences)
      support.absences.push_back({&absence, derivation.row});
    for (auto premise = derivation.facts.rbegin(); premise != derivation.facts.rend(); ++premise) {
      if (seen.insert(*premise).second) open.push_back(*premise);
    }
  }
  return support;
}

absl::StatusOr<Prover::FurtherSupport> Prover::FurtherSupportOf(const Row& row) {
  return FurtherSupportOf(row, part_facts_);
}

absl::StatusOr<Prover::FurtherSupport> Prover::FurtherSupportOf(const Row& row, PartFacts& parts) {
  FurtherSupport further;
  const Display display(prefixes_);
  const Values values = ValuesOf(row, dictionary_);
  for (const Test& test : row.clause->tests)
    further.conditions.push_back(display.Filter(*test.expression, values));
  for (const Absence& absence : row.clause->absences) {
    further.conditions.push_back(absl::StrCat("no ", display.Pattern(*absence.source, values)));
  }
  for (const Part& part : row.clause->parts) {
    auto ground = parts.Of(part, row);
    if (!ground.ok()) return ground.status();
    Values own = values;  // a variable between two parts has a name only in them
    const std::vector<sparql::Variable> scope = sparql::InScopeVariables(*part.pattern);
    for (size_t i = 0; i < scope.size(); ++i) {
      const TermId value = row.values[static_cast<size_t>(part.variables[i])];
      if (!value.IsNone())
        own.insert_or_assign(scope[i].name, sparql::PatternTerm::Of(dictionary_.Decode(value)));
    }
    if (part.graph.variable >= 0) {
      const TermId graph = row.values[static_cast<size_t>(part.graph.variable)];
      if (!graph.IsNone())
        own.insert_or_assign(std::string(kGraphOfPart), sparql::PatternTerm::Of(dictionary_.Decode(graph)));
    }
    std::string& text = further.conditions.emplace_back(
        display.Pattern(*InItsGraph(part, dictionary_, std::string(kGraphOfPart)), own));
    if (ground->more > 0)
      absl::StrAppend(&text, "   (by ", ground->facts.size(), " facts that are shown, and ", ground->more,
                      " more)");
    further.facts.insert(further.facts.end(), ground->facts.begin(), ground->facts.end());
    further.whole = further.whole && ground->whole;
  }
  return further;
}

}  // namespace docent::explain
