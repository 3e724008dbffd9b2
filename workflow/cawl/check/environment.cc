#include "workflow/cawl/check/environment.h"

#include <algorithm>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::cawl {
namespace {

std::vector<std::string> BeginningWith(const std::set<std::string, std::less<>>& iris,
                                       std::string_view space) {
  std::vector<std::string> out;
  for (auto it = iris.lower_bound(space); it != iris.end() && it->starts_with(space); ++it)
    out.push_back(*it);
  return out;
}

bool IsOneOf(const std::vector<std::string>& types, std::string_view type) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

template <typename Facts>
std::vector<Term> FirstOf(const Facts& facts, const Term& term, std::string_view predicate) {
  const auto found = facts.find({term, std::string(predicate)});
  if (found == facts.end()) return {};
  const size_t count = std::min(found->second.size(), Environment::kMaxFacts);
  return {found->second.begin(), found->second.begin() + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace

const std::vector<std::string>& ClassTypes() {
  static const auto* const types =
      new std::vector<std::string>{Concat(kRdfsNs, "Class"), Concat(kOwlNs, "Class")};
  return *types;
}

const std::vector<std::string>& PropertyTypes() {
  static const auto* const types =
      new std::vector<std::string>{Concat(kRdfNs, "Property"),           Concat(kOwlNs, "ObjectProperty"),
                                   Concat(kOwlNs, "DatatypeProperty"),   Concat(kOwlNs, "AnnotationProperty"),
                                   Concat(kOwlNs, "FunctionalProperty"), Concat(kDocentNs, "StateProperty")};
  return *types;
}

void QuadEnvironment::AddOntology(const std::vector<TermQuad>& quads) {
  static const std::string sub_class = Concat(kRdfsNs, "subClassOf");
  static const std::string sub_property = Concat(kRdfsNs, "subPropertyOf");
  for (const TermQuad& q : quads) {
    objects_[{q.subject, q.predicate.lexical}].push_back(q.object);
    subjects_[{q.object, q.predicate.lexical}].push_back(q.subject);
    if (!q.subject.IsIri()) continue;
    known_.insert(q.subject.lexical);
    const std::string& predicate = q.predicate.lexical;
    const bool to_iri = q.object.IsIri();
    if (predicate == kRdfType && to_iri) {
      if (IsOneOf(ClassTypes(), q.object.lexical)) classes_.insert(q.subject.lexical);
      if (IsOneOf(PropertyTypes(), q.object.lexical)) properties_.insert(q.subject.lexical);
    } else if (predicate == sub_class) {
      classes_.insert(q.subject.lexical);
      if (to_iri) classes_.insert(q.object.lexical);
    } else if (predicate == sub_property) {
      properties_.insert(q.subject.lexical);
      if (to_iri) properties_.insert(q.object.lexical);
    }
  }
}

void QuadEnvironment::AddOperation(OperationSignature operation) {
  std::string name = operation.name;
  operations_.emplace(std::move(name), std::move(operation));
}

void QuadEnvironment::AddApplicationService(std::string name) {
  services_.insert(std::move(name));
}

void QuadEnvironment::AddCapability(std::string iri) {
  if (!capabilities_) capabilities_.emplace();
  capabilities_->push_back(std::move(iri));
}

std::optional<OperationSignature> QuadEnvironment::FindOperation(std::string_view name) const {
  auto it = operations_.find(name);
  if (it == operations_.end()) return std::nullopt;
  return it->second;
}

std::vector<std::string> QuadEnvironment::OperationNames() const {
  std::vector<std::string> out;
  for (const auto& [name, unused] : operations_) out.push_back(name);
  return out;
}

std::vector<std::string> QuadEnvironment::ApplicationServices() const {
  return {services_.begin(), services_.end()};
}

bool QuadEnvironment::IsClass(const std::string& iri) const {
  return classes_.contains(iri);
}
bool QuadEnvironment::IsProperty(const std::string& iri) const {
  return properties_.contains(iri);
}
bool QuadEnvironment::IsKnown(const std::string& iri) const {
  return known_.contains(iri) || classes_.contains(iri) || properties_.contains(iri);
}

std::vector<std::string> QuadEnvironment::Classes(std::string_view namespace_iri) const {
  return BeginningWith(classes_, namespace_iri);
}
std::vector<std::string> QuadEnvironment::Properties(std::string_view namespace_iri) const {
  return BeginningWith(properties_, namespace_iri);
}
std::vector<Term> QuadEnvironment::Objects(const Term& subject, std::string_view predicate) const {
  return FirstOf(objects_, subject, predicate);
}
std::vector<Term> QuadEnvironment::Subjects(std::string_view predicate, const Term& object) const {
  return FirstOf(subjects_, object, predicate);
}
std::vector<std::string> QuadEnvironment::Words(std::string_view namespace_iri) const {
  return BeginningWith(known_, namespace_iri);
}

}  // namespace docent::cawl
