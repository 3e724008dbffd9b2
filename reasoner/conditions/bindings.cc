#include "reasoner/conditions/bindings.h"

#include <algorithm>
#include <utility>

#include "graph/sparql/run/evaluator.h"

namespace docent::conditions {
namespace {

int CompareBindings(const std::vector<Term>& a, const std::vector<Term>& b) {
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (const int order = sparql::CompareTerms(a[i], b[i]); order != 0) return order;
  }
  return a.size() < b.size() ? -1 : a.size() > b.size() ? 1 : 0;
}

}  // namespace

void SortBindings(std::vector<Binding>& bindings, const Dictionary& dictionary) {
  if (bindings.size() < 2) return;
  std::vector<std::pair<std::vector<Term>, Binding>> keyed;
  for (Binding& binding : bindings) {
    std::vector<Term> terms;
    for (const auto& [name, id] : binding) terms.push_back(dictionary.Decode(id));
    keyed.emplace_back(std::move(terms), std::move(binding));
  }
  std::stable_sort(keyed.begin(), keyed.end(),
                   [](const auto& a, const auto& b) { return CompareBindings(a.first, b.first) < 0; });
  for (size_t i = 0; i < keyed.size(); ++i) bindings[i] = std::move(keyed[i].second);
}

}  // namespace docent::conditions
