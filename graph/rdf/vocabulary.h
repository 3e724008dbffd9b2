// IRI constants, grouped by the standard or ontology module that defines them.
#ifndef DOCENT_GRAPH_RDF_VOCABULARY_H_
#define DOCENT_GRAPH_RDF_VOCABULARY_H_

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace docent {

// namespaces; a constant below is `namespace + local name`
inline constexpr std::string_view kRdfNs = "http://www.w3.org/1999/02/22-rdf-syntax-ns#";
inline constexpr std::string_view kRdfsNs = "http://www.w3.org/2000/01/rdf-schema#";
inline constexpr std::string_view kOwlNs = "http://www.w3.org/2002/07/owl#";
inline constexpr std::string_view kXsdNs = "http://www.w3.org/2001/XMLSchema#";
inline constexpr std::string_view kProvNs = "http://www.w3.org/ns/prov#";
inline constexpr std::string_view kSosaNs = "http://www.w3.org/ns/sosa/";
inline constexpr std::string_view kGeoNs = "http://www.opengis.net/ont/geosparql#";
inline constexpr std::string_view kSchemaNs = "https://schema.org/";
inline constexpr std::string_view kDocentNs = "https://w3id.org/docent#";

// Prefixes that `ToDisplay`, `docent query` and CAWL documents know without declaration.
inline constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kWellKnownPrefixes = {{
    {"rdf", kRdfNs},
    {"rdfs", kRdfsNs},
    {"owl", kOwlNs},
    {"xsd", kXsdNs},
    {"prov", kProvNs},
    {"sosa", kSosaNs},
    {"geo", kGeoNs},
    {"schema", kSchemaNs},
    {"docent", kDocentNs},
}};

inline constexpr std::string_view kRdfType = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type";
inline constexpr std::string_view kRdfLangString = "http://www.w3.org/1999/02/22-rdf-syntax-ns#langString";
inline constexpr std::string_view kXsdString = "http://www.w3.org/2001/XMLSchema#string";
inline constexpr std::string_view kXsdInteger = "http://www.w3.org/2001/XMLSchema#integer";
inline constexpr std::string_view kXsdDecimal = "http://www.w3.org/2001/XMLSchema#decimal";
inline constexpr std::string_view kXsdDouble = "http://www.w3.org/2001/XMLSchema#double";
inline constexpr std::string_view kXsdFloat = "http://www.w3.org/2001/XMLSchema#float";
inline constexpr std::string_view kXsdBoolean = "http://www.w3.org/2001/XMLSchema#boolean";
inline constexpr std::string_view kXsdDate = "http://www.w3.org/2001/XMLSchema#date";
inline constexpr std::string_view kXsdTime = "http://www.w3.org/2001/XMLSchema#time";
inline constexpr std::string_view kXsdDateTime = "http://www.w3.org/2001/XMLSchema#dateTime";

// graphs of the server
inline constexpr std::string_view kDefaultGraph =
    "https://w3id.org/docent#default";  // data written without a graph
inline constexpr std::string_view kInferredGraph = "https://w3id.org/docent#inferred";  // what rules derived
inline constexpr std::string_view kRunsGraph =
    "https://w3id.org/docent#runs";  // run state, written by the engine
inline constexpr std::string_view kDocumentsGraph = "https://w3id.org/docent#documents";  // what is deployed
inline constexpr std::string_view kClockGraph =
    "https://w3id.org/docent#clock";  // what the clock tells of times

// "docent:" + local, e.g. DocentIri("isAt")
inline std::string DocentIri(std::string_view local) {
  return std::string(kDocentNs) + std::string(local);
}

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_VOCABULARY_H_
