#include "reasoner/shapes/file_graph.h"

namespace docent::shapes {

void FileGraph::Add(const std::string& file, const LocatedRdf& document, const std::string& name) {
  const TermId graph = dictionary_.InternIri(name);
  SourceMap& places = places_[name];
  for (size_t i = 0; i < document.rdf.quads.size(); ++i) {
    const TermQuad& q = document.rdf.quads[i];
    const Quad quad{dictionary_.Intern(q.subject), dictionary_.Intern(q.predicate),
                    dictionary_.Intern(q.object), graph};
    writer_.Add(quad);
    const QuadPlace& at = document.places[i];
    places.Add(quad, {file, at.subject}, {file, at.object});
  }
}

GraphView FileGraph::View(const std::string& name) const {
  return GraphView(writer_.current(), {dictionary_.FindIri(name).value_or(kAbsentTerm)});
}

const SourceMap& FileGraph::Places(const std::string& name) const {
  static const SourceMap* none = new SourceMap;
  auto it = places_.find(name);
  return it == places_.end() ? *none : it->second;
}

}  // namespace docent::shapes
