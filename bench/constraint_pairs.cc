#include "bench/constraint_pairs.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "bench/measurement.h"
#include "bench/worlds/constraint_graph.h"

namespace docent::bench {
namespace {

using Clock = std::chrono::steady_clock;

// Microseconds an update. `flips`: constraints that each changes.
double Measure(const std::vector<Quad>& facts, size_t flips, ConstraintGraph& graph,
               conditions::StandingConditions& set) {
  const Clock::time_point start = Clock::now();
  for (const Quad& fact : facts) {
    for (const bool add : {true, false}) {
      const Delta delta = graph.Apply(add, fact);
      const auto changes = set.Update(graph.version(), delta);
      if (!changes.ok() || changes->size() != flips) {
        std::fprintf(stderr, "an update changes %zu constraints, not %zu\n",
                     changes.ok() ? changes->size() : 0, flips);
        std::exit(1);
      }
      set.Commit();
      graph.Freeze();
    }
  }
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count() /
         (2.0 * static_cast<double>(facts.size()));
}

}  // namespace

std::array<double, kConstraintShapes> MeasurePairs(size_t constraints, uint32_t seed) {
  ConstraintGraph graph(constraints);
  conditions::StandingConditions set(graph.dictionary());
  RegisterAll(ParseConstraints(constraints), graph, set);
  std::mt19937_64 random(seed);
  uint64_t serial = 0;
  const Term other = Term::Iri(absl::StrCat(kConstraintNs, "other"));
  std::array<double, kConstraintShapes> net = {};
  for (const ConstraintShape shape :
       {ConstraintShape::kJoin, ConstraintShape::kNegated, ConstraintShape::kFree}) {
    const auto draw = [&](bool looked_at) {
      std::vector<Quad> facts;
      for (int i = 0; i < kPairsInBlock; ++i) {
        const size_t n = random() % ConstraintsOfShape(shape, constraints);
        TermQuad fact = FactThatFlips(shape, n, random(), ++serial);
        if (!looked_at) fact.predicate = other;
        facts.push_back(graph.Encode(fact));
      }
      return facts;
    };
    // Each block has its own data, so that the cache holds nothing of another block.
    struct Block {
      std::vector<Quad> base, looked_at;
    };
    std::vector<Block> blocks(1 + kPairBlocks);
    for (Block& block : blocks) block = {draw(false), draw(true)};
    std::vector<double> differences;
    for (const Block& block : blocks) {
      const double base = Measure(block.base, 0, graph, set);
      differences.push_back(Measure(block.looked_at, 1, graph, set) - base);
    }
    differences.erase(differences.begin());
    net[static_cast<size_t>(shape)] = Median(differences);
  }
  return net;
}

}  // namespace docent::bench
