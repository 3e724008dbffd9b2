#include "graph/sparql/plan/join_order.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <memory>
#include <queue>
#include <tuple>
#include <utility>

#include "absl/container/flat_hash_map.h"

namespace docent::sparql {
namespace {

// Costs in microseconds, measured on 2026-11-21: one index lookup, one triple put into a hash table, one
// lookup in that table, one row passed on; a filter that compares, a filter that calls a function; one step
// of the dynamic programme (by its instructions), and one pattern's sample.
constexpr double kLookup = 0.15, kHashed = 0.08, kHashLookup = 0.03, kRow = 0.015;
constexpr double kComparison = 0.05, kCall = 0.25;
constexpr double kStep = 0.01, kSample = 3;
// Samples and search pay if the first guess costs this many times as much as they do. Patterns that begin
// with bound variables are matched many times, so a smaller factor holds for them.
constexpr double kSearchWorth = 10, kSearchWorthBound = 4;

// Estimated number of values of a variable among n matches, as a power of n: a subject has few values of one
// property, an object is shared by more subjects, predicates and graphs are few.
constexpr double kValuePowers[] = {0.85, 0.4, 0.6, 0.3};
constexpr size_t kSampled = 6;

// Estimated share of rows that pass a filter (System R's figures).
double Selectivity(const PlanExpression& e) {
  switch (e.kind) {
    case Expression::Kind::kEqual:
      return 0.1;
    case Expression::Kind::kLess:
    case Expression::Kind::kGreater:
    case Expression::Kind::kLessOrEqual:
    case Expression::Kind::kGreaterOrEqual:
      return 0.33;
    case Expression::Kind::kNotEqual:
    case Expression::Kind::kNot:
      return 0.9;
    default:
      return 0.5;
  }
}

bool HasCall(const PlanExpression& e) {
  return e.kind == Expression::Kind::kBuiltin || e.kind == Expression::Kind::kFunction ||
         std::any_of(e.arguments.begin(), e.arguments.end(),
                     [](const PlanExpressionPtr& a) { return HasCall(*a); });
}

}  // namespace

JoinOrder::JoinOrder(PlanNode& bgp, const SlotSet& bound, EvaluationContext& context)
    : bgp_(bgp), bound_(bound), context_(context), patterns_(bgp.patterns.size()) {
  for (size_t i = 0; i < patterns_.size() && context.Poll(); ++i) Count(bgp.patterns[i], &patterns_[i]);
  for (size_t v = 0; v < slots_.size() && v < kMaxVariables; ++v) {
    if (bound.Contains(slots_[v])) initial_ |= uint64_t{1} << v;
  }
  shared_ |= initial_;
  for (size_t p = 0; p < patterns_.size(); ++p) {
    Pattern& pattern = patterns_[p];
    const double n = std::max(pattern.matches, 1.0);
    const bool distinct = n <= 2 || pattern.one_open;
    for (int i = 0; i < pattern.used; ++i) {
      Use& use = pattern.uses[i];
      if ((shared_ >> use.variable & 1) != 0)
        use.values = distinct ? n : std::pow(n, kValuePowers[use.position]);
    }
  }
  for (size_t f = 0; f < bgp.filters.size(); ++f) {
    Filter filter{0, Selectivity(*bgp.filters[f]), HasCall(*bgp.filters[f]) ? kCall : kComparison};
    for (size_t v = 0; v < slots_.size() && v < kMaxVariables; ++v) {
      if (bgp.filter_slots[f].Contains(slots_[v])) filter.variables |= uint64_t{1} << v;
    }
    filters_.push_back(filter);
  }
}

int JoinOrder::VariableOf(int slot) {
  const auto number = std::find(slots_.begin(), slots_.end(), slot) - slots_.begin();
  if (number == std::ssize(slots_) && slots_.size() < kMaxVariables) slots_.push_back(slot);
  return static_cast<int>(number);
}

QuadPattern JoinOrder::Constants(const PlanPattern& pattern) const {
  const auto id = [this](const PlanTerm& term) {
    return term.constant < 0 ? TermId() : context_.constants[term.constant];
  };
  return {id(pattern.terms[0]), id(pattern.terms[1]), id(pattern.terms[2]), id(pattern.graph.name)};
}

void JoinOrder::Count(PlanPattern& pattern, Pattern* out) {
  if (pattern.matches < 0) {
    const QuadPattern quad = Constants(pattern);
    pattern.matches = 0;
    const bool known = quad.subject.tag() != TermId::Tag::kLocal &&
                       quad.predicate.tag() != TermId::Tag::kLocal &&
                       quad.object.tag() != TermId::Tag::kLocal && quad.graph.tag() != TermId::Tag::kLocal;
    if (known) pattern.matches = static_cast<double>(context_.version->Count(quad));
  }
  out->matches = pattern.matches;
  out->one_open =
      (pattern.terms[0].slot >= 0) + (pattern.terms[1].slot >= 0) + (pattern.terms[2].slot >= 0) == 1 &&
      pattern.graph.name.slot < 0;
  const PlanTerm* terms[] = {&pattern.terms[0], &pattern.terms[1], &pattern.terms[2], &pattern.graph.name};
  for (int i = 0; i < 4; ++i) {
    if (terms[i]->slot < 0) continue;
    const int variable = VariableOf(terms[i]->slot);
    if (variable >= static_cast<int>(kMaxVariables)) continue;  // a huge pattern: ordered by matches alone
    const uint64_t bit = uint64_t{1} << variable;
    out->uses[static_cast<size_t>(out->used++)] = {variable, i, 1};
    out->variables |= bit;
    shared_ |= variables_ & bit;
    variables_ |= bit;
  }
}

// Estimates the number of subject and object values from a few sampled matches: a match whose value has c
// matches counts as 1/c of a value.
void JoinOrder::Refine(const PlanPattern& pattern, Pattern* out) const {
  if (out->matches < 8 || out->one_open || pattern.terms[1].constant < 0) return;
  const QuadPattern quad = Constants(pattern);
  std::vector<Quad> sample;
  for (int i = 0; i < out->used; ++i) {
    Use& use = out->uses[i];
    if ((shared_ >> use.variable & 1) == 0) continue;
    const bool subject = pattern.terms[0].slot == slots_[use.variable];
    const bool object = pattern.terms[2].slot == slots_[use.variable];
    if (subject == object) continue;
    if (sample.empty()) sample = context_.version->Sample(quad, kSampled);
    if (sample.empty()) return;
    double inverse = 0, sum = 0;
    for (const Quad& q : sample) {
      QuadPattern one = quad;
      (subject ? one.subject : one.object) = subject ? q.subject : q.object;
      const double count = std::max(1.0, static_cast<double>(context_.version->Count(one)));
      inverse += 1 / count;
      sum += count;
    }
    const double n = static_cast<double>(sample.size());
    // The geometric mean of the mean over values and the mean over matches: rows from other patterns meet
    // popular values more often.
    use.values = std::max(1.0, out->matches / std::sqrt(n / inverse * (sum / n)));
  }
}

void JoinOrder::Begin(State* state) const {
  state->cost = 0;
  state->rows = 1;
  state->bound = initial_;
  std::fill_n(state->values.begin(), std::min(slots_.size(), kMaxVariables), 1.0F);
}

JoinOrder::Step JoinOrder::Estimate(const State& state, const Pattern& pattern) const {
  double rows = state.rows * pattern.matches;
  uint64_t bound = state.bound;
  for (const Use* use = pattern.begin(); use != pattern.end(); ++use) {
    const uint64_t bit = uint64_t{1} << use->variable;
    if ((bound & bit) != 0) {  // before, or by this very pattern
      double values =
          (state.bound & bit) != 0 ? state.values[static_cast<size_t>(use->variable)] : state.rows;
      for (const Use* other = pattern.begin(); other != use; ++other) {
        if (other->variable == use->variable) values = std::min(values, other->values);
      }
      rows /= std::max(std::max(std::min(values, state.rows), use->values), 1.0);
    }
    bound |= bit;
  }
  double cost = state.cost +
                std::min(state.rows * kLookup, pattern.matches * kHashed + state.rows * kHashLookup) +
                rows * kRow;
  for (const Filter& filter : filters_) {
    const bool before = (filter.variables & ~state.bound) == 0 && state.bound != initial_;
    if (before || (filter.variables & ~bound) != 0) continue;
    cost += rows * filter.cost;
    rows *= filter.selectivity;
  }
  return {cost, std::max(rows, 1e-3)};
}

void JoinOrder::Extend(const Pattern& pattern, const Step& step, State* state) const {
  for (const Use& use : pattern) {
    float& values = state->values[static_cast<size_t>(use.variable)];
    const uint64_t bit = uint64_t{1} << use.variable;
    const auto own = static_cast<float>(use.values);
    values = (state->bound & bit) == 0 ? own : std::min(values, own);
    state->bound |= bit;
  }
  state->cost = step.cost;
  state->rows = step.rows;
}

JoinOrder::Order JoinOrder::Greedy(State* end) const {
  if (patterns_.size() > kMaxGreedy) {
    Order order = Connected();
    Follow(&order, end);
    return order;
  }
  Order order = AsWritten();
  Begin(end);
  for (auto next = order.begin(); next != order.end(); ++next) {  // the rest keeps its order
    auto best = next;
    Step best_step = Estimate(*end, patterns_[best->pattern]);
    for (auto i = next + 1; i != order.end(); ++i) {
      const Step step = Estimate(*end, patterns_[i->pattern]);
      if (step.rows > best_step.rows || (step.rows == best_step.rows && step.cost >= best_step.cost))
        continue;
      best = i;
      best_step = step;
    }
    const Place place = {best->pattern, best_step.rows};
    std::copy_backward(next, best, best + 1);
    *next = place;
    Extend(patterns_[place.pattern], best_step, end);
  }
  return order;
}

JoinOrder::Order JoinOrder::Connected() const {
  absl::flat_hash_map<int, std::vector<size_t>> users;  // slot → the patterns that it waits in
  const auto for_open = [&](size_t i, const auto& visit) {
    const PlanPattern& pattern = bgp_.patterns[i];
    for (const PlanTerm* term :
         {&pattern.terms[0], &pattern.terms[1], &pattern.terms[2], &pattern.graph.name}) {
      if (term->slot >= 0 && !bound_.Contains(term->slot)) visit(term->slot);
    }
  };
  // Apart, matches, number: the first of these is the next.
  using Candidate = std::tuple<bool, double, size_t>;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
  for (size_t i = 0; i < patterns_.size(); ++i) {
    candidates.emplace(true, patterns_[i].matches, i);
    for_open(i, [&](int slot) { users[slot].push_back(i); });
  }
  Order order;
  std::vector<bool> taken(patterns_.size());
  while (!candidates.empty()) {
    const size_t next = std::get<size_t>(candidates.top());
    candidates.pop();
    if (taken[next]) continue;
    taken[next] = true;
    order.push_back({next, 0});
    for_open(next, [&](int slot) {
      for (const size_t other : std::exchange(users[slot], {})) {
        if (!taken[other]) candidates.emplace(false, patterns_[other].matches, other);
      }
    });
  }
  return order;
}

JoinOrder::Order JoinOrder::AsWritten() const {
  Order order(patterns_.size());
  for (size_t i = 0; Place & place : order) place.pattern = i++;
  return order;
}

// Dynamic programming: the cheapest order of each set of patterns, from the cheapest orders of its subsets.
JoinOrder::Order JoinOrder::Programmed() const {
  constexpr uint8_t kNone = 0xFF;  // no order known
  const size_t n = patterns_.size(), all = (size_t{1} << n) - 1;
  const std::unique_ptr<State[]> states(new State[all + 1]);
  std::vector<uint8_t> last(all + 1, kNone);
  Begin(&states[0]);
  for (size_t set = 0; set < all; ++set) {
    if (set != 0 && last[set] == kNone) continue;
    const State& state = states[set];
    // A pattern without shared variables is taken only if there is no other: cartesian products come last.
    bool connected = false;
    for (size_t rest = set != 0 ? all & ~set : 0; rest != 0 && !connected; rest &= rest - 1) {
      connected = (patterns_[static_cast<size_t>(std::countr_zero(rest))].variables & state.bound) != 0;
    }
    for (size_t rest = all & ~set; rest != 0; rest &= rest - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(rest));
      const Pattern& pattern = patterns_[i];
      if (connected && (pattern.variables & state.bound) == 0 && pattern.matches > 1) continue;
      const size_t with = set | size_t{1} << i;
      const bool known = last[with] != kNone;
      if (known && states[with].cost <= state.cost) continue;  // the cost only grows
      const Step step = Estimate(state, pattern);
      if (known && states[with].cost <= step.cost) continue;
      states[with].bound = state.bound;
      std::copy_n(state.values.begin(), std::min(slots_.size(), kMaxVariables), states[with].values.begin());
      Extend(pattern, step, &states[with]);
      last[with] = static_cast<uint8_t>(i);
    }
  }
  Order order;
  for (size_t set = all; set != 0; set &= ~(size_t{1} << last[set])) order.push_back({last[set], 0});
  std::reverse(order.begin(), order.end());
  State end;
  Follow(&order, &end);
  return order;
}

