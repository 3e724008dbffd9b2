// Checks of the constraint components of SHACL Core, section 4. Each names its section.
#include <algorithm>
#include <map>
#include <optional>

#include "absl/functional/function_ref.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/sparql/values/text.h"
#include "graph/sparql/values/value.h"
#include "reasoner/shapes/datatype_check.h"
#include "reasoner/shapes/evaluation.h"

namespace docent::shapes {
namespace {

using sparql::Value;

// SPARQL's order of literals, except that times with and without zone compare only if they are more than 14
// hours apart (XML Schema part 2, section 3.2.7.4). nullopt: not comparable.
std::optional<int> Compare(TermId a, TermId b, const Dictionary& dictionary) {
  const Value left = Value::OfId(a, dictionary), right = Value::OfId(b, dictionary);
  if (left.IsTime() && right.IsTime() &&
      left.zone_minutes().has_value() != right.zone_minutes().has_value()) {
    if (left.type() != right.type()) return std::nullopt;
    constexpr TimeMicros kFourteenHours = TimeMicros{14} * 3600 * 1'000'000;
    const TimeMicros difference = left.instant_us() - right.instant_us();
    if (difference > kFourteenHours) return 1;
    if (difference < -kFourteenHours) return -1;
    return std::nullopt;
  }
  bool unordered = false;
  const std::optional<int> order = sparql::CompareValues(left, right, &unordered);
  return unordered ? std::nullopt : order;
}

size_t CodePoints(std::string_view text) {
  size_t count = 0;
  for (const char c : text) count += (static_cast<unsigned char>(c) & 0xC0) != 0x80 ? 1 : 0;
  return count;
}

// SPARQL's langMatches (section 17.4.3.11, RFC 4647 basic filtering).
bool LanguageMatches(std::string_view tag, std::string_view range) {
  if (range == "*") return !tag.empty();
  if (tag.size() < range.size() || !sparql::EqualsIgnoreCase(tag.substr(0, range.size()), range))
    return false;
  return tag.size() == range.size() || tag[range.size()] == '-';
}

}  // namespace

void Evaluation::CheckConstraint(const Place& place) {
  switch (place.constraint.component) {
    case Component::kClass:
    case Component::kDatatype:
    case Component::kNodeKind:
      return CheckValueType(place);
    case Component::kMinCount:
    case Component::kMaxCount:
      return CheckCount(place);
    case Component::kMinExclusive:
    case Component::kMinInclusive:
    case Component::kMaxExclusive:
    case Component::kMaxInclusive:
      return CheckRange(place);
    case Component::kMinLength:
    case Component::kMaxLength:
    case Component::kPattern:
    case Component::kLanguageIn:
      return CheckString(place);
    case Component::kUniqueLang:
      return CheckUniqueLang(place);
    case Component::kEquals:
      return CheckEquals(place);
    case Component::kDisjoint:
      return CheckDisjoint(place);
    case Component::kLessThan:
    case Component::kLessThanOrEquals:
      return CheckLess(place);
    case Component::kNot:
    case Component::kAnd:
    case Component::kOr:
    case Component::kXone:
      return CheckLogic(place);
    case Component::kNode:
      return CheckNode(place);
    case Component::kProperty:
      return CheckProperty(place);
    case Component::kQualifiedMinCount:
    case Component::kQualifiedMaxCount:
      return CheckQualified(place);
    case Component::kClosed:
      return CheckClosed(place);
    case Component::kHasValue:
    case Component::kIn:
      return CheckOthers(place);
    case Component::kSparql:
    case Component::kOwn:
      return CheckQuery(place);
  }
}

// 4.1.1 sh:class, 4.1.2 sh:datatype, 4.1.3 sh:nodeKind
void Evaluation::CheckValueType(const Place& place) {
  const TermId wanted = place.constraint.value;
  const std::string_view name = dictionary_.Lexical(wanted);
  for (const TermId value : place.values) {
    if (!Poll() || place.sink.done()) return;
    if (place.constraint.component == Component::kClass) {
      if (!IsInstance(value, wanted))
        Report(place, value, absl::StrCat("is not an instance of ", Show(wanted)));
    } else if (place.constraint.component == Component::kDatatype) {
      if (!value.IsLiteral() || dictionary_.Datatype(value) != name) {
        Report(place, value, absl::StrCat("is not of datatype ", Show(wanted)));
      } else if (!value.InDictionary() ||
                 IsValidLexicalForm(dictionary_.Lexical(value), name).value_or(true)) {
        continue;
      } else {
        Report(place, value, absl::StrCat("is not a text that ", Show(wanted), " allows"));
      }
    } else {
      const std::string_view kinds = name.substr(kShaclNs.size());
      const std::string_view kind = value.IsIri() ? "IRI" : value.IsBlank() ? "BlankNode" : "Literal";
      if (kinds.find(kind) == std::string_view::npos)
        Report(place, value, Concat("is not of the kind ", Show(wanted)));
    }
  }
}

// 4.2.1 sh:minCount, 4.2.2 sh:maxCount
void Evaluation::CheckCount(const Place& place) {
  const int64_t count = static_cast<int64_t>(place.values.size()), limit = place.constraint.number;
  const bool least = place.constraint.component == Component::kMinCount;
  if (least ? count >= limit : count <= limit) return;
  Report(place, TermId(),
         absl::StrCat("has ", count, count == 1 ? " value" : " values", "; at ", least ? "least " : "most ",
                      limit, least ? " needed" : " allowed"));
}

// 4.3 sh:minExclusive and the other ranges: a value that is not comparable violates
void Evaluation::CheckRange(const Place& place) {
  for (const TermId value : place.values) {
    if (place.sink.done()) return;
    const std::optional<int> order =
        value.IsLiteral() ? Compare(value, place.constraint.value, dictionary_) : std::nullopt;
    bool holds = false;
    std::string_view wanted;
    switch (place.constraint.component) {
      case Component::kMinExclusive:
        holds = order && *order > 0;
        wanted = "greater than ";
        break;
      case Component::kMinInclusive:
        holds = order && *order >= 0;
        wanted = "at least ";
        break;
      case Component::kMaxExclusive:
        holds = order && *order < 0;
        wanted = "less than ";
        break;
      default:
        holds = order && *order <= 0;
        wanted = "at most ";
    }
    if (!holds) Report(place, value, Concat("is not ", wanted, Show(place.constraint.value)));
  }
}

namespace {

// Counts the work and the memory of a regular expression search in the evaluation.
class PatternGuard : public sparql::MatchGuard {
 public:
  PatternGuard(absl::FunctionRef<bool()> poll, absl::FunctionRef<bool(size_t)> charge, size_t* memory)
      : poll_(poll), charge_(charge), memory_(*memory) {}
  bool Worked(size_t) override { return poll_(); }
  bool Charge(size_t bytes) override { return charge_(bytes); }
  void Release(size_t bytes) override { memory_ -= bytes; }

