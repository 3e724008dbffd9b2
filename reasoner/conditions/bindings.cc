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

std::vector<Term> TermsOf(const Binding& binding, const Dictionary& dictionary) {
  std::vector<Term> terms;
  terms.reserve(binding.size());
  for (const auto& [name, id] : binding) terms.push_back(dictionary.Decode(id));
  return terms;
}

void Sort(std::vector<std::pair<std::vector<Term>, Binding>>& keyed) {
  std::stable_sort(keyed.begin(), keyed.end(),
                   [](const auto& a, const auto& b) { return CompareBindings(a.first, b.first) < 0; });
}

// So many more than are asked for are kept before they are sorted.
constexpr size_t kSpare = 64;

}  // namespace

void FirstBindings::Add(Binding binding) {
  std::vector<Term> terms = TermsOf(binding, dictionary_);
  if (last_ && CompareBindings(terms, *last_) >= 0) return;
  if (!seen_.insert(binding).second) return;
  kept_.emplace_back(std::move(terms), std::move(binding));
  if (kept_.size() > kSpare && (kept_.size() - kSpare) / 2 >= limit_) Cut();
}

void FirstBindings::Cut() {
  Sort(kept_);
  kept_.resize(limit_);
  seen_.clear();
  for (const Keyed& keyed : kept_) seen_.insert(keyed.second);
  if (!kept_.empty()) last_ = kept_.back().first;
}

std::vector<Binding> FirstBindings::Take() {
  Sort(kept_);
  if (kept_.size() > limit_) kept_.resize(limit_);
  std::vector<Binding> bindings;
  bindings.reserve(kept_.size());
  for (Keyed& keyed : kept_) bindings.push_back(std::move(keyed.second));
  return bindings;
}

void SortBindings(std::vector<Binding>& bindings, const Dictionary& dictionary) {
  if (bindings.size() < 2) return;
  std::vector<std::pair<std::vector<Term>, Binding>> keyed;
  for (Binding& binding : bindings) {
    std::vector<Term> terms = TermsOf(binding, dictionary);
    keyed.emplace_back(std::move(terms), std::move(binding));
  }
  Sort(keyed);
  for (size_t i = 0; i < keyed.size(); ++i) bindings[i] = std::move(keyed[i].second);
}

}  // namespace docent::conditions
