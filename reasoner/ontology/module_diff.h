// Difference between two versions of an ontology module; blank nodes are compared by their triples. Pure
// functions; any thread.
#ifndef DOCENT_REASONER_ONTOLOGY_MODULE_DIFF_H_
#define DOCENT_REASONER_ONTOLOGY_MODULE_DIFF_H_

#include <string>
#include <utility>
#include <vector>

#include "graph/rdf/term.h"

namespace docent::ontology {

struct ModuleDiff {
  std::vector<TermQuad> removed;  // in `before` alone, sorted; without graphs
  std::vector<TermQuad> added;    // in `after` alone
  bool empty() const { return removed.empty() && added.empty(); }
};

// A blank node is the same in both if the triples around it are, to a depth of 16 blank nodes
// (colour refinement). Two that cannot be told apart so count as one. Graphs are left aside.
ModuleDiff DiffModules(const std::vector<TermQuad>& before, const std::vector<TermQuad>& after);

// What a module says of itself: its owl:Ontology, with owl:versionIRI and owl:versionInfo; empty where it says nothing.
struct ModuleVersion {
  std::string ontology, version_iri, version_info;
};
ModuleVersion VersionOf(const std::vector<TermQuad>& quads);

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_MODULE_DIFF_H_
