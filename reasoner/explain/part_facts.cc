#include "reasoner/explain/part_facts.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "graph/base/cancellation.h"
#include "graph/rdf/vocabulary.h"

namespace docent::explain {
namespace {

using sparql::Algebra;
using sparql::Path;

constexpr size_t kFactsShown = 10;        // of one part
constexpr size_t kSolutions = 1000;       // of a group that are visited
constexpr size_t kPlaces = 100000;        // of a path that are visited
constexpr size_t kPlacesOfStep = 16;      // cost about as much as one match
constexpr uint64_t kInferredCost = 1000;  // of a step over an inferred fact; an asserted one costs 1
constexpr int kDeepest = 3;               // nesting of parts

// A path as a nondeterministic finite automaton (Thompson's construction), whose words are chains of facts.
class Automaton {
 public:
  struct Edge {
    int to;
    bool empty = false;    // an edge without a fact
    bool inverse = false;  // from object to subject
    bool negated = false;  // any predicate except these
    std::vector<TermId> predicates;
  };
  Automaton(const Path& path, const Dictionary& dictionary) : dictionary_(dictionary) {
    edges_.resize(2);
    Add(path, false, 0, 1);
  }
  static constexpr int kStart = 0, kEnd = 1;
  const std::vector<Edge>& From(int state) const { return edges_[static_cast<size_t>(state)]; }

 private:
  int State() {
    edges_.emplace_back();
    return static_cast<int>(edges_.size()) - 1;
  }
  void Connect(int from, Edge edge) { edges_[static_cast<size_t>(from)].push_back(std::move(edge)); }
  TermId IdOf(const Term& iri) const { return dictionary_.Find(iri).value_or(TermId()); }

  void Add(const Path& path, bool inverse, int from, int to) {
    switch (path.kind) {
      case Path::Kind::kIri:
        return Connect(from, {to, false, inverse, false, {IdOf(path.iri)}});
      case Path::Kind::kInverse:
        return Add(path.children[0], !inverse, from, to);
      case Path::Kind::kSequence: {
        int at = from;
        for (size_t i = 0; i < path.children.size(); ++i) {
          const size_t step = inverse ? path.children.size() - 1 - i : i;
          const int next = i + 1 == path.children.size() ? to : State();
          Add(path.children[step], inverse, at, next);
          at = next;
        }
        return;
      }
      case Path::Kind::kAlternative:
        for (const Path& child : path.children) Add(child, inverse, from, to);
        return;
      case Path::Kind::kZeroOrOne:
        Connect(from, {to, true});
        return Add(path.children[0], inverse, from, to);
      case Path::Kind::kZeroOrMore:
      case Path::Kind::kOneOrMore: {
        const int loop = State();
        if (path.kind == Path::Kind::kZeroOrMore) {
          Connect(from, {loop, true});
        } else {
          Add(path.children[0], inverse, from, loop);
        }
        Add(path.children[0], inverse, loop, loop);
        return Connect(loop, {to, true});
      }
      case Path::Kind::kNegatedSet: {
        Edge forward{to, false, inverse, true, {}}, backward{to, false, !inverse, true, {}};
        bool any_backward = false;
        for (const Path& child : path.children) {
          const bool back = child.kind == Path::Kind::kInverse;
          (back ? backward : forward).predicates.push_back(IdOf(back ? child.children[0].iri : child.iri));
          any_backward = any_backward || back;
        }
        const bool any_forward = !any_backward || forward.predicates.size() > 0;
        if (any_forward) Connect(from, std::move(forward));
        if (any_backward) Connect(from, std::move(backward));
        return;
      }
    }
  }

