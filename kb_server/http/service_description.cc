#include "kb_server/http/service_description.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/serializer.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/http/http_formats.h"
#include "kb_server/work/remote_access.h"

namespace docent::server {
namespace {

constexpr std::string_view kSd = "http://www.w3.org/ns/sparql-service-description#";
constexpr std::string_view kVoid = "http://rdfs.org/ns/void#";
constexpr std::string_view kFormats = "http://www.w3.org/ns/formats/";

class Description {
 public:
  Term Sd(std::string_view name) const { return Term::Iri(Concat(kSd, name)); }
  void Say(const Term& subject, std::string_view property, Term object) {
    quads.push_back({subject, Term::Iri(Concat(kSd, property)), std::move(object), Term{}});
  }
  void Type(const Term& subject, std::string_view type) {
    quads.push_back({subject, Term::Iri(std::string(kRdfType)), Sd(type), Term{}});
  }
  // A graph of so many triples as the value of `property`.
  void Graph(const Term& subject, std::string_view property, uint64_t triples) {
    const Term graph = Term::Blank(absl::StrCat("graph", ++graphs_));
    Say(subject, property, graph);
    Type(graph, "Graph");
    quads.push_back(
        {graph, Term::Iri(Concat(kVoid, "triples")), Term::Integer(static_cast<int64_t>(triples)), Term{}});
  }
  std::vector<TermQuad> quads;

 private:
  int graphs_ = 0;
};

std::vector<TermQuad> Describe(const ReadPorts& ports, const std::string& address) {
  Description d;
  const Term service = Term::Blank("service"), dataset = Term::Blank("dataset");
  const bool is_union = ports.default_graph == sparql::DefaultGraph::kUnion;
  d.Type(service, "Service");
  d.Say(service, "endpoint", Term::Iri(address));
  d.Say(service, "supportedLanguage", d.Sd("SPARQL11Query"));
  d.Say(service, "supportedLanguage", d.Sd("SPARQL11Update"));
  if (ports.remote != nullptr && ports.remote->allows_any())
    d.Say(service, "feature", d.Sd("BasicFederatedQuery"));
  if (is_union) d.Say(service, "feature", d.Sd("UnionDefaultGraph"));
  for (const std::string_view format :
       {"SPARQL_Results_JSON", "SPARQL_Results_XML", "SPARQL_Results_CSV", "SPARQL_Results_TSV", "Turtle",
        "N-Triples", "RDF_XML", "TriG", "N-Quads"}) {
    d.Say(service, "resultFormat", Term::Iri(Concat(kFormats, format)));
  }
  for (const std::string_view format : {"Turtle", "N-Triples", "RDF_XML", "TriG", "N-Quads"}) {
    d.Say(service, "inputFormat", Term::Iri(Concat(kFormats, format)));
  }
  if (ports.functions != nullptr) {
    for (const std::string& function : ports.functions->Names()) {
      d.Say(service, "extensionFunction", Term::Iri(function));
      d.Type(Term::Iri(function), "Function");
    }
  }
  d.Say(service, "defaultDataset", dataset);
  d.Type(dataset, "Dataset");
  const GraphVersionPtr version = ports.queries->Newest();
  const std::optional<TermId> default_graph = ports.dictionary->FindIri(kDefaultGraph);
  d.Graph(dataset, "defaultGraph",
          is_union        ? version->size()
          : default_graph ? version->Count({{}, {}, {}, *default_graph})
                          : 0);
  int number = 0;
  for (const TermId graph : version->graphs()) {
    if (!is_union && default_graph == graph) continue;
    const Term named = Term::Blank(absl::StrCat("named", ++number));
    d.Say(dataset, "namedGraph", named);
    d.Type(named, "NamedGraph");
    d.Say(named, "name", ports.dictionary->Decode(graph));
    d.Graph(named, "graph", version->Count({{}, {}, {}, graph}));
  }
  return std::move(d.quads);
}

}  // namespace

HttpResponse DescribeService(const ReadPorts& ports, const std::string& address, std::string_view accept) {
  const GraphType* type = ChooseGraphType(accept);
  if (type == nullptr) return NoGraphType();
  absl::StatusOr<std::string> text = SerializeRdf(
      Describe(ports, address), type->format,
      {{"sd", std::string(kSd)}, {"void", std::string(kVoid)}, {"format", std::string(kFormats)}});
  if (!text.ok()) return ErrorResponse(text.status());
  HttpResponse response;
  response.content_type = type->told;
  response.headers = {{"Vary", "Accept"}};
  response.body = *std::move(text);
  return response;
}

}  // namespace docent::server
