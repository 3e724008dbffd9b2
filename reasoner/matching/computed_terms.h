// Count of the texts that rules or conditions compute in one turn. They are in the dictionary, so that a rule that makes longer
// texts of its own results would fill the memory. One thread, which is the one that interns.
#ifndef DOCENT_REASONER_MATCHING_COMPUTED_TERMS_H_
#define DOCENT_REASONER_MATCHING_COMPUTED_TERMS_H_

#include <cstdint>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "graph/base/turn_limits.h"
#include "graph/rdf/dictionary.h"

namespace docent::matching {

class ComputedTerms {
 public:
  // `dictionary` must outlive it.
  explicit ComputedTerms(const Dictionary& dictionary) : dictionary_(dictionary) {}

  // What others have interned so far does not count. Before each piece of work.
  void Begin() { seen_ = dictionary_.size(); }
  // RESOURCE_EXHAUSTED, naming the limit, once all pieces of this turn have interned more than computed_bytes_per_turn.
  absl::Status Check() {
    for (const uint64_t size = dictionary_.size(); seen_ < size; ++seen_)
      bytes_ += dictionary_.EntryAt(seen_).text.size() + kBytesOfEntry;
    if (bytes_ <= kTurnLimits.computed_bytes_per_turn) return absl::OkStatus();
    return absl::ResourceExhaustedError(absl::StrCat("the terms that were computed in this turn have ",
                                                     bytes_, " bytes; the limit computed_bytes_per_turn is ",
                                                     kTurnLimits.computed_bytes_per_turn,
                                                     "; does a rule make longer texts of its own results?"));
  }
  // At the end of a turn.
  void Reset() { bytes_ = 0; }

 private:
  static constexpr uint64_t kBytesOfEntry = 40;  // beside the text

  const Dictionary& dictionary_;
  uint64_t seen_ = 0;  // entries
  uint64_t bytes_ = 0;
};

}  // namespace docent::matching

#endif  // DOCENT_REASONER_MATCHING_COMPUTED_TERMS_H_
