#include "kb_server/robots/capability_classes.h"

#include <optional>
#include <vector>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::server {

std::set<TermId> ClassesAbove(const Dictionary& dictionary, const GraphVersion& version, TermId iri) {
  const std::optional<TermId> above = dictionary.FindIri(Concat(kRdfsNs, "subClassOf")),
                              same = dictionary.FindIri(Concat(kOwlNs, "equivalentClass"));
  std::set<TermId> seen = {iri};
  std::vector<TermId> next = {iri};
  const auto reach = [&](TermId found) {
    if (found.IsIri() && seen.insert(found).second) next.push_back(found);
    return true;
  };
  while (!next.empty()) {
    const TermId at = next.back();
    next.pop_back();
    if (above) version.ForEach({at, *above, {}, {}}, [&](const Quad& quad) { return reach(quad.object); });
    if (!same) continue;
    version.ForEach({at, *same, {}, {}}, [&](const Quad& quad) { return reach(quad.object); });
    version.ForEach({{}, *same, at, {}}, [&](const Quad& quad) { return reach(quad.subject); });
  }
  return seen;
}

bool IsCapable(const GraphReader& graph, const std::string& robot, const std::string& iri) {
  const std::string above = Concat(kRdfsNs, "subClassOf"), same = Concat(kOwlNs, "equivalentClass");
  std::set<std::string> seen;
  std::vector<std::string> next;
  const auto reach = [&](const std::string& found) {
    if (seen.insert(found).second) next.push_back(found);
  };
  for (const Term& told : graph.Objects(robot, DocentIri("hasCapability"))) reach(told.lexical);
  while (!next.empty() && !seen.contains(iri)) {
    const std::string at = next.back();
    next.pop_back();
    for (const std::string& property : {above, same}) {
      for (const Term& found : graph.Objects(at, property)) {
        if (found.IsIri()) reach(found.lexical);
      }
    }
    for (const std::string& found : graph.Subjects(same, Term::Iri(at))) reach(found);
  }
  return seen.contains(iri);
}

}  // namespace docent::server
