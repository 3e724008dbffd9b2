// Workload of `docent-bench constraints` and `notify`: conditions of a hard mix, a graph for them, and
// updates of one fact; each update makes exactly one condition begin or cease to hold.
//
//   a third   ?s :reading ?value . FILTER(?value > N)              one predicate; other numbers
//   a third   ?v :at ROOM . ?v :wants TOPIC                        a join through the visitor, in rooms of 64
//   a sixth   PERSON :at ?r . FILTER NOT EXISTS { PERSON :badge ?b }
//   a sixth   ?v :carries ?item . ?item :ownedBy OWNER             the bindings of ?v are followed
//
// Deterministic for the same numbers. One thread.
#ifndef DOCENT_BENCH_WORLDS_CONSTRAINT_WORLD_H_
#define DOCENT_BENCH_WORLDS_CONSTRAINT_WORLD_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "graph/rdf/term.h"

namespace docent::bench {

inline constexpr char kConstraintNs[] = "urn:c:";

enum class ConstraintShape { kThreshold, kJoin, kNegated, kFree };
inline constexpr int kConstraintShapes = 4;
const char* NameOf(ConstraintShape shape);

struct StandingConstraint {
  ConstraintShape shape;
  std::string ask;                // SPARQL, in the namespace above
  std::vector<std::string> keys;  // key variables
};
// Constraint `i`; does not depend on the number of constraints.
StandingConstraint StandingConstraintNumber(size_t i);

// The graph before the first update, for `count` constraints.
std::vector<TermQuad> ConstraintBackground(size_t count);

// A fact that makes constraint `n` of its shape begin to hold when asserted (negated shape: cease to hold).
// `draw` chooses among the visitors of a room; facts with different `serial` differ.
TermQuad FactThatFlips(ConstraintShape shape, size_t n, uint64_t draw, uint64_t serial);
// Number of constraints of this shape among `count`.
size_t ConstraintsOfShape(ConstraintShape shape, size_t count);

// Generator of updates.
class ConditionUpdates {
 public:
  ConditionUpdates(size_t count, uint32_t seed);

  struct Update {
    ConstraintShape shape;
    bool add;  // or retract
    TermQuad fact;
    size_t constraint;  // the constraint that flips
  };
  Update Next();
  // Starts a batch: the updates until the next call flip different constraints, so that all flips are visible
  // when they are applied together.
  void NewBatch();

 private:
  struct Told {
    size_t n;  // number within its shape
    TermQuad fact;
  };
  size_t CountOf(ConstraintShape shape) const { return ConstraintsOfShape(shape, count_); }
  bool IsUsed(ConstraintShape shape, size_t n) const;
  // nullopt: the possible updates flip a constraint that the batch already flips.
  std::optional<Update> Tell(ConstraintShape shape);
  std::optional<Update> Retract(ConstraintShape shape);

  const size_t count_;
  std::mt19937_64 random_;
  uint64_t serial_ = 0;  // makes all facts different
  size_t level_;         // the highest threshold below a reading
  std::vector<std::vector<Told>> told_;
  bool batches_ = false;
  std::vector<size_t> used_;  // constraints flipped in the batch
};

}  // namespace docent::bench

#endif  // DOCENT_BENCH_WORLDS_CONSTRAINT_WORLD_H_
