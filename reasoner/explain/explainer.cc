#include "reasoner/explain/explainer.h"

#include <algorithm>

#include "graph/rdf/vocabulary.h"
#include "graph/store/read_trace.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent::explain {

Explainer::Explainer(const Settings& settings) : settings_(settings), dictionary_(settings.dictionary) {
  run_.version = settings_.version.get();
  run_.cancellation = settings_.cancellation;
  run_.now_us = settings_.now_us;
  if (settings_.default_graph == sparql::DefaultGraph::kStrict)
    default_graph_ = dictionary_.InternIri(kDefaultGraph);
}

absl::StatusOr<std::unique_ptr<Explainer>> Explainer::Make(const Settings& settings) {
  std::unique_ptr<Explainer> made(new Explainer(settings));
  if (settings.cancellation != nullptr)
    settings.cancellation->AllowSteps(settings.limits.StepsOfTurn(settings.version->size()));
  auto rules = RuleBase::Make(settings.rules, made->dictionary_, settings.limits);
  if (!rules.ok()) return rules.status();
  made->rules_ = *std::move(rules);
  made->prover_ =
      std::make_unique<Prover>(*settings.version, made->dictionary_, *made->rules_, settings.functions,
                               made->run_, settings.explain_limits, settings.prefixes);
  return made;
}

absl::Status Explainer::LookUpTellings(Proof& proof) {
  if (settings_.history == nullptr) return absl::OkStatus();
  ReadTrace::NoteAnything();  // a fact may be told again, which does not change the graph
  std::vector<TermQuad> quads;
  std::vector<Told*> places;
  for (ProofStep& step : proof.steps) {
    for (Told& told : step.told) {
      quads.push_back({step.fact.subject, step.fact.predicate, step.fact.object, told.graph});
      places.push_back(&told);
    }
  }
  auto tellings = settings_.history->Find(quads, *settings_.version, settings_.cancellation);
  if (!tellings.ok()) return tellings.status();
  for (size_t i = 0; i < places.size(); ++i) {
    if (!(*tellings)[i]) continue;
    places[i]->offset = (*tellings)[i]->offset;
    places[i]->time_us = (*tellings)[i]->time_us;
    places[i]->by = (*tellings)[i]->by;
  }
  return absl::OkStatus();
}

absl::StatusOr<std::optional<Proof>> Explainer::WhyFact(const TermQuad& fact) {
  Quad quad;
  const auto subject = dictionary_.Find(fact.subject);
  const auto predicate = dictionary_.Find(fact.predicate);
  const auto object = dictionary_.Find(fact.object);
  if (!subject || !predicate || !object) return std::optional<Proof>();
  quad = {*subject, *predicate, *object, TermId()};
  Proof proof;
  auto root = prover_->Add(quad, proof);
  if (!root.ok()) return root.status();
  if (!*root) return std::optional<Proof>();
  proof.roots.push_back(**root);
  if (absl::Status status = LookUpTellings(proof); !status.ok()) return status;
  return std::optional<Proof>(std::move(proof));
}

absl::StatusOr<bool> Explainer::Holds(const sparql::Query& ask) {
  sparql::PrepareOptions options;
  options.functions = settings_.functions;
  options.default_graph = settings_.default_graph;
  auto prepared = sparql::PreparedQuery::Prepare(ask, dictionary_, options);
  if (!prepared.ok()) return prepared.status();
  return (*prepared)->Ask(run_);
}