 private:
  absl::FunctionRef<bool()> poll_;
  absl::FunctionRef<bool(size_t)> charge_;
  size_t& memory_;
};

}  // namespace

bool Evaluation::MatchesPattern(TermId value, const Constraint& constraint) {
  if (value.IsBlank()) return false;
  std::unique_ptr<sparql::Regex>& regex = regexes_[&constraint];
  if (regex == nullptr)  // the shape reader has checked it for mistakes
    sparql::Regex::Compile(constraint.pattern.lexical, constraint.flags.lexical, false, &regex);
  if (regex == nullptr) return false;
  const std::string text = dictionary_.Decode(value).lexical;
  const auto poll = [this] { return Poll(); };
  const auto charge = [this](size_t bytes) { return Charge(bytes); };
  PatternGuard guard(poll, charge, &memory_);
  sparql::Regex::Searches searches(regex.get(), text, &guard);
  const absl::StatusOr<bool> found = searches.Find(0, {});
  if (!found.ok() && status_.ok()) status_ = found.status();
  return found.ok() && *found;
}

// 4.4.1 sh:minLength, 4.4.2 sh:maxLength, 4.4.3 sh:pattern, 4.4.4 sh:languageIn
void Evaluation::CheckString(const Place& place) {
  const Constraint& constraint = place.constraint;
  for (const TermId value : place.values) {
    if (!Poll() || place.sink.done()) return;
    if (constraint.component == Component::kLanguageIn) {
      const std::string_view tag = value.IsLiteral() ? dictionary_.Language(value) : std::string_view();
      const bool allowed = !tag.empty() && std::any_of(constraint.languages.begin(),
                                                       constraint.languages.end(), [tag](const Term& range) {
                                                         return LanguageMatches(tag, range.lexical);
                                                       });
      if (!allowed) Report(place, value, "is not in one of the languages that are allowed");
      continue;
    }
    if (constraint.component == Component::kPattern) {
      if (!MatchesPattern(value, constraint) && status_.ok())
        Report(place, value, Concat("does not match the pattern \"", constraint.pattern.lexical, "\""));
      continue;
    }
    const bool least = constraint.component == Component::kMinLength;
    const int64_t length =
        value.IsBlank() ? -1 : static_cast<int64_t>(CodePoints(dictionary_.Decode(value).lexical));
    const bool holds = length >= 0 && (least ? length >= constraint.number : length <= constraint.number);
    if (!holds) {
      Report(place, value,
             absl::StrCat(least ? "is shorter than " : "is longer than ", constraint.number, " characters"));
    }
  }
}

// 4.4.5 sh:uniqueLang: one result for each language of several values
void Evaluation::CheckUniqueLang(const Place& place) {
  std::map<std::string, int> seen;
  for (const TermId value : place.values) {
    if (!value.IsLiteral()) continue;
    const std::string_view tag = dictionary_.Language(value);
    if (!tag.empty()) ++seen[sparql::LowerAscii(tag)];
  }
  for (const auto& [tag, count] : seen) {
    if (count > 1)
      Report(place, TermId(), absl::StrCat("has ", count, " values in the language \"", tag, "\""));
  }
}

// 4.5.1 sh:equals
void Evaluation::CheckEquals(const Place& place) {
  const TermId other = place.constraint.value;
  std::vector<TermId> others;
  if (!place.focus.IsLiteral()) others = data_.Objects(place.focus, other);
  std::sort(others.begin(), others.end());
  const auto has = [](const std::vector<TermId>& in, TermId value) {
    return std::binary_search(in.begin(), in.end(), value);
  };
  for (const TermId value : place.values) {
    if (!Poll()) return;
    if (!has(others, value))
      Report(place, value, Concat("is not a value of ", Show(other), ", which should have the same"));
  }
  for (const TermId value : others) {
    if (!Poll()) return;
    if (!has(place.values, value)) {
      Report(place, value, Concat("is a value of ", Show(other), " alone; the two should have the same"));
    }
  }
}

// 4.5.2 sh:disjoint
void Evaluation::CheckDisjoint(const Place& place) {
  if (place.focus.IsLiteral()) return;
  for (const TermId value : place.values) {
    if (!Poll()) return;
    if (data_.Contains(place.focus, place.constraint.value, value)) {
      Report(place, value,
             Concat("is a value of ", Show(place.constraint.value), ", too; they should share none"));
    }
  }
}

// 4.5.3 sh:lessThan, 4.5.4 sh:lessThanOrEquals: one result for each pair
void Evaluation::CheckLess(const Place& place) {
  const bool strict = place.constraint.component == Component::kLessThan;
  if (place.focus.IsLiteral()) return;
  const std::vector<TermId> others = data_.Objects(place.focus, place.constraint.value);
  for (const TermId value : place.values) {
    for (const TermId other : others) {
      if (!Poll() || place.sink.done()) return;
      std::optional<int> order;
      if (value.IsLiteral() && other.IsLiteral()) order = Compare(value, other, dictionary_);
      if (order && (strict ? *order < 0 : *order <= 0)) continue;
      Report(place, value,
             Concat("is not less than ", strict ? "" : "or equal to ", Show(other), ", the value of ",
                    Show(place.constraint.value)));
    }
  }
}

// 4.6.1 sh:not, 4.6.2 sh:and, 4.6.3 sh:or, 4.6.4 sh:xone
void Evaluation::CheckLogic(const Place& place) {
  const std::vector<ShapeIndex>& shapes = place.constraint.shapes;
  for (const TermId value : place.values) {
    if (place.sink.done()) return;
    size_t conforming = 0;
    for (const ShapeIndex shape : shapes) {
      if (!Poll()) return;
      conforming += Conforms(shape, value) ? 1 : 0;
    }
    switch (place.constraint.component) {
      case Component::kNot:
        if (conforming > 0) Report(place, value, "conforms to the shape that sh:not excludes");
        break;
      case Component::kAnd:
        if (conforming < shapes.size()) {
          Report(place, value,
                 absl::StrCat("conforms to ", conforming, " of the ", shapes.size(), " shapes of sh:and"));
        }
        break;
      case Component::kOr:
        if (conforming == 0)
          Report(place, value, absl::StrCat("conforms to none of the ", shapes.size(), " shapes of sh:or"));
        break;
      default:
        if (conforming != 1) {
          Report(place, value,
                 absl::StrCat("conforms to ", conforming, " of the shapes of sh:xone, not to exactly one"));
        }
    }
  }
}

// 4.7.1 sh:node
void Evaluation::CheckNode(const Place& place) {
  const ShapeIndex inner = place.constraint.shapes[0];
  for (const TermId value : place.values) {
    if (!Poll() || place.sink.done()) return;
    if (Conforms(inner, value)) continue;
    ValidationResult result;
    result.value = value;
    result.has_path = place.shape.is_property;
    if (place.sink.results != nullptr) {
      result.path = place.shape.path;
      Sink details{&result.details};
      Check(shapes_.shapes[inner], value, details);
    }
    Add(place, std::move(result), Concat("does not conform to the shape ", Show(shapes_.shapes[inner].node)));
  }
}

// 4.7.2 sh:property: the results are the property shape's own
void Evaluation::CheckProperty(const Place& place) {
  const Shape& inner = shapes_.shapes[place.constraint.shapes[0]];
  for (const TermId value : place.values) {
    if (!Poll() || place.sink.done()) return;
    Check(inner, value, place.sink);
  }
}

// 4.7.3 sh:qualifiedMinCount, sh:qualifiedMaxCount
void Evaluation::CheckQualified(const Place& place) {
  int64_t count = 0;
  for (const TermId value : place.values) {
    if (!Poll()) return;
    if (!Conforms(place.constraint.shapes[0], value)) continue;
    const auto& siblings = place.constraint.siblings;
    const bool elsewhere = std::any_of(siblings.begin(), siblings.end(),
                                       [&](ShapeIndex sibling) { return Conforms(sibling, value); });
    if (!elsewhere) ++count;
  }
  const bool least = place.constraint.component == Component::kQualifiedMinCount;
  if (least ? count >= place.constraint.number : count <= place.constraint.number) return;
  Report(place, TermId(),
         absl::StrCat("has ", count, count == 1 ? " value that conforms" : " values that conform", " to ",
                      Show(shapes_.shapes[place.constraint.shapes[0]].node), "; at ",
                      least ? "least " : "most ", place.constraint.number, least ? " needed" : " allowed"));
}

// 4.8.1 sh:closed: the path of a result is the property that is not allowed
void Evaluation::CheckClosed(const Place& place) {
  const std::vector<TermId>& allowed = place.constraint.terms;
  for (const TermId node : place.values) {
    if (node.IsLiteral()) continue;
    data_.ForEach(node, TermId(), TermId(), [&](const Quad& q) {
      if (std::binary_search(allowed.begin(), allowed.end(), q.predicate)) return Poll();
      ValidationResult result;
      result.value = q.object;
      result.has_path = true;
      result.path.predicate = q.predicate;
      Add(place, std::move(result),
          Concat("has the property ", Show(q.predicate), ", which this closed shape does not allow"));
      return Poll() && !place.sink.done();
    });
  }
}

// 4.8.2 sh:hasValue, 4.8.3 sh:in
void Evaluation::CheckOthers(const Place& place) {
  if (place.constraint.component == Component::kHasValue) {
    const bool has = std::binary_search(place.values.begin(), place.values.end(), place.constraint.value);
    if (!has) Report(place, TermId(), Concat("does not have the value ", Show(place.constraint.value)));
    return;
  }
  const std::vector<TermId>& members = place.constraint.terms;
  for (const TermId value : place.values) {
    if (place.sink.done()) return;
    if (!std::binary_search(members.begin(), members.end(), value))
      Report(place, value, "is none of the values that sh:in lists");
  }
}

}  // namespace docent::shapes
