#include "kb_server/service/graph_environment.h"

#include <string>
#include <vector>

#include "kb_server/rdf/vocabulary.h"

namespace docent {
namespace {

// The quads that say what a word is: types and the class and property hierarchies.
std::vector<TermQuad> WordQuads(const Dictionary& dictionary, const GraphVersion& version) {
  std::vector<TermQuad> quads;
  const std::string predicates[] = {std::string(kRdfType), std::string(kRdfsNs) + "subClassOf",
                                    std::string(kRdfsNs) + "subPropertyOf", std::string(kRdfsNs) + "label"};
  for (const std::string& predicate : predicates) {
    auto id = dictionary.FindIri(predicate);
    if (!id) continue;
    version.ForEach({{}, *id, {}, {}}, [&](const Quad& quad) {
      quads.push_back({dictionary.Decode(quad.subject), Term::Iri(predicate), dictionary.Decode(quad.object), Term()});
      return true;
    });
  }
  return quads;
}

}  // namespace

std::unique_ptr<cawl::Environment> GraphEnvironment(const Dictionary& dictionary, const GraphVersion& version,
                                                    const Catalog* catalog) {
  auto environment = std::make_unique<cawl::QuadEnvironment>();
  environment->AddOntology(WordQuads(dictionary, version));
  for (const rsel::PlanPtr& plan : catalog->services.Plans()) {
    environment->AddOperation({plan->process, plan->inputs, true});
  }
  if (auto offers = dictionary.FindIri(DocentIri("offers"))) {
    constexpr std::string_view kPrefix = "urn:docent:operation:";
    version.ForEach({{}, *offers, {}, {}}, [&](const Quad& quad) {
      std::string iri = dictionary.Decode(quad.object).lexical;
      if (iri.rfind(kPrefix, 0) == 0) environment->AddOperation({iri.substr(kPrefix.size()), {}, false});
      return true;
    });
  }
  for (const auto& [document, revision] : catalog->workflows) {
    environment->AddApplicationService(document->name.value);
  }
  return environment;
}

}  // namespace docent
