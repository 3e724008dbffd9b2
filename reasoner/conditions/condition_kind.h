// The shared part of conditions that differ only in constants; it keeps each condition small. Private to this
// folder. Writer thread only.
#ifndef DOCENT_REASONER_CONDITIONS_CONDITION_KIND_H_
#define DOCENT_REASONER_CONDITIONS_CONDITION_KIND_H_

#include <algorithm>
#include <cstdint>
#include <vector>

#include "absl/container/inlined_vector.h"
#include "absl/types/span.h"
#include "reasoner/conditions/watch_indexes.h"
#include "reasoner/matching/body.h"

namespace docent::conditions {

class ConditionTemplate;

struct ConditionKind {
  using Keys = absl::InlinedVector<int16_t, 2>;
  using Columns = absl::InlinedVector<int16_t, 4>;

  // `parameters`: columns of the body that hold the constants of a condition.
  ConditionKind(matching::Body& body, Keys keys, const std::vector<int16_t>& parameters,
                WatchIndexes& indexes);

  // The seed with the constants in their columns; valid until the next call.
  std::vector<TermId>& SeedWith(absl::Span<const TermId> constants) {
    for (const int16_t column : open) seed[column] = TermId();
    const TermId* constant = constants.data();
    for (const int16_t column : parameters) seed[column] = *constant++;
    return seed;
  }
  // A value that a matching quad gives to a seed without losing a solution: the word of the quad, and the
  // column.
  struct Gift {
    uint8_t word;
    int16_t column;
  };
  using Gifts = absl::InlinedVector<Gift, 4>;
  // A change that breaks a witness: a quad is added or removed, and matches the trigger with the witness's
  // values.
  struct Breaker {
    const matching::Trigger* trigger;
    bool comes;
    uint16_t detail;  // of its references
  };

  // True if a probe has a binding to start from: from a change that matches the trigger, or from a constant.
  // Otherwise it is a whole evaluation.
  bool Narrows(uint32_t trigger) const { return (whole & (1u << std::min(trigger, 31u))) == 0; }

  matching::Body& body;
  WatchIndexes& indexes;
  ConditionTemplate* condition_template = nullptr;  // null: none
  const bool has_keys;
  bool borrows = false;  // the body is the template's
  uint32_t whole = 0;    // bits of the triggers that do not narrow; the last bit stands for all beyond
  const Keys keys;       // columns of the body
  const Columns parameters;
  Columns open;              // the columns that are not parameters
  std::vector<Gifts> gifts;  // by trigger
  std::vector<Breaker> breakers;
  std::vector<TermId> seed;  // scratch
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_CONDITION_KIND_H_
