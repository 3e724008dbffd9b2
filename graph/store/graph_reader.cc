#include "graph/store/graph_reader.h"

#include <algorithm>

namespace docent {

std::vector<Term> GraphReader::Objects(std::string_view subject, std::string_view predicate) const {
  const std::optional<TermId> id = dictionary_.FindIri(subject);
  return id ? Objects(*id, predicate) : std::vector<Term>();
}

std::vector<Term> GraphReader::Objects(TermId subject, std::string_view predicate) const {
  std::vector<Term> terms;
  const std::optional<TermId> p = dictionary_.FindIri(predicate);
  if (!p) return terms;
  version_.ForEach({subject, *p, {}, {}}, [&](const Quad& quad) {
    terms.push_back(dictionary_.Decode(quad.object));
    return true;
  });
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
  version_.ForEach({{}, *p, *o, {}}, [&](const Quad& quad) {
    iris.push_back(dictionary_.Decode(quad.subject).lexical);
    return true;
  });
  std::sort(iris.begin(), iris.end());
  iris.erase(std::unique(iris.begin(), iris.end()), iris.end());
  return iris;
}

}  // namespace docent
