#include "reasoner/matching/body_plan.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "graph/base/step_costs.h"

namespace docent::matching {

struct Body::FlatPlan::Run {
  static constexpr uint64_t kStepsAPoll = 1024;
  const sparql::RunOptions& options;
  Visitor visit;
  Filters filters;
  absl::Status status;
  uint64_t decided = 0;  // bits of filters (the first 64) that hold whatever the join finds
  uint64_t steps = 0;    // since the last Poll

  // False: end the evaluation.
  bool Step(uint64_t made = 1) { return (steps += made) < kStepsAPoll || Poll(true); }
  // `now`: reads the clock.
  bool Poll(bool now) {
    const uint64_t made = std::exchange(steps, 0);
    if (options.cancellation == nullptr) return true;
    options.cancellation->Spend(made);
    if (status.ok()) status = now ? options.cancellation->CheckNow() : options.cancellation->Check();
    return status.ok();
  }
};

std::optional<bool> TestTerms(const TermTest& test, absl::Span<const TermId> row) {
  const TermId left = row[test.left];
  const TermId right = test.right == Trigger::kNoColumn ? test.constant : row[test.right];
  const auto named = [](TermId id) { return id.IsIri() || id.IsBlank(); };
  if (!named(left) || !named(right)) return std::nullopt;
  return (left == right) == test.equal;
}

absl::Status Body::FlatPlan::Prepare(Filter& filter) {
  auto prepared =
      sparql::PreparedExpression::Prepare(*filter.source, names_, dictionary_, {.functions = functions_});
  if (!prepared.ok()) return prepared.status();
  filter.expression = *std::move(prepared);
  filter.source.reset();
  return absl::OkStatus();
}

absl::Status Body::FlatPlan::Build(std::vector<Pattern> patterns, std::vector<Filter> filters,
                                   std::vector<std::string> names) {
  patterns_ = std::move(patterns);
  filters_ = std::move(filters);
  names_ = std::move(names);
  for (Filter& filter : filters_) {
    if (filter.test || filter.terms || filter.exists) continue;
    if (absl::Status status = Prepare(filter); !status.ok()) return status;
  }
  return absl::OkStatus();
}

uint32_t Body::FlatPlan::PickNext(const GraphVersion& version, uint32_t open, bool& impossible) const {
  if ((open & (open - 1)) == 0) return static_cast<uint32_t>(__builtin_ctz(open));
  uint32_t best = 0;
  uint64_t fewest = std::numeric_limits<uint64_t>::max();
  for (uint32_t rest = open; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<uint32_t>(__builtin_ctz(rest));
    const uint64_t count = version.Count(Bind(patterns_[i], row_));
    if (count < fewest) {
      fewest = count;
      best = i;
    }
    if (count == 0) {
      impossible = true;
      break;
    }
  }
  return best;
}

bool Body::FlatPlan::TestBound(int16_t column) const {
  for (const Filter& filter : filters_) {
    if (filter.terms && (filter.terms->left == column || filter.terms->right == column) &&
        TestTerms(*filter.terms, row_) == std::optional<bool>(false)) {
      return false;
    }
    if (!filter.test || (filter.test->left != column && filter.test->right != column)) continue;
    if (TestNumbers(*filter.test, row_) == std::optional<bool>(false)) return false;
  }
  return true;
}

bool Body::FlatPlan::IsBound(const Filter& filter) const {
  return std::none_of(filter.columns.begin(), filter.columns.end(),
                      [&](int16_t column) { return column < 0 || row_[column].IsNone(); });
}

bool Body::FlatPlan::Exists(const ExistsTest& test, const GraphVersion& version) const {
  return version.ContainsMatch(Bind(test.pattern, row_)) != test.negated;
}

// Looks up the patterns that the seed decides once, before the join. False: there is no solution.
bool Body::FlatPlan::TestSeeded(Run& run) const {
  for (size_t i = 0; i < std::min<size_t>(filters_.size(), 64); ++i) {
    const Filter& filter = filters_[i];
    if (!filter.exists || (run.filters == Filters::kBound && !IsBound(filter))) continue;
    const auto& columns = filter.exists->pattern.columns;
    const bool seeded = std::all_of(columns.begin(), columns.end(), [&](int16_t column) {
      return column == Trigger::kNoColumn || !row_[column].IsNone();
    });
    if (!seeded) continue;
    if (!run.Step(kStepsOfLookup) || !Exists(*filter.exists, *run.options.version)) return false;
    run.decided |= uint64_t{1} << i;
  }
  return true;
}

// False: end the evaluation.
bool Body::FlatPlan::Leaf(Run& run) {
  if (run.filters == Filters::kNone) return run.visit(row_);
  for (size_t i = 0; i < filters_.size(); ++i) {
    Filter& filter = filters_[i];
    if (run.filters == Filters::kBound && !IsBound(filter)) continue;
    if (filter.exists) {
      if (i < 64 && (run.decided >> i & 1) != 0) continue;
      if (!run.Step(kStepsOfLookup)) return false;
      if (!Exists(*filter.exists, *run.options.version)) return true;
      continue;
    }
    if (filter.test || filter.terms) {
      const std::optional<bool> decided =
          filter.test ? TestNumbers(*filter.test, row_) : TestTerms(*filter.terms, row_);
      if (decided == std::optional<bool>(true)) continue;
      if (decided == std::optional<bool>(false)) return true;
      if (!filter.expression) {
        run.status = Prepare(filter);
        if (!run.status.ok()) return false;
      }
    }
    if (!run.Step(kStepsOfExpression)) return false;
    const absl::StatusOr<bool> holds = filter.expression->Test(run.options, row_);
    if (!holds.ok()) {
      run.status = holds.status();
      return false;
    }
    if (!*holds) return true;
  }
  return run.visit(row_);
}

bool Body::FlatPlan::Join(Run& run, uint32_t open) {
  if (open == 0) return Leaf(run);
  if (!run.Step(kStepsOfLookup)) return false;
  bool impossible = false;
  const uint32_t next = PickNext(*run.options.version, open, impossible);
  if (impossible) return true;
  const Pattern& pattern = patterns_[next];
  const QuadPattern bound = Bind(pattern, row_);
  if (!bound.subject.IsNone() && !bound.predicate.IsNone() && !bound.object.IsNone()) {
    return !run.options.version->ContainsMatch(bound) || Join(run, open & ~(1u << next));
  }
  std::array<int16_t, 3> fresh;  // columns that this pattern binds
  int fresh_count = 0;
  const std::array<TermId, 3> given = {bound.subject, bound.predicate, bound.object};
  for (int i = 0; i < 3; ++i) {
    if (!given[i].IsNone()) continue;
    if (std::find(fresh.begin(), fresh.begin() + fresh_count, pattern.columns[i]) ==
        fresh.begin() + fresh_count) {
      fresh[fresh_count++] = pattern.columns[i];
    }
  }
  bool go_on = true;
  for (QuadCursor c = run.options.version->Scan(bound); go_on && c.Valid(); c.NextTriple()) {
    go_on = run.Step();
    for (int i = 0; i < fresh_count; ++i) row_[fresh[i]] = TermId();
    const std::array<TermId, 3> found = {c.term(0), c.term(1), c.term(2)};
    bool fits = true;
    for (int i = 0; fits && i < 3; ++i) {
      if (!given[i].IsNone()) continue;
      TermId& value = row_[pattern.columns[i]];
      if (value.IsNone()) value = found[i];
      fits = value == found[i];  // ?x ex:knows ?x
    }
    for (int i = 0; fits && i < fresh_count; ++i) fits = TestBound(fresh[i]);
    if (fits && go_on) go_on = Join(run, open & ~(1u << next));
  }
  for (int i = 0; i < fresh_count; ++i) row_[fresh[i]] = TermId();
  return go_on;
}

absl::Status Body::FlatPlan::EvaluateRest(const sparql::RunOptions& run, absl::Span<const TermId> seed,
                                          uint32_t matched, Filters filters, Visitor visit) {
  row_.assign(seed.begin(), seed.end());
  Run state{run, visit, filters, absl::OkStatus()};
  if (!filters_.empty()) {
    for (size_t i = 0; i < row_.size(); ++i) {
      if (!row_[i].IsNone() && !TestBound(static_cast<int16_t>(i))) return absl::OkStatus();
    }
  }
  if (filters_.empty() || filters == Filters::kNone || TestSeeded(state)) {
    Join(state, static_cast<uint32_t>((uint64_t{1} << patterns_.size()) - 1) & ~matched);
  }
  state.Poll(false);
  return state.status;
}

absl::StatusOr<std::unique_ptr<Body::GeneralPlan>> Body::GeneralPlan::Make(
    sparql::Query query, Dictionary& dictionary, const sparql::FunctionRegistry* functions,
    const std::vector<Column>& columns) {
  std::unique_ptr<GeneralPlan> plan(new GeneralPlan(std::move(query), dictionary, functions, columns));
  const std::vector<TermId> nothing(columns.size());
  if (auto variant = plan->VariantFor(nothing); !variant.ok()) return variant.status();
  return plan;
}

absl::StatusOr<Body::GeneralPlan::Variant*> Body::GeneralPlan::VariantFor(absl::Span<const TermId> seed) {
  std::vector<int16_t> bound;
  for (size_t i = 0; i < seed.size(); ++i) {
    if (!seed[i].IsNone()) bound.push_back(static_cast<int16_t>(i));
  }
  for (Variant& variant : variants_) {
    if (variant.bound == bound) return &variant;
  }
  sparql::PrepareOptions options;
  options.functions = functions_;
  for (const int16_t column : bound) options.bound.push_back(columns_[column].name);
  auto prepared = sparql::PreparedQuery::Prepare(query_, dictionary_, options);
  if (!prepared.ok()) return prepared.status();
  Variant variant{std::move(bound), {}, *std::move(prepared)};
  for (const std::string& name : variant.query->variables()) {
    const auto found =
        std::find_if(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == name; });
    variant.columns.push_back(found == columns_.end() ? int16_t{Trigger::kNoColumn}
                                                      : static_cast<int16_t>(found - columns_.begin()));
  }
  variants_.push_back(std::move(variant));
  return &variants_.back();
}

absl::Status Body::GeneralPlan::Evaluate(const sparql::RunOptions& run, absl::Span<const TermId> seed,
                                         Visitor visit) {
  absl::StatusOr<Variant*> variant = VariantFor(seed);
  if (!variant.ok()) return variant.status();
  sparql::PreparedQuery& query = *(*variant)->query;
  std::vector<TermId> bound;
  for (const int16_t column : (*variant)->bound) bound.push_back(seed[column]);
  if (absl::Status status = query.Start(run, bound); !status.ok()) return status;
  while (query.Next()) {
    row_.assign(seed.begin(), seed.end());
    const absl::Span<const TermId> found = query.row();
    for (size_t i = 0; i < found.size(); ++i) {
      const int16_t column = (*variant)->columns[i];
      if (column == Trigger::kNoColumn || found[i].IsNone()) continue;
      const bool computed = found[i].tag() == TermId::Tag::kLocal;
      row_[column] = computed ? dictionary_.Intern(query.Decode(found[i])) : found[i];
    }
    if (visit(row_)) continue;
    query.Stop();
    return absl::OkStatus();
  }
  query.Stop();
  return query.status();
}

}  // namespace docent::matching
