// A run as facts of the graph docent:runs (ontology/run.ttl), so that SPARQL, rules and other workflows'
// conditions see which run waits for what and why a step fired. Pure functions.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_FACTS_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_FACTS_H_

#include <string>
#include <vector>

#include "workflow/engine/run_state.h"

namespace docent {

// urn:docent:run:ID and, beneath it, /NODE and /NODE/N (N: invocation, from 0).
std::string RunIri(const RunId& run);

// All facts of a run, sorted (SortFacts).
std::vector<TermQuad> RunFacts(const Run& run);

// What to add and what to remove to come from `before` to `after`, both sorted.
void DiffFacts(const std::vector<TermQuad>& before, const std::vector<TermQuad>& after,
               std::vector<TermQuad>* add, std::vector<TermQuad>* remove);

}  // namespace docent

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_FACTS_H_