  const Dictionary& dictionary_;
  std::vector<std::vector<Edge>> edges_;
};

}  // namespace

// Dijkstra over (state, term). `to` kNone: any end.
std::optional<std::vector<Quad>> PartFacts::Chain(const Path& path, TermId graph, TermId from, TermId to) {
  const Automaton automaton(path, dictionary_);
  const TermId inferred = dictionary_.FindIri(kInferredGraph).value_or(TermId());
  using Place = std::pair<int, TermId>;
  struct Reached {
    uint64_t cost;
    Place before;
    Quad by;  // kNone: without a fact
  };
  absl::flat_hash_map<Place, Reached> reached;
  using Entry = std::tuple<uint64_t, int, TermId>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto reach = [&](const Place& place, uint64_t cost, const Place& before, const Quad& by) {
    const auto [known, is_new] = reached.try_emplace(place, Reached{cost, before, by});
    if (!is_new && known->second.cost <= cost) return;
    known->second = {cost, before, by};
    open.emplace(cost, place.first, place.second);
  };
  const Place start{Automaton::kStart, from};
  reach(start, 0, start, Quad());
  for (size_t places = 1; !open.empty() && reached.size() <= kPlaces && steps_ < step_limit_; ++places) {
    if (places % kPlacesOfStep == 0) ++steps_;
    if (places % 256 == 0 && run_.cancellation != nullptr && !run_.cancellation->Check().ok()) break;
    const auto [cost, state, term] = open.top();
    open.pop();
    const Place place{state, term};
    if (reached.at(place).cost < cost) continue;
    if (state == Automaton::kEnd && (to.IsNone() || term == to)) {
      std::vector<Quad> chain;
      for (Place at = place; at != start; at = reached.at(at).before) {
        if (!reached.at(at).by.predicate.IsNone()) chain.push_back(reached.at(at).by);
      }
      std::reverse(chain.begin(), chain.end());
      return chain;
    }
    for (const Automaton::Edge& edge : automaton.From(state)) {
      if (edge.empty) {
        reach({edge.to, term}, cost, place, Quad());
        continue;
      }
      QuadPattern pattern;
      pattern.graph = graph;
      (edge.inverse ? pattern.object : pattern.subject) = term;
      if (!edge.negated) pattern.predicate = edge.predicates[0];
      if (!edge.negated && pattern.predicate.IsNone()) continue;  // no fact has this predicate
      version_.ForEach(pattern, [&](const Quad& quad) {
        const auto& not_these = edge.predicates;
        if (edge.negated && std::find(not_these.begin(), not_these.end(), quad.predicate) != not_these.end())
          return true;
        reach({edge.to, edge.inverse ? quad.subject : quad.object},
              cost + (quad.graph == inferred ? kInferredCost : 1), place,
              {quad.subject, quad.predicate, quad.object, graph});
        return true;
      });
    }
  }
  return std::nullopt;
}

TermId PartFacts::IdOf(const sparql::PatternTerm& term, const ByName& values) const {
  if (!term.IsVariable()) return dictionary_.Find(term.term()).value_or(TermId());
  const auto value = values.find(term.variable().name);
  return value == values.end() ? TermId() : value->second;
}

Ground PartFacts::OfPath(const Algebra& node, TermId graph, const ByName& values) {
  const TermId from = IdOf(node.subject, values), to = IdOf(node.object, values);
  std::optional<std::vector<Quad>> chain;
  if (!from.IsNone()) {
    chain = Chain(node.path, graph, from, to);
  } else if (!to.IsNone()) {
    Path back;
    back.kind = Path::Kind::kInverse;
    back.children.push_back(node.path);
    chain = Chain(back, graph, to, from);
  }
  if (!chain) return {};
  return {*std::move(chain), 0, !from.IsNone() && !to.IsNone()};
}

absl::Status PartFacts::AddSolutions(const Algebra& node, TermId graph, const ByName& values,
                                     size_t solutions, Ground& ground) {
  auto clauses = ToClauses(node, dictionary_, graph);
  if (!clauses.ok()) return clauses.status();
  Solver solver(version_, dictionary_, functions_, run_, step_limit_ - std::min(step_limit_, steps_));
  size_t charged = 0;
  absl::flat_hash_set<Quad> known(ground.facts.begin(), ground.facts.end());
  const auto add = [&](const Quad& fact) {
    if (!known.insert(fact).second) return;
    if (ground.facts.size() < kFactsShown) {
      ground.facts.push_back(fact);
    } else {
      ++ground.more;
    }
  };
  for (const Clause& clause : *clauses) {
    std::vector<TermId> seed(clause.names.size());
    for (size_t v = 0; v < seed.size(); ++v) {
      const auto value = values.find(clause.names[v]);
      if (value != values.end()) seed[v] = value->second;
    }
    std::vector<Row> with_parts;
    absl::Status status = solver.Solve(clause, seed, {}, [&](const Solution& solution) {
      for (const Quad& quad : solution.facts) add(quad);
      if (!clause.parts.empty() && with_parts.size() < kFactsShown) with_parts.push_back(solution.row);
      return --solutions > 0;
    });
    steps_ += solver.steps() - std::exchange(charged, solver.steps());
    if (!status.ok()) return status;
    for (const Row& row : with_parts) {
      for (const Part& part : clause.parts) {
        auto inner = Of(part, row);
        if (!inner.ok()) return inner.status();
        for (const Quad& quad : inner->facts) add(quad);
        ground.more += inner->more;
      }
    }
    if (solutions == 0) break;
  }
  return absl::OkStatus();
}

absl::StatusOr<Ground> PartFacts::Of(const Part& part, const Row& row) {
  if (depth_ >= kDeepest) return Ground();
  ByName values;
  const std::vector<sparql::Variable> scope = sparql::InScopeVariables(*part.pattern);
  for (size_t i = 0; i < scope.size(); ++i) {
    const TermId value = row.values[static_cast<size_t>(part.variables[i])];
    if (!value.IsNone()) values.emplace(scope[i].name, value);
  }
  const TermId graph =
      part.graph.variable < 0 ? part.graph.constant : row.values[static_cast<size_t>(part.graph.variable)];
  if (part.graph.variable >= 0 && graph.IsNone()) return Ground();
  const Algebra* node = part.pattern.get();
  if (node->kind == Algebra::Kind::kPath) return OfPath(*node, graph, values);
  while (node->kind == Algebra::Kind::kSlice || node->kind == Algebra::Kind::kProject ||
         node->kind == Algebra::Kind::kExtend || node->kind == Algebra::Kind::kFilter ||
         node->kind == Algebra::Kind::kOrderBy || node->kind == Algebra::Kind::kDistinct ||
         node->kind == Algebra::Kind::kReduced)
    node = node->children[0].get();
  Ground ground;
  ++depth_;
  absl::Status status;
  if (node->kind == Algebra::Kind::kGroup) {
    ByName keys;
    bool plain = true;  // with a computed key the group's facts are not known
    for (const sparql::GroupKey& key : node->group_keys) {
      plain = plain && key.expression->kind == sparql::Expression::Kind::kVariable;
      if (const auto value = values.find(key.variable.name); value != values.end()) keys.insert(*value);
    }
    if (plain) status = AddSolutions(*node->children[0], graph, keys, kSolutions, ground);
  } else if (node->kind == Algebra::Kind::kLeftJoin) {
    for (size_t i = 0; i < 2 && status.ok(); ++i)
      status = AddSolutions(*node->children[i], graph, values, 1, ground);
  } else if (node->kind != Algebra::Kind::kService) {
    status = AddSolutions(*node, graph, values, 1, ground);
  }
  --depth_;
  if (!status.ok()) return status;
  return ground;
}

}  // namespace docent::explain
