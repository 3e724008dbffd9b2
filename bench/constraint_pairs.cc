#include "bench/constraint_pairs.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "bench/constraint_graph.h"

namespace docent::bench {
namespace {

using Clock = std::chrono::steady_clock;

// Microseconds an update. `flips`: constraints that each changes.
double Measure(const std::vector<Quad>& facts, size_t flips, ConstraintGraph& graph, ConstraintSet& set) {
  Clock::time_point start;
  for (size_t pair = 0; pair < facts.size(); ++pair) {
    if (pair == kWarmUpPairs) start = Clock::now();
    for (const bool add : {true, false}) {
      const Delta delta = graph.Apply(add, facts[pair]);
      const auto changes = set.Update(graph.version(), delta);
      if (!changes.ok() || changes->size() != flips) {
        std::fprintf(stderr, "an update changes %zu constraints, not %zu\n", changes.ok() ? changes->size() : 0, flips);
        std::exit(1);
      }
      set.Commit();
      graph.Freeze();
    }
  }
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count() / (2.0 * kMeasuredPairs);
}

}  // namespace

std::array<double, kConstraintShapes> MeasurePairs(size_t constraints, uint32_t seed) {
  ConstraintGraph graph(constraints);
  ConstraintSet set(graph.dictionary());
  RegisterAll(ParseConstraints(constraints), graph, set);
  graph.Observe(&set);
  std::mt19937_64 random(seed);
  uint64_t serial = 0;
  const Term other = Term::Iri(absl::StrCat(kConstraintNs, "other"));
  std::array<double, kConstraintShapes> net = {};
  for (const ConstraintShape shape : {ConstraintShape::kJoin, ConstraintShape::kNegated, ConstraintShape::kFree}) {
    const auto facts = [&](bool looked_at) {
      std::vector<Quad> facts;
      for (int i = 0; i < kWarmUpPairs + kMeasuredPairs; ++i) {
        const size_t n = random() % ConstraintsOfShape(shape, constraints);
        TermQuad fact = FactThatFlips(shape, n, random(), ++serial);
        if (!looked_at) fact.predicate = other;
        facts.push_back(graph.Encode(fact));
      }
      return facts;
    };
    const double base = Measure(facts(false), 0, graph, set);
    net[static_cast<size_t>(shape)] = Measure(facts(true), 1, graph, set) - base;
  }
  return net;
}

}  // namespace docent::bench
