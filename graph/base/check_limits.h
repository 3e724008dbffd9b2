// Limits for checking documents: shapes, ontologies, data. The rules of limits.h hold here. A separate
// header, because only the checks include it.
#ifndef DOCENT_GRAPH_BASE_CHECK_LIMITS_H_
#define DOCENT_GRAPH_BASE_CHECK_LIMITS_H_

#include <cstddef>

namespace docent {

struct CheckLimits {
  size_t check_diagnostics =
      1000;  // findings of `docent check` in one file, and about the shapes of one validation
  size_t validation_results = 10000;  // results kept of one SHACL report; the others are counted
  // Each triple counts with about 700 bytes and its text, its places included.
  size_t check_memory_bytes = 1u << 30;  // memory of the RDF documents of one `docent check`
  size_t check_facts = 300000;           // asserted and inferred facts of one search for contradictions
  int check_consistency_ms = 20000;      // time to look for contradictions in the files of one check
  size_t check_inconsistencies = 100;    // contradictions that are explained; the others are counted
  int shape_nesting = 64;  // shapes that refer to each other in a chain; paths inside each other
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_CHECK_LIMITS_H_
