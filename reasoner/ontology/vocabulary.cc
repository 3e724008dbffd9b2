#include "reasoner/ontology/vocabulary.h"

#include <deque>

#include "graph/base/diagnostic.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "reasoner/ontology/standard_words.h"

namespace docent::ontology {
namespace {

constexpr std::string_view kSkosNs = "http://www.w3.org/2004/02/skos/core#";
constexpr std::string_view kTermsNs = "http://purl.org/dc/terms/";

// "owl:Class" for its IRI, in the namespaces that decide the kind of a word.
std::string Short(std::string_view iri) {
  for (const auto& [prefix, name_space] : {std::pair<std::string_view, std::string_view>{"rdf:", kRdfNs},
                                           {"rdfs:", kRdfsNs},
                                           {"owl:", kOwlNs}}) {
    if (iri.starts_with(name_space)) return Concat(prefix, iri.substr(name_space.size()));
  }
  return "";
}

bool IsPropertyType(std::string_view type) {
  static const Words* types = new Words{"rdf:Property",
                                        "owl:ObjectProperty",
                                        "owl:DatatypeProperty",
                                        "owl:AnnotationProperty",
                                        "owl:OntologyProperty",
                                        "owl:FunctionalProperty",
                                        "owl:InverseFunctionalProperty",
                                        "owl:TransitiveProperty",
                                        "owl:SymmetricProperty",
                                        "owl:AsymmetricProperty",
                                        "owl:ReflexiveProperty",
                                        "owl:IrreflexiveProperty"};
  return types->contains(type);
}

bool NamesIndividual(std::string_view property) {
  return property == "owl:hasValue" || property == "owl:sameAs" || property == "owl:differentFrom" ||
         property == "owl:sourceIndividual" || property == "owl:targetIndividual";
}

// The rdf:Lists of a document, made of blank nodes.
class Lists {
 public:
  explicit Lists(const std::vector<TermQuad>& quads) {
    const std::string first = Concat(kRdfNs, "first"), rest = Concat(kRdfNs, "rest");
    for (const TermQuad& q : quads) {
      if (!q.subject.IsBlank()) continue;
      if (q.predicate.lexical == first) cells_[q.subject.lexical].first = &q.object;
      if (q.predicate.lexical == rest) cells_[q.subject.lexical].second = &q.object;
    }
  }
  // The members that are IRIs.
  Words Iris(const Term& list) const {
    Words iris;
    const Term* at = &list;
    for (size_t steps = 0; steps <= cells_.size() && at != nullptr && at->IsBlank(); ++steps) {
      const auto cell = cells_.find(at->lexical);
      if (cell == cells_.end()) break;
      const auto& [first, rest] = cell->second;
      if (first != nullptr && first->IsIri()) iris.insert(first->lexical);
      at = rest;
    }
    return iris;
  }

