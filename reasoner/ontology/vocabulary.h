// Vocabulary of a set of documents: classes, properties, their hierarchies, described resources. It reads
// asserted triples and infers nothing except along rdfs:subClassOf, rdfs:subPropertyOf and
// owl:equivalentClass. One thread (it caches closures).
#ifndef DOCENT_REASONER_ONTOLOGY_VOCABULARY_H_
#define DOCENT_REASONER_ONTOLOGY_VOCABULARY_H_

#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/rdf/term.h"

namespace docent::ontology {

using Words = std::set<std::string, std::less<>>;

// The common part of the IRIs of one vocabulary: up to the last '#', '/' or ':'.
std::string_view NamespaceOf(std::string_view iri);

struct PropertyFacts {
  bool object = false, data = false, annotation = false;  // owl:ObjectProperty …
  Words domains, ranges;                                  // IRIs only
};

class Vocabulary {
 public:
  Vocabulary();

  void Add(const std::vector<TermQuad>& quads);

  bool IsClass(std::string_view iri) const { return classes_.contains(iri); }
  bool IsDatatype(std::string_view iri) const;
  bool IsProperty(std::string_view iri) const { return properties_.contains(iri); }
  // Described, or named by an axiom as an individual (owl:oneOf, owl:hasValue …).
  bool IsKnown(std::string_view iri) const { return known_.contains(iri); }
  // Null if it is no property.
  const PropertyFacts* Property(std::string_view iri) const;
  // True if undeclared words of this namespace are mistakes: it has a declared class or property, or is one
  // of rdf:, rdfs:, owl:, xsd:.
  bool Covers(std::string_view name_space) const { return covered_.contains(name_space); }
  const Words& covered() const { return covered_; }
  bool HasLabel(std::string_view iri) const { return labelled_.contains(iri); }
  // rdfs:comment, skos:definition, dcterms:description, or rdfs:isDefinedBy (it is explained elsewhere).
  bool HasComment(std::string_view iri) const { return explained_.contains(iri); }

  // The IRI or version IRI of an owl:Ontology that a document declares.
  bool HasOntology(std::string_view iri) const { return ontologies_.contains(iri); }

  // The explicit types of a resource.
  const Words& TypesOf(std::string_view iri) const;
  // The class and its superclasses, the nearest first; at most 2000.
  std::shared_ptr<const Words> ClassesAbove(const std::string& cls) const;
  // A pair of disjoint classes, one above (or equal to) `a`, one above `b`; empty if there is none.
  std::pair<std::string, std::string> Disjoint(const std::string& a, const std::string& b) const;
  // Likewise, both above (or among) `classes`.
  std::pair<std::string, std::string> DisjointAmong(const Words& classes) const;

  // "a rdfs:subClassOf b" and "p rdfs:subPropertyOf q", between IRIs.
  const std::map<std::string, Words, std::less<>>& super_classes() const { return super_classes_; }
  const std::map<std::string, Words, std::less<>>& super_properties() const { return super_properties_; }

  enum class Kind { kClass, kProperty, kAny };
  // The most similar known word of this namespace and kind, by its local name; or empty.
  std::string NearestWord(std::string_view iri, Kind kind) const;

 private:
  void AddType(const std::string& subject, const std::string& type);
  void AddPropertyFact(const TermQuad& quad);
  void AddAxioms(const std::vector<TermQuad>& quads);

  Words classes_, properties_, datatypes_, known_, covered_, labelled_, explained_, ontologies_;
  std::map<std::string, PropertyFacts, std::less<>> facts_;
  std::map<std::string, Words, std::less<>> types_, super_classes_, super_properties_, equivalent_;
  std::map<std::string, Words, std::less<>> disjoint_;
  mutable std::map<std::string, std::shared_ptr<const Words>> above_;  // cache, by class
  mutable size_t above_size_ = 0;                                      // words in all of them
};

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_VOCABULARY_H_
