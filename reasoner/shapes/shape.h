// SHACL shapes (W3C Recommendation 20 July 2017, sections 2 to 6) after reading and checking: output of the
// shape reader and input of the validator. Values; any thread.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_H_
#define DOCENT_REASONER_SHAPES_SHAPE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/rdf/term.h"
#include "graph/rdf/term_id.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/store/quad.h"

namespace docent::shapes {

inline constexpr std::string_view kShaclNs = "http://www.w3.org/ns/shacl#";
inline std::string Shacl(std::string_view local) {
  return std::string(kShaclNs) + std::string(local);
}

// A property path (section 2.3.1).
struct Path {
  enum class Kind : uint8_t {
    kPredicate,    // ex:p                         predicate
    kInverse,      // [ sh:inversePath ex:p ]      children[0]
    kSequence,     // ( ex:p ex:q )                children, two or more
    kAlternative,  // [ sh:alternativePath ( … ) ] children, two or more
    kZeroOrMore,   // [ sh:zeroOrMorePath ex:p ]   children[0]
    kOneOrMore,    // [ sh:oneOrMorePath ex:p ]    children[0]
    kZeroOrOne,    // [ sh:zeroOrOnePath ex:p ]    children[0]
  };
  Kind kind = Kind::kPredicate;
  TermId predicate;
  std::vector<Path> children;
};

// The constraint components of section 4, in its order; and those with queries as constraints.
enum class Component : uint8_t {
  kClass,
  kDatatype,
  kNodeKind,
  kMinCount,
  kMaxCount,
  kMinExclusive,
  kMinInclusive,
  kMaxExclusive,
  kMaxInclusive,
  kMinLength,
  kMaxLength,
  kPattern,
  kLanguageIn,
  kUniqueLang,
  kEquals,
  kDisjoint,
  kLessThan,
  kLessThanOrEquals,
  kNot,
  kAnd,
  kOr,
  kXone,
  kNode,
  kProperty,
  kQualifiedMinCount,
  kQualifiedMaxCount,
  kClosed,
  kHasValue,
  kIn,
  kSparql,  // sh:sparql (section 5)
  kOwn,     // declared in the shapes graph (section 6)
};
// "MinCount" of sh:MinCountConstraintComponent, "minCount" of the parameter sh:minCount.
// Of kOwn: "".
std::string_view ComponentName(Component component);
std::string ParameterName(Component component);
inline std::string ComponentIri(Component component) {
  return Shacl(std::string(ComponentName(component)) + "ConstraintComponent");
}

using ShapeIndex = uint32_t;

// A query of a shape, with the shape's path in place of $PATH.
struct ShapeQuery {
  sparql::Query query;                 // SELECT, or ASK of each value node
  std::vector<std::string> variables;  // all variables in it
  // Parameters by variable name, with their values at the shape.
  std::vector<std::pair<std::string, TermId>> parameters;
  std::vector<TermId> messages;            // of the constraint or validator, with {?variables}
  std::vector<TermId> component_messages;  // of the component
  TermId node;                             // the constraint, validator or target
  TermId component;                        // of kOwn
  bool is_target = false;
};
using ShapeQueryPtr = std::shared_ptr<const ShapeQuery>;

// One constraint of a shape; which fields it uses depends on the component.
struct Constraint {
  Component component = Component::kClass;
  TermId value;                    // class, datatype, nodeKind, ranges, property pairs, hasValue
  int64_t number = 0;              // counts and lengths
  Term pattern, flags;             // kPattern
  std::vector<Term> languages;     // kLanguageIn
  std::vector<TermId> terms;       // kIn: the members; kClosed: the properties that are allowed
  std::vector<ShapeIndex> shapes;  // kNot, kAnd, kOr, kXone, kNode, kProperty, kQualified…: the named shapes
  std::vector<ShapeIndex> siblings;  // kQualified… with sh:qualifiedValueShapesDisjoint
  ShapeQueryPtr query;               // kSparql, kOwn
};

struct Shape {
  TermId node;  // its name in the shapes graph
  bool is_property = false;
  Path path;              // of a property shape
  bool has_path = false;  // it is well-formed
  std::vector<Constraint> constraints;
  TermId severity;               // sh:Violation if none is given
  std::vector<TermId> messages;  // sh:message
  bool deactivated = false;

  // targets (section 2.1.3)
  std::vector<TermId> target_nodes;
  std::vector<TermId> target_classes;  // sh:targetClass, and the shape itself if it is a class
  std::vector<TermId> target_subjects_of;
  std::vector<TermId> target_objects_of;
  std::vector<ShapeQueryPtr>
      target_queries;  // SHACL Advanced Features, section 3: sh:SPARQLTarget and target types
  bool HasTargets() const {
    return !target_nodes.empty() || !target_classes.empty() || !target_subjects_of.empty() ||
           !target_objects_of.empty() || !target_queries.empty();
  }
};

// The shapes of a shapes graph that have targets, and all shapes that they refer to. No shape refers to
// itself, directly or through others.
struct ShapeSet {
  std::vector<Shape> shapes;  // by ShapeIndex
  TermId shapes_graph;        // its name, for $shapesGraph; kNone: it is several graphs, or without a name
  std::vector<Quad> triples;  // of the shapes graph without a name, if a query asks for $shapesGraph
  // The properties whose triples can matter for a validation; `any_property`: all properties (a closed shape,
  // a query).
  std::vector<TermId> properties;
  bool any_property = false;

  bool HasTargets() const {
    for (const Shape& shape : shapes) {
      if (shape.HasTargets() && !shape.deactivated) return true;
    }
    return false;
  }
};

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_H_