 private:
  std::map<std::string_view, std::pair<const Term*, const Term*>>
      cells_;  // first and rest, in the document's quads
};

}  // namespace

std::string_view NamespaceOf(std::string_view iri) {
  const size_t end = iri.find_last_of("#/:");
  return end == std::string_view::npos ? std::string_view() : iri.substr(0, end + 1);
}

Vocabulary::Vocabulary() {
  for (const StandardWord& word : StandardWords()) {
    const std::string iri = Concat(word.name_space, word.local);
    known_.insert(iri);
    labelled_.insert(iri);
    explained_.insert(iri);
    covered_.insert(std::string(word.name_space));
    if (word.kind == StandardKind::kClass) classes_.insert(iri);
    if (word.kind == StandardKind::kDatatype) datatypes_.insert(iri);
    if (word.kind == StandardKind::kProperty) properties_.insert(iri);
  }
}

void Vocabulary::AddType(const std::string& subject, const std::string& type) {
  types_[subject].insert(type);
  const std::string name = Short(type);
  if (name == "owl:Class" || name == "rdfs:Class") {
    classes_.insert(subject);
    covered_.insert(std::string(NamespaceOf(subject)));
  } else if (name == "owl:Ontology") {
    ontologies_.insert(subject);
  } else if (name == "rdfs:Datatype") {
    datatypes_.insert(subject);
  } else if (IsPropertyType(name) || type == DocentIri("StateProperty")) {
    properties_.insert(subject);
    covered_.insert(std::string(NamespaceOf(subject)));
    PropertyFacts& facts = facts_[subject];
    facts.object = facts.object || name == "owl:ObjectProperty";
    facts.data = facts.data || name == "owl:DatatypeProperty";
    facts.annotation = facts.annotation || name == "owl:AnnotationProperty";
  }
}

void Vocabulary::AddPropertyFact(const TermQuad& quad) {
  const std::string& subject = quad.subject.lexical;
  const std::string name = Short(quad.predicate.lexical);
  const bool to_iri = quad.object.IsIri();
  const std::string& object = quad.object.lexical;
  if (name == "rdfs:label" || quad.predicate.lexical == Concat(kSkosNs, "prefLabel")) {
    labelled_.insert(subject);
  } else if (name == "rdfs:comment" || name == "rdfs:isDefinedBy" ||
             quad.predicate.lexical == Concat(kSkosNs, "definition") ||
             quad.predicate.lexical == Concat(kTermsNs, "description")) {
    explained_.insert(subject);
  } else if (!to_iri) {
    if (name == "rdfs:subClassOf" || name == "owl:equivalentClass") classes_.insert(subject);
  } else if (name == "rdf:type") {
    AddType(subject, object);
  } else if (name == "rdfs:subClassOf") {
    super_classes_[subject].insert(object);
    classes_.insert(subject);
  } else if (name == "owl:equivalentClass") {
    equivalent_[subject].insert(object);
    equivalent_[object].insert(subject);
    classes_.insert(subject);
  } else if (name == "rdfs:subPropertyOf") {
    super_properties_[subject].insert(object);
    properties_.insert(subject);
  } else if (name == "rdfs:domain") {
    facts_[subject].domains.insert(object);
  } else if (name == "rdfs:range") {
    facts_[subject].ranges.insert(object);
  } else if (name == "owl:versionIRI") {
    ontologies_.insert(object);
  } else if (name == "owl:disjointWith" || name == "owl:complementOf") {
    disjoint_[subject].insert(object);
    disjoint_[object].insert(subject);
  }
}

// Axioms about several words: owl:AllDisjointClasses, and axioms that name individuals, for which OWL 2
// requires no declaration.
void Vocabulary::AddAxioms(const std::vector<TermQuad>& quads) {
  const Lists lists(quads);
  std::map<std::string, std::string> types;  // of the blank nodes of AllDisjointClasses and AllDifferent
  for (const TermQuad& q : quads) {
    if (q.subject.IsBlank() && q.predicate.lexical == kRdfType)
      types[q.subject.lexical] = Short(q.object.lexical);
  }
  for (const TermQuad& q : quads) {
    const std::string name = Short(q.predicate.lexical);
    if (name == "owl:oneOf" || name == "owl:distinctMembers" ||
        (name == "owl:members" && types[q.subject.lexical] == "owl:AllDifferent")) {
      known_.merge(lists.Iris(q.object));
    } else if (name == "owl:members" && types[q.subject.lexical] == "owl:AllDisjointClasses") {
      const Words classes = lists.Iris(q.object);
      for (const std::string& cls : classes) {
        disjoint_[cls].insert(classes.begin(), classes.end());
        disjoint_[cls].erase(cls);
      }
    } else if (q.object.IsIri() && NamesIndividual(name)) {
      known_.insert(q.object.lexical);
    }
  }
}

void Vocabulary::Add(const std::vector<TermQuad>& quads) {
  above_.clear();
  above_size_ = 0;
  for (const TermQuad& q : quads) {
    if (!q.subject.IsIri()) continue;
    known_.insert(q.subject.lexical);
    AddPropertyFact(q);
  }
  AddAxioms(quads);
}

bool Vocabulary::IsDatatype(std::string_view iri) const {
  return datatypes_.contains(iri);
}

const PropertyFacts* Vocabulary::Property(std::string_view iri) const {
  auto it = facts_.find(iri);
  return it == facts_.end() ? nullptr : &it->second;
}

const Words& Vocabulary::TypesOf(std::string_view iri) const {
  static const Words* none = new Words;
  auto it = types_.find(iri);
  return it == types_.end() ? *none : it->second;
}

std::shared_ptr<const Words> Vocabulary::ClassesAbove(const std::string& cls) const {
  constexpr size_t kMostAbove = 2000, kMostKept = 1'000'000;
  if (auto it = above_.find(cls); it != above_.end()) return it->second;
  auto above = std::make_shared<Words>();
  std::deque<std::string> open = {cls};
  above->insert(cls);
  while (!open.empty() && above->size() < kMostAbove) {
    const std::string at = std::move(open.front());
    open.pop_front();
    for (const auto* edges : {&super_classes_, &equivalent_}) {
      auto next = edges->find(at);
      if (next == edges->end()) continue;
      for (const std::string& super : next->second) {
        if (above->insert(super).second) open.push_back(super);
      }
    }
  }
  above_size_ += above->size();
  if (above_size_ > kMostKept) {
    above_.clear();
    above_size_ = above->size();
  }
  above_[cls] = above;
  return above;
}

std::pair<std::string, std::string> Vocabulary::Disjoint(const std::string& a, const std::string& b) const {
  if (disjoint_.empty()) return {};
  const std::shared_ptr<const Words> of_a = ClassesAbove(a), of_b = ClassesAbove(b);
  for (const std::string& one : *of_a) {
    auto it = disjoint_.find(one);
    if (it == disjoint_.end()) continue;
    for (const std::string& other : it->second) {
      if (of_b->contains(other)) return {one, other};
    }
  }
  return {};
}

std::pair<std::string, std::string> Vocabulary::DisjointAmong(const Words& classes) const {
  if (disjoint_.empty()) return {};
  Words all;
  for (const std::string& cls : classes) {
    const std::shared_ptr<const Words> above = ClassesAbove(cls);
    all.insert(above->begin(), above->end());
  }
  for (const std::string& one : all) {
    auto it = disjoint_.find(one);
    if (it == disjoint_.end()) continue;
    for (const std::string& other : it->second) {
      if (all.contains(other)) return {one, other};
    }
  }
  return {};
}

std::string Vocabulary::NearestWord(std::string_view iri, Kind kind) const {
  const std::string_view name_space = NamespaceOf(iri);
  const Words& words = kind == Kind::kClass ? classes_ : kind == Kind::kProperty ? properties_ : known_;
  std::vector<std::string> locals;
  for (auto it = words.lower_bound(name_space); it != words.end() && it->starts_with(name_space); ++it) {
    std::string local = it->substr(name_space.size());
    if (!local.empty() && *it != iri) locals.push_back(std::move(local));
  }
  const std::string nearest = Nearest(iri.substr(name_space.size()), locals);
  return nearest.empty() ? "" : Concat(name_space, nearest);
}

}  // namespace docent::ontology
