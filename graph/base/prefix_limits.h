// Limits of the prefixes that the server remembers from documents; clients use them to print short names.
#ifndef DOCENT_GRAPH_BASE_PREFIX_LIMITS_H_
#define DOCENT_GRAPH_BASE_PREFIX_LIMITS_H_

#include <cstddef>

namespace docent {

// Prefixes beyond a limit are left out: their IRIs are printed whole.
struct PrefixLimits {
  size_t module_prefixes = 256;  // prefixes kept of one ontology module, in the order of their declarations
  size_t prefix_bytes = 1024;    // name and namespace of one prefix together
  size_t known_prefixes = 4096;  // prefixes known of all ontology modules, rule sets and workflows
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_PREFIX_LIMITS_H_
