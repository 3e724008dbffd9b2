// The IRIs of what Docent itself names: runs, workflows, robot services, operations. A name stands in them as one segment,
// percent-encoded (RFC 3986 section 2.1), so that any name gives a valid IRI and different names different ones. Any thread.
#ifndef DOCENT_GRAPH_RDF_DOCENT_IRIS_H_
#define DOCENT_GRAPH_RDF_DOCENT_IRIS_H_

#include <optional>
#include <string>
#include <string_view>

#include "graph/base/ids.h"

namespace docent {

// What may not stand in an IRI, and % / ? # $ @, are encoded: "Tour A/B" → "Tour%20A%2FB", "Führung" stays as it is.
// Run ids and command ids are made of such segments, too.
std::string IriSegment(std::string_view name);
// The name that gives this segment. A % that does not begin two hexadecimal digits stands for itself.
std::string NameOfSegment(std::string_view segment);

// Why this cannot be a name: "has 300 bytes; the limit name_bytes is 256", "holds the control character U+000A", "is not
// UTF-8". nullopt: it can. The empty text is left to whoever asks.
std::optional<std::string> NameFault(std::string_view name);

// urn:docent:operation:NAME, urn:docent:service:NAME, urn:docent:workflow:NAME.
std::string OperationIri(std::string_view name);
std::string ServiceIri(std::string_view name);
std::string WorkflowIri(std::string_view name);
// nullopt: it is no IRI of an operation.
std::optional<std::string> OperationOfIri(std::string_view iri);

// urn:docent:run:ID. Ids are made of segments and stand in it as they are.
std::string RunIri(const RunId& run);
// nullopt: it is no IRI of a run.
std::optional<RunId> RunOfIri(std::string_view iri);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_DOCENT_IRIS_H_
