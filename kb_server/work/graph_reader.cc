#include "kb_server/work/graph_reader.h"

#include <algorithm>

#include "absl/time/time.h"

namespace docent::server {

std::vector<Term> GraphReader::Objects(std::string_view subject, std::string_view predicate) const {
  std::vector<Term> terms;
  auto s = dictionary_.FindIri(subject);
  auto p = dictionary_.FindIri(predicate);
  if (!s || !p) return terms;
  version_.ForEach({*s, *p, {}, {}}, [&](const Quad& quad) {
    terms.push_back(dictionary_.Decode(quad.object));
    return true;
  });
  std::sort(terms.begin(), terms.end());
  terms.erase(std::unique(terms.begin(), terms.end()), terms.end());
  return terms;
}

std::string GraphReader::Object(std::string_view subject, std::string_view predicate) const {
  std::vector<Term> terms = Objects(subject, predicate);
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

int64_t MicrosOfDateTime(const std::string& lexical) {
  absl::Time time;
  if (!absl::ParseTime(absl::RFC3339_full, lexical, &time, nullptr)) return 0;
  return absl::ToUnixMicros(time);
}

}  // namespace docent::server