void JoinOrder::Follow(Order* order, State* end) const {
  Begin(end);
  for (Place& place : *order) {
    if (!context_.Poll()) return;
    const Pattern& pattern = patterns_[place.pattern];
    const Step step = Estimate(*end, pattern);
    Extend(pattern, step, end);
    place.rows = step.rows;
  }
}

double JoinOrder::Rows() {
  State end;
  Greedy(&end);
  return end.rows;
}

double JoinOrder::Arrange(bool reorder) {
  const size_t n = patterns_.size();
  Order order;
  State end;
  if (reorder && n > 1) {
    order = Greedy(&end);
    const double steps = n <= kMaxProgrammed ? static_cast<double>(n << n) * kStep : 0;
    // Patterns for which samples improve the estimate.
    const auto unsure =
        std::count_if(patterns_.begin(), patterns_.end(), [](const Pattern& p) { return !p.one_open; });
    const double worth = initial_ == 0 ? kSearchWorth : kSearchWorthBound;
    if (end.cost > worth * (kSample * static_cast<double>(unsure) + steps)) {
      for (size_t i = 0; i < n && context_.Poll(); ++i) Refine(bgp_.patterns[i], &patterns_[i]);
      const bool programmed = n <= kMaxProgrammed && (n > 2 || !filters_.empty());  // of two: the rarer first
      if (programmed) {
        order = Programmed();
      } else if (unsure > 0) {
        order = Greedy(&end);
      }
    }
  } else {
    order = AsWritten();
    Follow(&order, &end);
  }
  if (!context_.status.ok()) return 1;
  const absl::InlinedVector<PlanPattern, 4> written(bgp_.patterns.begin(), bgp_.patterns.end());
  double rows = 1;
  for (size_t i = 0; i < n; ++i) {
    PlanPattern& pattern = bgp_.patterns[i];
    pattern = written[order[i].pattern];
    pattern.estimate = order[i].rows / rows;
    rows = order[i].rows;
  }
  return rows;
}

}  // namespace docent::sparql
