#include "reasoner/rules/equality_classes.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace docent::rules {
uint32_t EqualityClasses::ClassOf(TermId term) {
  const auto [place, is_new] = class_of_.try_emplace(term, 0);
  if (!is_new) return place->second;
  uint32_t id = static_cast<uint32_t>(classes_.size());
  if (free_.empty()) {
    classes_.emplace_back();
  } else {
    id = free_.back();
    free_.pop_back();
  }
  place->second = id;
  classes_[id].members = {term};
  classes_[id].blocks = {0};
  return id;
}

// False: already there.
bool EqualityClasses::AddLiteral(uint32_t to, TermId literal) {
  std::vector<TermId>& literals = classes_[to].literals;
  const auto place = std::lower_bound(literals.begin(), literals.end(), literal);
  if (place != literals.end() && *place == literal) return false;
  literals.insert(place, literal);
  named_[literal].push_back(to);
  return true;
}

void EqualityClasses::DropLiterals(uint32_t from) {
  for (const TermId literal : classes_[from].literals) {
    const auto place = named_.find(literal);
    std::erase(place->second, from);
    if (place->second.empty()) named_.erase(place);
  }
}

// The smaller class goes into the larger one, so n joins move at most n log n terms.
bool EqualityClasses::Join(TermId a, TermId b) {
  if (a == b) return false;
  uint32_t into = ClassOf(a);
  if (b.IsLiteral()) {
    if (!AddLiteral(into, b)) return false;
  } else {
    uint32_t from = ClassOf(b);
    if (into == from) return false;
    if (classes_[into].members.size() < classes_[from].members.size()) std::swap(into, from);
    Class& large = classes_[into];
    Class& small = classes_[from];
    for (const size_t begin : small.blocks) large.blocks.push_back(large.members.size() + begin);
    for (const TermId term : small.members) class_of_[term] = into;
    large.members.insert(large.members.end(), small.members.begin(), small.members.end());
    DropLiterals(from);
    for (const TermId literal : small.literals) AddLiteral(into, literal);
    small = Class();
    free_.push_back(from);
  }
  unsettled_.push_back(into);
  ++changes_;
  return true;
}

const EqualityClasses::Class* EqualityClasses::Find(TermId term) const {
  const auto found = class_of_.find(term);
  return found == class_of_.end() ? nullptr : &classes_[found->second];
}

bool EqualityClasses::AreEqual(TermId a, TermId b) const {
  if (a == b) return true;
  const Class* of_a = Find(a);
  if (of_a == nullptr) return false;
  if (!b.IsLiteral()) return of_a == Find(b);
  return std::binary_search(of_a->literals.begin(), of_a->literals.end(), b);
}

std::vector<TermId> EqualityClasses::ClassesNamed(TermId literal) const {
  std::vector<TermId> representatives;
  if (const auto found = named_.find(literal); found != named_.end()) {
    for (const uint32_t id : found->second) representatives.push_back(classes_[id].representative());
  }
  return representatives;
}

TermId EqualityClasses::Representative(TermId term) const {
  const Class* of_term = Find(term);
  return of_term == nullptr ? term : of_term->representative();
}

std::vector<TermId> EqualityClasses::Joined() const {
  std::vector<TermId> joined;
  for (const uint32_t id : unsettled_) {
    if (!classes_[id].members.empty()) joined.push_back(classes_[id].representative());
  }
  std::sort(joined.begin(), joined.end());
  joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
  return joined;
}

void EqualityClasses::Settle() {
  for (const uint32_t id : unsettled_) {
    if (!classes_[id].members.empty()) classes_[id].blocks = {0};
  }
  unsettled_.clear();
}

void EqualityClasses::Unsettle(TermId member) {
  const auto found = class_of_.find(member);
  if (found == class_of_.end()) return;
  Class& taken = classes_[found->second];
  taken.blocks.resize(taken.members.size());
  std::iota(taken.blocks.begin(), taken.blocks.end(), size_t{0});
  unsettled_.push_back(found->second);
}

void EqualityClasses::Dissolve(TermId member) {
  const auto found = class_of_.find(member);
  if (found == class_of_.end()) return;
  const uint32_t id = found->second;
  DropLiterals(id);
  for (const TermId term : classes_[id].members) class_of_.erase(term);
  classes_[id] = Class();
  free_.push_back(id);
  std::erase(unsettled_, id);
  ++changes_;
}

void EqualityClasses::Clear() {
  class_of_.clear();
  named_.clear();
  classes_.clear();
  free_.clear();
  unsettled_.clear();
  ++changes_;
}

}  // namespace docent::rules
