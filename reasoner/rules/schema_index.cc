#include "reasoner/rules/schema_index.h"

#include <algorithm>
#include <utility>

namespace docent {

absl::Status SchemaIndex::Build(RuleProgram& program, const GraphVersion& graph, Cancellation* cancellation) {
  program_ = &program;
  const sparql::RunOptions run{.version = &graph, .cancellation = cancellation};
  ++changes_;
  instances_.clear();
  free_.clear();
  by_triple_.clear();
  triggers_ = PatternIndex();
  heads_ = PatternIndex();
  for (uint32_t r = 0; r < program.rules.size(); ++r) {
    if (program.rules[r].schema == 0) continue;
    const std::vector<TermId> nothing(program.rules[r].body->columns().size());
    if (absl::Status status = Find(r, nothing, 0, run); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status SchemaIndex::Gained(const Triple& triple, const GraphVersion& graph,
                                 Cancellation* cancellation) {
  if (program_ == nullptr) return absl::OkStatus();
  absl::InlinedVector<PatternIndex::Reference, 4> found;
  const Quad quad = {triple.subject, triple.predicate, triple.object, TermId()};
  program_->schema_triggers.ForEachMatch(quad, [&](PatternIndex::Reference r) { found.push_back(r); });
  const sparql::RunOptions run{.version = &graph, .cancellation = cancellation};
  for (const PatternIndex::Reference& reference : found) {
    Body& body = *program_->rules[reference.owner].body;
    const Trigger& trigger = body.triggers()[reference.pattern];
    std::vector<TermId> seed;
    body.SeedFrom(trigger, quad, seed);
    if (absl::Status status = Find(reference.owner, seed, 1u << trigger.pattern, run); !status.ok())
      return status;
  }
  return absl::OkStatus();
}

absl::Status SchemaIndex::Find(uint32_t rule, absl::Span<const TermId> seed, uint32_t matched,
                               const sparql::RunOptions& run) {
  const CompiledRule& compiled = program_->rules[rule];
  const uint32_t data = compiled.patterns & ~compiled.schema;
  return compiled.Named(compiled.body->EvaluateRest(run, seed, matched | data, Body::Filters::kBound,
                                                    [&](absl::Span<const TermId> row) {
                                                      Add(rule, row);
                                                      return true;
                                                    }));
}

void SchemaIndex::Add(uint32_t rule, absl::Span<const TermId> row) {
  const CompiledRule& compiled = program_->rules[rule];
  absl::InlinedVector<Triple, 4> support;
  for (size_t i = 0; i < compiled.body->patterns().size(); ++i) {
    if (compiled.schema & (1u << i)) support.push_back(compiled.Premise(i, row));
  }
  std::sort(support.begin(), support.end());
  support.erase(std::unique(support.begin(), support.end()), support.end());
  for (const uint32_t id : by_triple_[support[0]]) {
    if (instances_[id].rule == rule && std::equal(row.begin(), row.end(), instances_[id].row.begin())) return;
  }
  uint32_t id;
  if (free_.empty()) {
    id = static_cast<uint32_t>(instances_.size());
    instances_.emplace_back();
  } else {
    id = free_.back();
    free_.pop_back();
  }
  ++changes_;
  for (const Triple& triple : support) by_triple_[triple].push_back(id);
  Instance& instance = instances_[id];
  instance.rule = rule;
  instance.row.assign(row.begin(), row.end());
  const std::vector<Trigger>& triggers = compiled.body->triggers();
  for (uint32_t i = 0; i < triggers.size(); ++i) {
    if (compiled.schema & (1u << triggers[i].pattern)) continue;
    instance.triggers.push_back(triggers_.Add(compiled.body->Instantiate(triggers[i], row), {id, i}));
  }
  for (uint32_t i = 0; i < compiled.head.size(); ++i) {
    const HeadTriple& head = compiled.head[i];
    MatchPattern match;
    const std::array<TermId*, 3> places = {&match.constants.subject, &match.constants.predicate,
                                           &match.constants.object};
    for (int k = 0; k < 3; ++k) {
      *places[k] = head.columns[k] == Trigger::kNoColumn ? head.constants[k] : row[head.columns[k]];
    }
    instance.heads.push_back(heads_.Add(match, {id, i}));
  }
}

void SchemaIndex::Lost(const Triple& triple) {
  const auto found = by_triple_.find(triple);
  if (found == by_triple_.end()) return;
  const absl::InlinedVector<uint32_t, 2> gone = found->second;
  for (const uint32_t id : gone) Remove(id);
}

void SchemaIndex::Remove(uint32_t id) {
  Instance& instance = instances_[id];
  const CompiledRule& compiled = program_->rules[instance.rule];
  for (size_t i = 0; i < compiled.body->patterns().size(); ++i) {
    if (!(compiled.schema & (1u << i))) continue;
    const auto place = by_triple_.find(compiled.Premise(i, instance.row));
    if (place == by_triple_.end()) continue;  // two patterns on one triple
    auto& ids = place->second;
    ids.erase(std::remove(ids.begin(), ids.end(), id), ids.end());
    if (ids.empty()) by_triple_.erase(place);
  }
  for (const PatternIndex::Handle handle : instance.triggers) triggers_.Remove(handle);
  for (const PatternIndex::Handle handle : instance.heads) heads_.Remove(handle);
  instance = Instance();
  ++changes_;
  free_.push_back(id);
}

}  // namespace docent
