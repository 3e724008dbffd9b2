#include "reasoner/rules/certain_equality.h"

#include <algorithm>
#include <utility>

#include "graph/base/step_costs.h"

namespace docent::rules {
namespace {

// The names of a term: in the position of an object, also literals.
struct Names {
  Names(const EqualityClasses& classes, TermId term, bool as_object) : itself(term) {
    const EqualityClasses::Class* of_term = classes.Find(term);
    if (of_term == nullptr) {
      members = absl::MakeConstSpan(&itself, 1);
    } else {
      members = of_term->members;
      if (as_object) literals = of_term->literals;
    }
  }
  Names(const Names&) = delete;
  Names& operator=(const Names&) = delete;
  size_t size() const { return members.size() + literals.size(); }

  const TermId itself;
  absl::Span<const TermId> members, literals;
};

}  // namespace

Triple UnderRepresentatives(const EqualityClasses& classes, const Triple& fact) {
  return {classes.Representative(fact.subject), classes.Representative(fact.predicate),
          classes.Representative(fact.object)};
}

std::vector<TermId> ObjectsThatMake(const EqualityClasses& classes, TermId object) {
  std::vector<TermId> objects = classes.ClassesNamed(object);
  objects.push_back(classes.Representative(object));
  return objects;
}

bool ForEachName(const EqualityClasses& classes, const Triple& fact, NamesOf which,
                 absl::FunctionRef<bool(const Triple&)> visit) {
  const Names subjects(classes, fact.subject, false), predicates(classes, fact.predicate, false),
      objects(classes, fact.object, which == NamesOf::kMade);
  for (const TermId subject : subjects.members) {
    for (const TermId predicate : predicates.members) {
      if (!predicate.IsIri()) continue;
      for (const TermId object : objects.members) {
        if (!visit({subject, predicate, object})) return false;
      }
      for (const TermId object : objects.literals) {
        if (!visit({subject, predicate, object})) return false;
      }
    }
  }
  return true;
}

size_t CountNames(const EqualityClasses& classes, const Triple& fact) {
  const Names subjects(classes, fact.subject, false), predicates(classes, fact.predicate, false),
      objects(classes, fact.object, true);
  const double count = static_cast<double>(subjects.size()) * static_cast<double>(predicates.size()) *
                       static_cast<double>(objects.size());
  return static_cast<size_t>(std::min(count, 1e18));
}

bool CertainEquality::MayMake(const Triple& fact) const {
  return !classes_.empty() &&
         (classes_.Find(fact.subject) != nullptr || classes_.Find(fact.predicate) != nullptr ||
          classes_.Find(fact.object) != nullptr || classes_.IsName(fact.object));
}

bool CertainEquality::IsTold(const Triple& fact) const {
  if (cancellation_ != nullptr) cancellation_->Spend(kStepsOfLookup);
  for (QuadCursor c = writer_.current().Scan({fact.subject, fact.predicate, fact.object, TermId()});
       c.Valid(); c.Next()) {
    if (c.quad().graph != inferred_graph_) return true;
  }
  return false;
}

// Pairs asserted in this turn only do not count: nothing is written out for them yet.
void CertainEquality::Load(TermId term) {
  const EqualityClasses::Class* of_term = classes_.Find(term);
  if (of_term == nullptr || !loaded_.insert(of_term->representative()).second) return;
  for (const TermId member : of_term->members) {
    for (QuadCursor c = writer_.current().Scan({member, program_.equality.same_as, TermId(), TermId()});
         c.Valid(); c.Next()) {
      if (c.quad().graph != inferred_graph_ && classes_.AreEqual(member, c.quad().object))
        certain_.Join(member, c.quad().object);
    }
  }
}

bool CertainEquality::Proves(const Triple& fact) {
  if (!MayMake(fact)) return false;
  for (const TermId term : {fact.subject, fact.predicate, fact.object}) Load(term);
  const bool pair = fact.predicate == program_.equality.same_as;
  if (pair && fact.subject != fact.object && certain_.AreEqual(fact.subject, fact.object)) return true;
  if (pair && fact.subject == fact.object) {
    const EqualityClasses::Class* of_term = certain_.Find(fact.subject);
    if (of_term != nullptr && of_term->members.size() > 1) return true;
  }
  const Triple key = UnderRepresentatives(certain_, fact);
  for (const TermId object : ObjectsThatMake(certain_, fact.object)) {
    if (!IsSaid({key.subject, key.predicate, object})) continue;
    Note(fact);
    return true;
  }
  return false;
}

bool CertainEquality::IsSaid(const Triple& key) {
  if (proven_.contains(key)) return true;
  if (not_told_.contains(key) || CountNames(certain_, key) > kManyNames) return false;
  const bool told =
      !ForEachName(certain_, key, NamesOf::kMakers, [&](const Triple& t) { return !IsTold(t); });
  if (!told) not_told_.insert(key);
  return told;
}

void CertainEquality::Note(const Triple& fact) {
  if (!MayMake(fact)) return;
  for (const TermId term : {fact.subject, fact.predicate, fact.object}) Load(term);
  proven_.insert(UnderRepresentatives(certain_, fact));
  const bool pair =
      fact.predicate == program_.equality.same_as && classes_.AreEqual(fact.subject, fact.object);
  if (pair && certain_.Join(fact.subject, fact.object)) not_told_.clear();
}

std::vector<EqualityClasses::Class> CertainEquality::PartsOf(TermId member) {
  Load(member);
  std::vector<EqualityClasses::Class> parts;
  for (const TermId term : classes_.Find(member)->members) {
    const EqualityClasses::Class* part = certain_.Find(term);
    if (part != nullptr && part->representative() == term) parts.push_back(*part);
  }
  return parts;
}

}  // namespace docent::rules
