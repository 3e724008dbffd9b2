// Workload of `docent-bench reaction`: workflow conditions of mixed kinds, a background graph, and updates;
// each update makes exactly one condition begin to hold, with a new binding.
//
//   a third      ?s ex:temperature ?t . FILTER(?t > …)          one predicate, other sensor and threshold
//   a third      ?v docent:isAt REGION . ?v ex:likes TOPIC      a join through the visitor
//   a sixth      ?v docent:isAt ROOM . FILTER NOT EXISTS { ?v ex:badge ?b }
//   a sixth      ?v ex:carries ?item . ?item ex:ownedBy OWNER   free variables on both sides
//
// Deterministic: the same numbers give the same text. Pure functions.
#ifndef DOCENT_BENCH_WORLDS_WORKFLOW_MIX_H_
#define DOCENT_BENCH_WORLDS_WORKFLOW_MIX_H_

#include <cstdint>
#include <string>
#include <vector>

#include "graph/rdf/term.h"

namespace docent::bench {

// The condition of workflow `i`: one <rule> element of CAWL.
std::string CawlRuleNumber(size_t i);
// The variable of condition `i` that gets the token as its value.
std::string TokenVariable(size_t i);

// About `triples` triples: visitors with topics and names, sensors, items with owners.
std::vector<TermQuad> Background(size_t triples, size_t conditions);

// Update k. `token` is a term that only this update has, and that a solution of the condition binds.
struct MixedUpdate {
  TermQuad add;  // docent:isAt and ex:temperature are state properties
  std::string token;
};
MixedUpdate UpdateNumber(uint64_t k, size_t conditions, size_t background_triples);

// The declarations of the state properties.
std::vector<TermQuad> StateProperties();

}  // namespace docent::bench

#endif  // DOCENT_BENCH_WORLDS_WORKFLOW_MIX_H_
