// The indexes of watches, shared by all conditions and templates. Private to this folder. Writer thread only.
#ifndef DOCENT_REASONER_CONDITIONS_WATCH_INDEXES_H_
#define DOCENT_REASONER_CONDITIONS_WATCH_INDEXES_H_

#include <algorithm>
#include <cstdint>
#include <vector>

#include "graph/base/run_limits.h"
#include "graph/base/turn_limits.h"
#include "reasoner/matching/pattern_index.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent::conditions {

// Costs in the steps of graph/base/step_costs.h.
inline constexpr uint64_t kStepsOfMatch = 400;     // a match that is kept, watched and told
inline constexpr uint64_t kStepsOfSolution = 100;  // a solution that is asked for

// Finds the conditions affected by an added and by a removed quad. A reference's owner is a condition. Its
// pattern is a trigger, which may rise, or a witness, which may be broken; then the detail is the trigger.
struct WatchIndexes {
  static constexpr uint32_t kIsTemplate = 0x80000000u;  // in an owner: it is a template
  static constexpr uint32_t kIsWitness = 0x80000000u;   // in a pattern: it is a witness
  static constexpr uint16_t kSomeTrigger = 0xffff;      // in a detail: too many triggers to name one

  // A handle of on_add, or with kGoes of on_remove.
  using Watch = matching::PatternIndex::Handle;
  static constexpr Watch kGoes = 0x80000000u;

  // Watches additions that match `match`, with `constants` instead of its own.
  Watch Comes(const matching::MatchPattern& match, const QuadPattern& constants,
              matching::PatternIndex::Reference reference) {
    return on_add.Add(match, constants, reference);
  }
  Watch Goes(const matching::MatchPattern& match, const QuadPattern& constants,
             matching::PatternIndex::Reference reference) {
    return on_remove.Add(match, constants, reference) | kGoes;
  }
  template <typename Watches>
  void RemoveAll(Watches& watches) {
    for (const Watch watch : watches) {
      if ((watch & kGoes) == 0) {
        on_add.Remove(watch);
      } else {
        on_remove.Remove(watch & ~kGoes);
      }
    }
    watches.clear();
  }

  const matching::PatternIndex& ForChange(bool added) const { return added ? on_add : on_remove; }

  // At most so many keys are kept of one condition. As many as the graph has facts may be: what grows faster than the graph
  // joins patterns that have little in common.
  void SetGraphSize(size_t facts) {
    most_matches = std::max(matches_allowed, facts);
    // matches_live, where matches_allowed is condition_matches
    constexpr size_t kFull = kTurnLimits.matches_live / kRunLimits.condition_matches;
    most_live = matches_allowed == SIZE_MAX ? SIZE_MAX : std::max(kFull * matches_allowed, 2 * facts);
  }
  size_t matches_allowed = SIZE_MAX;
  size_t most_matches = SIZE_MAX;
  // The same of all conditions together, where matches are limited. The update that would keep more is refused.
  size_t most_live = SIZE_MAX;
  size_t live = 0;  // keys that are kept
  bool live_exceeded = false;

  matching::PatternIndex on_add;
  matching::PatternIndex on_remove;
};

// Clears all columns. (Usually the size is right already; then this is faster than assign.)
inline void ClearSeed(size_t columns, std::vector<TermId>& seed) {
  if (seed.size() != columns) seed.resize(columns);
  std::fill(seed.begin(), seed.end(), TermId());
}

// True if an added match of such a trigger can make a condition rise.
inline bool RisesOnAdd(matching::Polarity polarity) {
  return polarity != matching::Polarity::kNegative;
}
inline bool RisesOnRemove(matching::Polarity polarity) {
  return polarity != matching::Polarity::kPositive;
}

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_WATCH_INDEXES_H_