absl::StatusOr<std::optional<Proof>> Explainer::WhyAsk(const sparql::Query& ask) {
  if (!ask.from.empty() || !ask.from_named.empty()) {
    return absl::UnimplementedError("explanations of queries with FROM; leave it out, or use GRAPH");
  }
  auto holds = Holds(ask);
  if (!holds.ok()) return holds.status();
  if (!*holds) return std::optional<Proof>();
  auto clauses = ToClauses(matching::WithoutModifiers(*ask.algebra), dictionary_, default_graph_);
  if (!clauses.ok()) return clauses.status();
  Solver solver(*settings_.version, dictionary_, settings_.functions, run_,
                settings_.explain_limits.explain_steps);
  for (const Clause& clause : *clauses) {
    std::optional<Solution> first;
    absl::Status status = solver.Solve(clause, {}, SolveOptions(), [&](const Solution& solution) {
      first = solution;
      return false;
    });
    if (!status.ok()) return status;
    if (!first) continue;
    Proof proof;
    auto further = prover_->FurtherSupportOf(first->row);
    if (!further.ok()) return further.status();
    first->facts.insert(first->facts.end(), further->facts.begin(), further->facts.end());
    for (const Quad& quad : first->facts) {
      auto root = prover_->Add(quad, proof);
      if (!root.ok()) return root.status();
      if (*root && std::find(proof.roots.begin(), proof.roots.end(), **root) == proof.roots.end())
        proof.roots.push_back(**root);
    }
    for (size_t v = 0; v < clause.names.size(); ++v) {
      if (clause.written[v].empty() || first->row.values[v].IsNone()) continue;
      proof.bindings.emplace_back(clause.written[v], dictionary_.Decode(first->row.values[v]));
    }
    proof.conditions = std::move(further->conditions);
    if (absl::Status found = LookUpTellings(proof); !found.ok()) return found;
    return std::optional<Proof>(std::move(proof));
  }
  return absl::ResourceExhaustedError(
      "the condition holds, but its facts were not found within explain_steps");
}

absl::StatusOr<std::vector<Term>> Explainer::ValuesOf(const sparql::Query& ask, std::string_view variable,
                                                      size_t most) {
  auto clauses = ToClauses(matching::WithoutModifiers(*ask.algebra), dictionary_, default_graph_);
  if (!clauses.ok()) return clauses.status();
  Solver solver(*settings_.version, dictionary_, settings_.functions, run_,
                settings_.explain_limits.explain_steps);
  std::vector<Term> values;
  for (const Clause& clause : *clauses) {
    const auto named = std::find(clause.written.begin(), clause.written.end(), variable);
    if (named == clause.written.end()) continue;
    const size_t at = static_cast<size_t>(named - clause.written.begin());
    absl::Status status = solver.Solve(clause, {}, SolveOptions(), [&](const Solution& solution) {
      if (solution.row.values[at].IsNone()) return true;
      Term value = dictionary_.Decode(solution.row.values[at]);
      if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(std::move(value));
      return values.size() < most;
    });
    if (!status.ok()) return status;
    if (values.size() >= most) break;
  }
  return values;
}

absl::StatusOr<WhyNotAnswer> Explainer::WhyNot(const sparql::Query& ask, size_t sets) {
  if (!ask.from.empty() || !ask.from_named.empty()) {
    return absl::UnimplementedError("explanations of queries with FROM; leave it out, or use GRAPH");
  }
  auto holds = Holds(ask);
  if (!holds.ok()) return holds.status();
  WhyNotAnswer answer;
  answer.holds = *holds;
  if (answer.holds) return answer;
  auto hypothesis = Hypothesis::Make(settings_.version, dictionary_, settings_.rules, settings_.functions,
                                     settings_.limits, settings_.cancellation);
  if (!hypothesis.ok()) return hypothesis.status();
  WhyNotFinder::Parts parts;
  parts.version = settings_.version.get();
  parts.dictionary = &dictionary_;
  parts.rules = rules_.get();
  parts.hypothesis = hypothesis->get();
  parts.prover = prover_.get();
  parts.functions = settings_.functions;
  parts.run = run_;
  parts.limits = settings_.explain_limits;
  parts.may_change = settings_.may_change;
  parts.default_graph = default_graph_;
  parts.prefixes = settings_.prefixes;
  auto found = WhyNotFinder(std::move(parts)).Find(ask, sets);
  if (!found.ok() || !found->whole) ReadTrace::NoteAnything();  // the limits count more than what is read
  return found;
}

}  // namespace docent::explain
