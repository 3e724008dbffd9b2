// Limit of the search for a proof that is not the shortest. As in limits.h, an error at a limit gives its name and value.
#ifndef DOCENT_GRAPH_BASE_PROOF_LIMITS_H_
#define DOCENT_GRAPH_BASE_PROOF_LIMITS_H_

#include <cstddef>

namespace docent {

struct ProofLimits {
  size_t proof_steps =
      20000000;  // steps of the search for any proof, once that for the shortest has ended at explain_steps
};

inline constexpr ProofLimits kProofLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_PROOF_LIMITS_H_
