// The indexes that all conditions and shapes share. Private to this folder. Writer thread only.
#ifndef DOCENT_REASONER_CONSTRAINTS_WATCH_INDEXES_H_
#define DOCENT_REASONER_CONSTRAINTS_WATCH_INDEXES_H_

#include <cstdint>
#include <vector>

#include "reasoner/matching/pattern_index.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent {

// References name a condition and, for rises, one of its triggers, for breaks, one of its witnesses. In the
// rise indexes an owner with kIsShape is a shape.
struct WatchIndexes {
  static constexpr uint32_t kIsShape = 0x80000000u;

  PatternIndex rise_on_add;
  PatternIndex rise_on_remove;
  PatternIndex break_on_add;
  PatternIndex break_on_remove;
  std::vector<TermId> seed;  // scratch of whoever evaluates
};

// In which direction a trigger can make a condition rise.
inline bool RisesOnAdd(Polarity polarity) {
  return polarity != Polarity::kNegative;
}
inline bool RisesOnRemove(Polarity polarity) {
  return polarity != Polarity::kPositive;
}

}  // namespace docent

#endif  // DOCENT_REASONER_CONSTRAINTS_WATCH_INDEXES_H_
