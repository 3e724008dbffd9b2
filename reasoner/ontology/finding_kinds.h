// The kinds of findings that `docent check` reports, with explanations for people: meaning and remedy. A page
// of the documentation is generated from this table. Any thread.
#ifndef DOCENT_REASONER_ONTOLOGY_FINDING_KINDS_H_
#define DOCENT_REASONER_ONTOLOGY_FINDING_KINDS_H_

#include <string_view>
#include <vector>

namespace docent::ontology {

struct FindingKind {
  std::string_view rule;      // Finding::rule, "undefined-term"
  std::string_view severity;  // "error", "warning", or "error or warning"
  std::string_view files;     // the kinds of files that can have it
  std::string_view meaning;
  std::string_view remedy;
};

// In alphabetical order.
const std::vector<FindingKind>& FindingKinds();
bool IsFindingKind(std::string_view rule);

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_FINDING_KINDS_H_
