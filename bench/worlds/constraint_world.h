// Workload of `docent-bench constraints` and `notify`: conditions of a hard mix, a graph for them, and
// updates of one fact of which each makes exactly one of them begin or cease to hold.
//
//   a third   ?s :reading ?value . FILTER(?value > N)              one predicate; they differ only in the number
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
// Of constraint `i`, whatever their count.
StandingConstraint StandingConstraintNumber(size_t i);

// What stands in the graph before the first update, for `count` constraints.
std::vector<TermQuad> ConstraintBackground(size_t count);

// A fact that makes constraint `n` of its shape begin to hold if it is told, or cease to (negated). `draw` chooses among the
// visitors of a room; no two of the same `serial` but for it.
TermQuad FactThatFlips(ConstraintShape shape, size_t n, uint64_t draw, uint64_t serial);
// How many of `count` constraints have the shape.
size_t ConstraintsOfShape(ConstraintShape shape, size_t count);

// Says one update after the other.
class ConditionUpdates {
 public:
  ConditionUpdates(size_t count, uint32_t seed);

  struct Update {
    ConstraintShape shape;
    bool add;  // or retract
    TermQuad fact;
    size_t constraint;  // which flips
  };
  Update Next();
  // From now on a batch: the updates until the next call flip different constraints, so that each of them is seen when
  // all are applied at once.
  void NewBatch();

 private:
  struct Told {
    size_t n;  // of its shape
    TermQuad fact;
  };
  size_t CountOf(ConstraintShape shape) const { return ConstraintsOfShape(shape, count_); }
  bool IsUsed(ConstraintShape shape, size_t n) const;
  // nullopt: what it could be flips a constraint that the batch flips already.
  std::optional<Update> Tell(ConstraintShape shape);
  std::optional<Update> Retract(ConstraintShape shape);

  const size_t count_;
  std::mt19937_64 random_;
  uint64_t serial_ = 0;  // no two facts are the same
  size_t level_;         // the highest threshold below a reading
  std::vector<std::vector<Told>> told_;
  bool batches_ = false;
  std::vector<size_t> used_;  // constraints that the batch flips
};

}  // namespace docent::bench

#endif  // DOCENT_BENCH_WORLDS_CONSTRAINT_WORLD_H_
