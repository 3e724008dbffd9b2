#include "graph/store/graph_reader.h"

#include <algorithm>

namespace docent {

GraphReader GraphReader::In(std::string_view graph) const {
  GraphReader reader = *this;
  reader.in_one_ = true;
  reader.graph_ = dictionary_.FindIri(graph);
  return reader;
}

template <typename Each>
void GraphReader::ForEach(QuadPattern pattern, const Each& each) const {
  if (in_one_ && !graph_) return;
  if (in_one_) pattern.graph = *graph_;
  version_.ForEach(pattern, [&each](const Quad& quad) {
    each(quad);
    return true;
  });
}

std::vector<Term> GraphReader::Objects(std::string_view subject, std::string_view predicate) const {
  const std::optional<TermId> id = dictionary_.FindIri(subject);
  return id ? Objects(*id, predicate) : std::vector<Term>();
}

std::vector<Term> GraphReader::Objects(TermId subject, std::string_view predicate) const {
  std::vector<Term> terms;
  const std::optional<TermId> p = dictionary_.FindIri(predicate);
  if (!p) return terms;
  ForEach({subject, *p, {}, {}}, [&](const Quad& quad) { terms.push_back(dictionary_.Decode(quad.object)); });
  std::sort(terms.begin(), terms.end());
  terms.erase(std::unique(terms.begin(), terms.end()), terms.end());
  return terms;
}

std::string GraphReader::Object(std::string_view subject, std::string_view predicate) const {
  const std::optional<TermId> id = dictionary_.FindIri(subject);
  return id ? Object(*id, predicate) : "";
}

std::string GraphReader::Object(TermId subject, std::string_view predicate) const {
  const std::vector<Term> terms = Objects(subject, predicate);
  return terms.empty() ? "" : terms.front().lexical;
}

std::vector<std::string> GraphReader::Subjects(std::string_view predicate, const Term& object) const {
  std::vector<std::string> iris;
  auto p = dictionary_.FindIri(predicate);
  auto o = dictionary_.Find(object);
  if (!p || !o) return iris;
  ForEach({{}, *p, *o, {}},
          [&](const Quad& quad) { iris.push_back(dictionary_.Decode(quad.subject).lexical); });
  std::sort(iris.begin(), iris.end());
  iris.erase(std::unique(iris.begin(), iris.end()), iris.end());
  return iris;
}

}  // namespace docent
