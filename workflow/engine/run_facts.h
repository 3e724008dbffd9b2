// A run as facts of the graph docent:runs (ontology/run.ttl), so that SPARQL, rules and other workflows'
// conditions see which run waits for what and why a step fired.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_FACTS_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_FACTS_H_

#include <vector>

#include "graph/store/quad.h"
#include "workflow/engine/state/ports.h"
#include "workflow/engine/state/run_state.h"
#include "workflow/engine/state/run_terms.h"

namespace docent::engine {

// All facts of a run (urn:docent:run:ID and, beneath it, /NODE, /NODE/N for invocations from 0, /$VARIABLE and /=RESULT), sorted, none twice. New terms are interned: writer thread only.
// `conditions` (null: none) knows when those with ext:for may hold.
std::vector<Quad> RunFacts(const Run& run, RunTerms* terms, const ConditionView* conditions = nullptr);

// What to add and what to remove to come from `before` to `after`, both sorted.
void DiffFacts(const std::vector<Quad>& before, const std::vector<Quad>& after, std::vector<Quad>* add,
               std::vector<Quad>* remove);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_FACTS_H_
