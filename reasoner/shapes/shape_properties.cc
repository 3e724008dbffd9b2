#include "reasoner/shapes/shape_properties.h"

#include "absl/container/btree_set.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "reasoner/shapes/graph_view.h"

namespace docent::shapes {
namespace {

void AddPredicates(const Path& path, absl::btree_set<TermId>* found) {
  if (path.kind == Path::Kind::kPredicate && !path.predicate.IsNone()) found->insert(path.predicate);
  for (const Path& child : path.children) AddPredicates(child, found);
}

}  // namespace

void CollectProperties(const Dictionary& dictionary, ShapeSet* set) {
  absl::btree_set<TermId> found;
  for (const std::string& iri : {std::string(kRdfType), Concat(kRdfsNs, "subClassOf")}) {
    found.insert(dictionary.FindIri(iri).value_or(kAbsentTerm));
  }
  for (const Shape& shape : set->shapes) {
    AddPredicates(shape.path, &found);
    if (!shape.target_queries.empty()) set->any_property = true;
    for (const std::vector<TermId>* targets : {&shape.target_subjects_of, &shape.target_objects_of}) {
      found.insert(targets->begin(), targets->end());
    }
    for (const Constraint& c : shape.constraints) {
      if (c.component >= Component::kEquals && c.component <= Component::kLessThanOrEquals)
        found.insert(c.value);
      if (c.component == Component::kClosed || c.query != nullptr) set->any_property = true;
    }
  }
  found.erase(kAbsentTerm);
  set->properties.assign(found.begin(), found.end());
}

}  // namespace docent::shapes
