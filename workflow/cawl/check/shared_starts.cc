#include "workflow/cawl/check/shared_starts.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/formula.h"
#include "workflow/cawl/rule_names.h"

namespace docent::cawl {
namespace {

constexpr size_t kMaxEqualParts = 64;  // larger situations are not compared as a whole
constexpr char kChose[] = "https://w3id.org/docent#chose";

// In an activator no variable has a value.
bool IsVariable(const Word& word) {
  return word.kind == Word::Kind::kVariable || word.kind == Word::Kind::kFree;
}

std::vector<Conjunction> AlternativesOf(const Activator& activator) {
  std::vector<Conjunction> out;
  for (const Formula& part : PartsOf(activator.condition)) {
    absl::StatusOr<std::vector<Conjunction>> alternatives = ToAlternatives(part);
    if (!alternatives.ok()) return {};  // an error says so
    for (Conjunction& one : *alternatives) out.push_back(std::move(one));
  }
  return out;
}

std::optional<double> NumberOf(const Word& word) {
  if (word.kind != Word::Kind::kTerm || word.term.IsIri()) return std::nullopt;
  char* end = nullptr;
  const double number = std::strtod(word.term.lexical.c_str(), &end);
  if (end == word.term.lexical.c_str() || *end != '\0') return std::nullopt;
  return number;
}

bool Holds(double value, Word::Comparison comparison, double limit) {
  switch (comparison) {
    case Word::Comparison::kNone:
    case Word::Comparison::kEqual:
      return value == limit;
    case Word::Comparison::kNotEqual:
      return value != limit;
    case Word::Comparison::kLess:
      return value < limit;
    case Word::Comparison::kLessOrEqual:
      return value <= limit;
    case Word::Comparison::kGreater:
      return value > limit;
    case Word::Comparison::kGreaterOrEqual:
      return value >= limit;
  }
  return true;
}

bool IsOneValue(const Word& word) {
  return word.comparison == Word::Comparison::kNone || word.comparison == Word::Comparison::kEqual;
}
bool IsBelow(const Word& word) {
  return word.comparison == Word::Comparison::kLess || word.comparison == Word::Comparison::kLessOrEqual;
}
bool IsAbove(const Word& word) {
  return word.comparison == Word::Comparison::kGreater ||
         word.comparison == Word::Comparison::kGreaterOrEqual;
}

// Whether no value is as both say. What is not known counts as possible.
bool Exclude(const Word& a, const Word& b) {
  if (a.kind != Word::Kind::kTerm || b.kind != Word::Kind::kTerm) return false;
  const std::optional<double> x = NumberOf(a), y = NumberOf(b);
  if (!x || !y) {
    if (IsOneValue(a) && IsOneValue(b)) return a.term != b.term;
    const bool unequal =
        a.comparison == Word::Comparison::kNotEqual || b.comparison == Word::Comparison::kNotEqual;
    return unequal && (IsOneValue(a) || IsOneValue(b)) && a.term == b.term;
  }
  if (IsOneValue(a)) return !Holds(*x, b.comparison, *y);
  if (IsOneValue(b)) return !Holds(*y, a.comparison, *x);
  if (IsBelow(a) && IsAbove(b))
    return *x < *y || (*x == *y && !Holds(*x, a.comparison, *x)) ||
           (*x == *y && !Holds(*y, b.comparison, *y));
  if (IsAbove(a) && IsBelow(b)) return Exclude(b, a);
  return false;
}

// Variables of one alternative, and those of another that stand for the same.
class Renaming {
 public:
  // False: they stand for others already.
  bool Add(const std::string& a, const std::string& b) {
    const auto there = to_.find(a);
    const auto back = from_.find(b);
    if (there == to_.end() && back == from_.end()) {
      to_[a] = b;
      from_[b] = a;
      return true;
    }
    return there != to_.end() && there->second == b;
  }
  bool Same(const Word& a, const Word& b) const {
    if (IsVariable(a) != IsVariable(b)) return false;
    if (!IsVariable(a)) return a.term == b.term && a.comparison == b.comparison;
    const auto there = to_.find(a.name);
    return there != to_.end() ? there->second == b.name : from_.count(b.name) == 0 && a.name == b.name;
  }
  // As above, and variables that stand for nothing yet may stand for each other.
  bool MayBeSame(const Word& a, const Word& b) const {
    if (Same(a, b)) return true;
    return IsVariable(a) && IsVariable(b) && to_.count(a.name) == 0 && from_.count(b.name) == 0;
  }
  // Makes them the same, where they may be.
  bool Unify(const Word& a, const Word& b) {
    return IsVariable(a) && IsVariable(b) && a.comparison == b.comparison ? Add(a.name, b.name) : Same(a, b);
  }

 private:
  std::map<std::string, std::string> to_, from_;
};

// Compares an alternative of the document with one of another workflow.
class Comparison {
 public:
  Comparison(const Conjunction& a, const Conjunction& b, size_t* steps) : a_(a), b_(b), steps_(*steps) {}

  // Where the document says on which occasion both start; nullptr: they do not, as far as can be told.
  const SourceSpan* Place() {
    for (const Event* event : a_.events) {
      const auto same = [&](const Event* other) { return event->operation.value == other->operation.value; };
      if (std::any_of(b_.events.begin(), b_.events.end(), same) && !AreApart(Renaming()))
        return &event->operation.span;
    }
    // What one of them waits for beside it is told at other times.
    if (a_.events.empty() != b_.events.empty()) return nullptr;
    for (const Constraint* wish : a_.constraints) {
      for (const Constraint* other : b_.constraints) {
        Renaming renaming;
        if (IsSameWish(*wish, *other, &renaming) && !AreApart(renaming)) return &PlaceOf(*wish);
      }
    }
    if (!a_.events.empty() || a_.constraints.empty() || a_.constraints.size() > kMaxEqualParts)
      return nullptr;
    return a_.constraints.size() == b_.constraints.size() && AreEqual(0, {}, Renaming())
               ? &PlaceOf(*a_.constraints[0])
               : nullptr;
  }

