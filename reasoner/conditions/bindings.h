// Order of bindings in answers to users. Private to this folder. Any thread.
#ifndef DOCENT_REASONER_CONDITIONS_BINDINGS_H_
#define DOCENT_REASONER_CONDITIONS_BINDINGS_H_

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "graph/rdf/dictionary.h"
#include "reasoner/conditions/standing_conditions.h"

namespace docent::conditions {

// Sorts by the values, first variable first, in SPARQL's term order (CompareTerms).
void SortBindings(std::vector<Binding>& bindings, const Dictionary& dictionary);

// The first of many bindings in that order, each once. It holds not many more than it is asked for.
class FirstBindings {
 public:
  FirstBindings(size_t limit, const Dictionary& dictionary) : limit_(limit), dictionary_(dictionary) {}

  void Add(Binding binding);
  // In order, at most `limit`.
  std::vector<Binding> Take();

 private:
  using Keyed = std::pair<std::vector<Term>, Binding>;
  void Cut();

  const size_t limit_;
  const Dictionary& dictionary_;
  std::vector<Keyed> kept_;
  absl::flat_hash_set<Binding> seen_;      // of those that are kept
  std::optional<std::vector<Term>> last_;  // of a full number: none behind it counts
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_BINDINGS_H_
