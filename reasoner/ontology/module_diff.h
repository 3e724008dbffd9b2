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
  std::vector<TermQuad> removed;  // only in `before`, sorted; without graphs
  std::vector<TermQuad> added;    // only in `after`
  bool empty() const { return removed.empty() && added.empty(); }
};

// A blank node is the same in both if the triples around it are, to a depth of 16 blank nodes (colour
// refinement). Blank nodes that this cannot distinguish count as one. Graphs are ignored.
ModuleDiff DiffModules(const std::vector<TermQuad>& before, const std::vector<TermQuad>& after);

// A module's own version data: its owl:Ontology, with owl:versionIRI and owl:versionInfo; empty if not given.
struct ModuleVersion {
  std::string ontology, version_iri, version_info;
};
ModuleVersion VersionOf(const std::vector<TermQuad>& quads);

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_MODULE_DIFF_H_
