// Limits of what one turn makes and keeps in memory, beside those of limits.h, whose rules hold here. They cannot be configured.
#ifndef DOCENT_GRAPH_BASE_TURN_LIMITS_H_
#define DOCENT_GRAPH_BASE_TURN_LIMITS_H_

#include <cstddef>

namespace docent {

struct TurnLimits {
  // memory of a turn
  size_t computed_bytes_per_turn =
      256u
      << 20;  // texts of terms that rules compute in one turn, or conditions; beyond, the turn is refused
  size_t matches_live =
      2000000;  // matches kept of all conditions of workflows, or twice as many as the graph has facts; beyond, the turn is refused
};

inline constexpr TurnLimits kTurnLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_TURN_LIMITS_H_
