// The parameters of the constraint components of SHACL Core (section 4), with the values that they may have. Private to this
// folder.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_PARAMETERS_H_
#define DOCENT_REASONER_SHAPES_SHAPE_PARAMETERS_H_

#include <array>
#include <cstdint>

#include "reasoner/shapes/shape.h"

namespace docent::shapes {

// The allowed values of a parameter, and their number.
enum class ValueRule : uint8_t {
  kIri,
  kInteger,
  kLiteral,
  kNodeKind,
  kAny,
  kTrue,
  kString,
  kList,
  kShape,
  kShapes
};
struct Parameter {
  Component component;
  ValueRule values;
  bool single;
  bool property_only;  // not allowed on a node shape (section 4, "scope" of the syntax rules)
};
inline constexpr std::array<Parameter, 27> kParameters = {{
    {Component::kClass, ValueRule::kIri, false, false},
    {Component::kDatatype, ValueRule::kIri, true, false},
    {Component::kNodeKind, ValueRule::kNodeKind, true, false},
    {Component::kMinCount, ValueRule::kInteger, true, true},
    {Component::kMaxCount, ValueRule::kInteger, true, true},
    {Component::kMinExclusive, ValueRule::kLiteral, true, false},
    {Component::kMinInclusive, ValueRule::kLiteral, true, false},
    {Component::kMaxExclusive, ValueRule::kLiteral, true, false},
    {Component::kMaxInclusive, ValueRule::kLiteral, true, false},
    {Component::kMinLength, ValueRule::kInteger, true, false},
    {Component::kMaxLength, ValueRule::kInteger, true, false},
    {Component::kPattern, ValueRule::kString, true, false},
    {Component::kLanguageIn, ValueRule::kList, true, false},
    {Component::kUniqueLang, ValueRule::kTrue, true, true},
    {Component::kEquals, ValueRule::kIri, false, false},
    {Component::kDisjoint, ValueRule::kIri, false, false},
    {Component::kLessThan, ValueRule::kIri, false, true},
    {Component::kLessThanOrEquals, ValueRule::kIri, false, true},
    {Component::kNot, ValueRule::kShape, false, false},
    {Component::kAnd, ValueRule::kShapes, false, false},
    {Component::kOr, ValueRule::kShapes, false, false},
    {Component::kXone, ValueRule::kShapes, false, false},
    {Component::kNode, ValueRule::kShape, false, false},
    {Component::kProperty, ValueRule::kShape, false, false},
    {Component::kClosed, ValueRule::kTrue, true, false},
    {Component::kHasValue, ValueRule::kAny, false, false},
    {Component::kIn, ValueRule::kList, true, false},
}};

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_PARAMETERS_H_
