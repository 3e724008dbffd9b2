#include "reasoner/rules/schema_index.h"

#include <algorithm>
#include <utility>

#include "absl/hash/hash.h"
#include "graph/base/step_costs.h"

namespace docent::rules {

absl::Status SchemaIndex::Build(RuleProgram& program, const GraphVersion& graph, Cancellation* cancellation) {
  program_ = &program;
  const sparql::RunOptions run{.version = &graph, .cancellation = cancellation};
  ++changes_;
  instances_.clear();
  free_.clear();
  by_triple_.clear();
  by_row_.clear();
  triggers_ = matching::PatternIndex();
  heads_ = matching::PatternIndex();
  for (uint32_t r = 0; r < program.rules.size(); ++r) {
    if (program.rules[r].schema == 0 || program.rules[r].of_equality) continue;
    const std::vector<TermId> nothing(program.rules[r].body->columns().size());
    if (absl::Status status = Find(r, nothing, 0, run); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status SchemaIndex::Gained(const Triple& triple, const GraphVersion& graph,
                                 Cancellation* cancellation) {
  if (program_ == nullptr) return absl::OkStatus();
  absl::InlinedVector<matching::PatternIndex::Reference, 4> found;
  const Quad quad = {triple.subject, triple.predicate, triple.object, TermId()};
  program_->schema_triggers.ForEachMatch(quad,
                                         [&](matching::PatternIndex::Reference r) { found.push_back(r); });
  const sparql::RunOptions run{.version = &graph, .cancellation = cancellation};
  for (const matching::PatternIndex::Reference& reference : found) {
    matching::Body& body = *program_->rules[reference.owner].body;
    const matching::Trigger& trigger = body.triggers()[reference.pattern];
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
  return compiled.Named(compiled.body->EvaluateRest(
      run, seed, matched | data, matching::Body::Filters::kBound, [&](absl::Span<const TermId> row) {
        Add(rule, row);
        if (run.cancellation != nullptr) run.cancellation->Spend(kStepsOfInstance);
        return true;
      }));
}

SchemaIndex::Support SchemaIndex::SupportOf(uint32_t rule, absl::Span<const TermId> row) const {
  const CompiledRule& compiled = program_->rules[rule];
  Support support;
  for (size_t i = 0; i < compiled.body->patterns().size(); ++i) {
    if (compiled.schema & (1u << i)) support.push_back(compiled.Premise(i, row));
  }
  std::sort(support.begin(), support.end());
  support.erase(std::unique(support.begin(), support.end()), support.end());
  return support;
}

void SchemaIndex::Add(uint32_t rule, absl::Span<const TermId> row) {
  const CompiledRule& compiled = program_->rules[rule];
  auto& of_row = by_row_[absl::HashOf(rule, row)];
  for (const uint32_t id : of_row) {
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
  of_row.push_back(id);
  ++changes_;
  Instance& instance = instances_[id];
  const Support support = SupportOf(rule, row);
  for (uint32_t i = 0; i < support.size(); ++i) {
    auto& places = by_triple_[support[i]];
    instance.places.push_back(static_cast<uint32_t>(places.size()));
    places.push_back({id, i});
  }
  instance.rule = rule;
  instance.row.assign(row.begin(), row.end());
  const std::vector<matching::Trigger>& triggers = compiled.body->triggers();
  for (uint32_t i = 0; i < triggers.size(); ++i) {
    if (compiled.schema & (1u << triggers[i].pattern)) continue;
    instance.triggers.push_back(triggers_.Add(compiled.body->Instantiate(triggers[i], row), {id, i}));
  }
  for (uint32_t i = 0; i < compiled.head.size(); ++i) {
    const HeadTriple& head = compiled.head[i];
    matching::MatchPattern match;
    const std::array<TermId*, 3> places = {&match.constants.subject, &match.constants.predicate,
                                           &match.constants.object};
    for (int k = 0; k < 3; ++k) {
      *places[k] = head.columns[k] == matching::Trigger::kNoColumn ? head.constants[k] : row[head.columns[k]];
    }
    instance.heads.push_back(heads_.Add(match, {id, i}));
  }
}

void SchemaIndex::Lost(const Triple& triple) {
  for (auto found = by_triple_.find(triple); found != by_triple_.end(); found = by_triple_.find(triple))
    Remove(found->second.back().instance);
}

// In each list the last entry moves to its place.
void SchemaIndex::Remove(uint32_t id) {
  Instance& instance = instances_[id];
  const Support support = SupportOf(instance.rule, instance.row);
  for (size_t i = 0; i < support.size(); ++i) {
    const auto found = by_triple_.find(support[i]);
    auto& places = found->second;
    const uint32_t at = instance.places[i];
    places[at] = places.back();
    instances_[places[at].instance].places[places[at].number] = at;
    places.pop_back();
    if (places.empty()) by_triple_.erase(found);
  }
  const auto of_row = by_row_.find(absl::HashOf(instance.rule, absl::MakeConstSpan(instance.row)));
  of_row->second.erase(std::find(of_row->second.begin(), of_row->second.end(), id));
  if (of_row->second.empty()) by_row_.erase(of_row);
  for (const matching::PatternIndex::Handle handle : instance.triggers) triggers_.Remove(handle);
  for (const matching::PatternIndex::Handle handle : instance.heads) heads_.Remove(handle);
  instance = Instance();
  ++changes_;
  free_.push_back(id);
}

}  // namespace docent::rules
