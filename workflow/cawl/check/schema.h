// Schema of the ontologies as far as it decides whether a condition can hold: classes above each other, disjoint classes,
// domains and ranges. Asked of an Environment when needed, and remembered. One thread.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_SCHEMA_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_SCHEMA_H_

#include <map>
#include <set>
#include <string>
#include <string_view>

#include "workflow/cawl/check/environment.h"

namespace docent::cawl {

class Schema {
 public:
  // `environment` must outlive it.
  explicit Schema(const Environment& environment) : environment_(environment) {}

  using Iris = std::set<std::string>;

  // The class or property and what is above it: rdfs:subClassOf, owl:equivalentClass, rdfs:subPropertyOf; at most kMaxAbove.
  static constexpr size_t kMaxAbove = 2000;
  const Iris& ClassesAbove(const std::string& cls) const;
  const Iris& PropertiesAbove(const std::string& property) const;
  // Whether nothing can be in both: owl:disjointWith, owl:AllDisjointClasses, of the classes or of those above them.
  bool Disjoint(const std::string& a, const std::string& b) const;

  // Domains and ranges that are IRIs, of the property and of those above it.
  Iris Domains(const std::string& property) const { return OfProperty(property, "domain"); }
  Iris Ranges(const std::string& property) const { return OfProperty(property, "range"); }
  bool IsObjectProperty(const std::string& property) const { return HasType(property, "ObjectProperty"); }
  bool IsDatatypeProperty(const std::string& property) const { return HasType(property, "DatatypeProperty"); }
  // The classes that a resource is told to be in.
  Iris TypesOf(const std::string& resource) const;
  // A datatype, as the range of a property: of xsd:, rdfs:Literal, rdf:langString, or declared as rdfs:Datatype.
  bool IsDatatype(const std::string& iri) const;

 private:
  using Memory = std::map<std::string, Iris>;
  const Iris& Above(const std::string& iri, const std::set<std::string>& predicates, Memory* memory) const;
  const Iris& DisjointWith(const std::string& cls) const;
  Iris OfProperty(const std::string& property, std::string_view what) const;
  bool HasType(const std::string& property, std::string_view type) const;
  void AddGroupMembers(const std::string& cls, Iris* out) const;

  const Environment& environment_;
  mutable Memory classes_above_, properties_above_, disjoint_;
};

// Groups of datatypes whose values never are equal: numbers, texts, truth values, points in time …
enum class ValueFamily { kUnknown, kNumber, kText, kBoolean, kDateTime, kDate, kTime };
ValueFamily FamilyOf(std::string_view datatype);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_SCHEMA_H_
