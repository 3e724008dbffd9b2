// The kinds of findings that `docent check` reports, for people: what each means and what to do about it. The page of the
// documentation is made from this table. Any thread.
#ifndef DOCENT_REASONER_ONTOLOGY_FINDING_KINDS_H_
#define DOCENT_REASONER_ONTOLOGY_FINDING_KINDS_H_

#include <string_view>
#include <vector>

namespace docent::ontology {

struct FindingKind {
  std::string_view rule;      // Finding::rule, "undefined-term"
  std::string_view severity;  // "error", "warning", or "error or warning"
  std::string_view files;     // the kinds of files in which it is found
  std::string_view meaning;
  std::string_view remedy;
};

// In alphabetical order.
const std::vector<FindingKind>& FindingKinds();
bool IsFindingKind(std::string_view rule);

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_FINDING_KINDS_H_
