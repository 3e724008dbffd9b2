#include "reasoner/ontology/finding.h"

#include <algorithm>

namespace docent::ontology {

std::vector<Finding> Findings::Take() {
  std::stable_sort(findings_.begin(), findings_.end(), [](const Finding& a, const Finding& b) {
    const SourceSpan &x = a.diagnostic.span, &y = b.diagnostic.span;
    return std::pair(x.line, x.column) < std::pair(y.line, y.column);
  });
  return std::move(findings_);
}

}  // namespace docent::ontology
