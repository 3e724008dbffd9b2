#include "kb_server/turn/fact_port.h"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/store/delta_sum.h"
#include "graph/store/server_graphs.h"

namespace docent::server {
namespace {

// False: the graph has no such term, so that nothing matches.
bool Resolve(const Dictionary& dictionary, const std::optional<Term>& term, TermId* id) {
  if (!term) return true;
  const std::optional<TermId> known = dictionary.Find(*term);
  if (known) *id = *known;
  return known.has_value();
}

}  // namespace

absl::StatusOr<engine::FactMatches> FactPort::Match(const engine::FactPattern& pattern, size_t limit) const {
  engine::FactMatches matches;
  QuadPattern wanted;
  if (!Resolve(dictionary_, pattern.subject, &wanted.subject) ||
      !Resolve(dictionary_, pattern.predicate, &wanted.predicate) ||
      !Resolve(dictionary_, pattern.object, &wanted.object))
    return matches;
  if (const std::optional<TermId> inferred = dictionary_.FindIri(kInferredGraph)) {
    QuadPattern derived = wanted;
    derived.graph = *inferred;
    matches.inferred = version_.ContainsMatch(derived);
  }
  if (!pattern.source.empty()) {
    const std::optional<TermId> source = dictionary_.FindIri(pattern.source);
    if (!source) return matches;
    wanted.graph = *source;
  }
  bool too_many = false;
  version_.ForEach(wanted, [&](const Quad& quad) {
    TermQuad fact{dictionary_.Decode(quad.subject), dictionary_.Decode(quad.predicate),
                  dictionary_.Decode(quad.object), dictionary_.Decode(quad.graph)};
    if (IsServerGraph(fact.graph.lexical) || IsModuleGraph(fact.graph.lexical)) return true;
    too_many = matches.told.size() == limit;
    if (!too_many) matches.told.push_back(std::move(fact));
    return !too_many;
  });
  if (too_many) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "more than ", limit, " facts match; the limit of what runs write is facts_written_per_turn"));
  }
  // in term order: what is decided in the order of ids would be decided otherwise after a start
  std::sort(matches.told.begin(), matches.told.end(), [](const TermQuad& a, const TermQuad& b) {
    return std::tie(a.subject, a.predicate, a.object, a.graph) <
           std::tie(b.subject, b.predicate, b.object, b.graph);
  });
  return matches;
}

absl::StatusOr<std::vector<engine::TermBinding>> FactPort::Select(
    const sparql::Query& query, const engine::TermBinding& given,
    const std::vector<std::string>& columns) const {
  sparql::PrepareOptions options;
  options.functions = functions_;
  options.memory_bytes = kWorkflowLimits.assign_memory_bytes;
  std::vector<TermId> bound;
  for (const auto& [name, value] : given) {
    options.bound.push_back(name);
    bound.push_back(dictionary_.Intern(value));
  }
  auto prepared = sparql::PreparedQuery::Prepare(query, dictionary_, options);
  if (!prepared.ok()) return prepared.status();
  Cancellation steps;
  const uint64_t allowed = AllowSteps(&steps);
  std::vector<engine::TermBinding> solutions;
  bool too_many = false;
  const absl::Status status =
      (*prepared)->Select({.version = &version_, .cancellation = &steps, .now_us = now_us_, .seed = seed_},
                          bound, [&](absl::Span<const TermId> row) {
                            too_many = solutions.size() == kWorkflowLimits.assign_solutions;
                            if (too_many) return false;
                            engine::TermBinding& solution = solutions.emplace_back();
                            for (size_t i = 0; i < row.size() && i < columns.size(); ++i) {
                              if (!row[i].IsNone()) solution.emplace(columns[i], (*prepared)->Decode(row[i]));
                            }
                            return true;
                          });
  if (!CountSteps(steps, allowed)) {
    const bool of_turn = allowed < kWorkflowLimits.assign_steps;
    return absl::ResourceExhaustedError(
        absl::StrCat("its query takes too long: it was stopped after ", allowed, " steps; the limit ",
                     of_turn ? "assign_steps_per_turn" : "assign_steps", " is ",
                     of_turn ? kWorkflowLimits.assign_steps_per_turn : kWorkflowLimits.assign_steps));
  }
  // A query names the limit of queries.
  if (absl::IsResourceExhausted(status) && absl::StrContains(status.message(), "query_memory_bytes")) {
    return absl::ResourceExhaustedError(
        absl::StrCat("its query needs too much memory; the limit assign_memory_bytes is ",
                     kWorkflowLimits.assign_memory_bytes));
  }
  if (!status.ok()) return status;
  if (too_many) {
    return absl::ResourceExhaustedError(
        absl::StrCat("its SELECT has more than ", kWorkflowLimits.assign_solutions,
                     " solutions; the limit is assign_solutions; write LIMIT"));
  }
  return solutions;
}

uint64_t FactPort::AllowSteps(Cancellation* steps) const {
  const uint64_t allowed =
      std::min(kWorkflowLimits.assign_steps, kWorkflowLimits.assign_steps_per_turn - steps_);
  steps->AllowSteps(allowed);
  // What ends the turn ends this, too. Such a turn is refused as a whole.
  if (cancellation_ != nullptr) {
    steps->OnLook([this, steps](const Cancellation&) {
      if (cancellation_->IsOver()) steps->Cancel();
    });
  }
  return allowed;
}

bool FactPort::CountSteps(const Cancellation& steps, uint64_t allowed) const {
  const int64_t left = steps.steps_left();
  steps_ += left < 0 ? allowed : allowed - static_cast<uint64_t>(left);
  return left >= 0;
}

absl::StatusOr<bool> FactPort::Holds(const sparql::Query& ask) const {
  sparql::PrepareOptions options;
  options.functions = functions_;
  options.memory_bytes = kWorkflowLimits.assign_memory_bytes;
  auto prepared = sparql::PreparedQuery::Prepare(ask, dictionary_, options);
  if (!prepared.ok()) return prepared.status();
  Cancellation steps;
  const uint64_t allowed = AllowSteps(&steps);
  const absl::StatusOr<bool> holds =
      (*prepared)->Ask({.version = &version_, .cancellation = &steps, .now_us = now_us_, .seed = seed_}, {});
  if (!CountSteps(steps, allowed)) return absl::ResourceExhaustedError("the limit is assign_steps");
  return holds;
}

absl::Status ApplyWrites(absl::Span<const engine::FactWrite> writes, TimeMicros now_us, BatchApplier* applier,
                         GraphWriter* writer, Delta* delta, std::vector<Quad>* told_events) {
  if (writes.empty()) return absl::OkStatus();
  DeltaSum sum;
  sum.Add(*delta);
  for (auto it = writes.begin(); it != writes.end();) {
    WriteBatch batch;  // of one lifetime
    batch.time_us = now_us;
    batch.lifetime_ms = it->lifetime_ms;
    for (; it != writes.end() && it->lifetime_ms == batch.lifetime_ms; ++it) {
      batch.operations.push_back(
          {it->tells ? QuadOperation::Kind::kAdd : QuadOperation::Kind::kRemove, it->quad});
    }
    absl::StatusOr<Delta> applied = applier->Apply(batch, *writer);
    if (!applied.ok()) return applied.status();
    told_events->insert(told_events->end(), applier->told_events().begin(), applier->told_events().end());
    sum.Add(*applied);
  }
  *delta = sum.Net();
  return absl::OkStatus();
}

}  // namespace docent::server