 private:
  static const SourceSpan& PlaceOf(const Constraint& constraint) {
    return constraint.name.given() ? constraint.name.span : constraint.subject.span;
  }
  bool Step() { return steps_ > 0 && steps_-- > 0; }

  static bool IsWish(const Constraint& c) {
    return c.verb.kind == Word::Kind::kTerm && c.verb.term.lexical == kChose;
  }
  // A service that is chosen by its name, or any.
  bool IsSameWish(const Constraint& a, const Constraint& b, Renaming* renaming) {
    if (!Step() || !IsWish(a) || !IsWish(b) || Exclude(a.object, b.object)) return false;
    if (!renaming->Unify(a.subject, b.subject)) return false;
    return !IsVariable(a.object) || !IsVariable(b.object) || renaming->Unify(a.object, b.object);
  }

  // Whether one of them says what the other one denies.
  bool AreApart(const Renaming& renaming) {
    bool any_time = false, one_time = false;
    for (const Constraint* a : a_.constraints) {
      for (const Constraint* b : b_.constraints) {
        if (!Step()) return true;
        if (a->time == Constraint::Time::kLasts && b->time == Constraint::Time::kLasts) {
          any_time = true;
          one_time = one_time || a->subject.term == b->subject.term;
        }
        const bool types = a->verb.kind == Word::Kind::kTerm && a->verb.term.lexical == kRdfType;
        if (types || !renaming.Same(a->subject, b->subject) || !renaming.Same(a->verb, b->verb)) continue;
        if (Exclude(a->object, b->object)) return true;
      }
    }
    if (any_time && !one_time) return true;  // at other times, most likely
    const auto denied_by_b = [&](const Formula& absent) {
      return IsSaid(absent, a_,
                    [&](const Word& other, const Word& own) { return renaming.MayBeSame(own, other); });
    };
    const auto denied_by_a = [&](const Formula& absent) {
      return IsSaid(absent, b_,
                    [&](const Word& own, const Word& other) { return renaming.MayBeSame(own, other); });
    };
    return std::any_of(b_.absent.begin(), b_.absent.end(), denied_by_b) ||
           std::any_of(a_.absent.begin(), a_.absent.end(), denied_by_a);
  }

  template <typename Same>
  bool IsSaid(const Formula& formula, const Conjunction& by, const Same& same) {
    const auto said = [&](const Formula& child) { return IsSaid(child, by, same); };
    switch (formula.kind) {
      case Formula::Kind::kConstraint:
        return std::any_of(by.constraints.begin(), by.constraints.end(), [&](const Constraint* other) {
          const Constraint& c = *formula.constraint;
          return Step() && same(c.subject, other->subject) && same(c.verb, other->verb) &&
                 same(c.object, other->object);
        });
      case Formula::Kind::kAnd:
        return std::all_of(formula.children.begin(), formula.children.end(), said);
      case Formula::Kind::kOr:
        return std::any_of(formula.children.begin(), formula.children.end(), said);
      case Formula::Kind::kEvent:
      case Formula::Kind::kNot:
        return false;
    }
    return false;
  }

  // Whether each constraint from `index` on is one of the other's that is not taken yet, by one renaming.
  bool AreEqual(size_t index, const std::vector<const Constraint*>& taken, const Renaming& renaming) {
    if (index == a_.constraints.size()) return !AreApart(renaming);
    const Constraint& a = *a_.constraints[index];
    for (const Constraint* b : b_.constraints) {
      if (!Step()) return false;
      if (std::find(taken.begin(), taken.end(), b) != taken.end()) continue;
      Renaming more = renaming;
      if (!more.Unify(a.subject, b->subject) || !more.Unify(a.verb, b->verb) ||
          !more.Unify(a.object, b->object)) {
        continue;
      }
      std::vector<const Constraint*> all = taken;
      all.push_back(b);
      if (AreEqual(index + 1, all, more)) return true;
    }
    return false;
  }

  const Conjunction& a_;
  const Conjunction& b_;
  size_t& steps_;
};

const SourceSpan* SharedPlace(const std::vector<Conjunction>& own, const std::vector<Conjunction>& other,
                              size_t* steps) {
  for (const Conjunction& a : own) {
    for (const Conjunction& b : other) {
      if (const SourceSpan* place = Comparison(a, b, steps).Place(); place != nullptr) return place;
    }
  }
  return nullptr;
}

}  // namespace

void CheckSharedStarts(const Document& document, const std::vector<DocumentPtr>& beside,
                       xml::ElementReader* reader, Cancellation* cancellation) {
  if (!document.activator) return;
  const std::vector<Conjunction> own = AlternativesOf(*document.activator);
  size_t steps = kMaxSharedStartSteps;
  for (const DocumentPtr& other : beside) {
    if (steps == 0 || IsOver(cancellation)) return;
    if (!other->activator || other->name.value == document.name.value) continue;
    const SourceSpan* place = SharedPlace(own, AlternativesOf(*other->activator), &steps);
    if (place == nullptr) continue;
    Diagnostic& report = reader->Warning(
        *place, Concat("workflow ", other->name.value, " starts a run then, too: each of them serves it"),
        Concat("disable ", other->name.value,
               " (docent workflows disable), give this one its name to replace it, ",
               "or say in the conditions what tells them apart"));
    report.rule = kSharedStart;
  }
}

}  // namespace docent::cawl
