// The constraint stage alone, in process, beside two baselines on the same evaluator, graph, constraints and updates:
// "re-run every ASK after each update" and "re-run those whose predicates occur in the update".
#ifndef DOCENT_BENCH_CONSTRAINT_STAGE_H_
#define DOCENT_BENCH_CONSTRAINT_STAGE_H_

#include <cstddef>
#include <vector>

#include "bench/measurement.h"

namespace docent::bench {

// Adds µs per update of the three systems and the two ratios. All three must see the same constraints rise and
// fall; false (and a line on stderr) where they do not.
bool MeasureConstraintStage(size_t triples, size_t constraints, std::vector<Measurement>* figures);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_CONSTRAINT_STAGE_H_
