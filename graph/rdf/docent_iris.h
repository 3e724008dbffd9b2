// IRIs of runs, workflows, robot services and operations. A name is one percent-encoded segment (RFC 3986
// section 2.1), so any name gives a valid IRI, and different names give different IRIs. Any thread.
#ifndef DOCENT_GRAPH_RDF_DOCENT_IRIS_H_
#define DOCENT_GRAPH_RDF_DOCENT_IRIS_H_

#include <optional>
#include <string>
#include <string_view>

#include "graph/base/ids.h"

namespace docent {

// Encodes characters that an IRI may not contain, and % / ? # $ @: "Tour A/B" → "Tour%20A%2FB"; "Führung"
// stays as it is. Run ids and command ids consist of such segments, too.
std::string IriSegment(std::string_view name);
// The name of this segment. A % that is not followed by two hexadecimal digits stands for itself.
std::string NameOfSegment(std::string_view segment);

// Why this is no valid name: "has 300 bytes; the limit name_bytes is 256", "holds the control character
// U+000A", "is not UTF-8". nullopt: it is valid. The caller checks for the empty text.
std::optional<std::string> NameFault(std::string_view name);

// Why this cannot name a document (an ontology or rule set): as above, and "is empty", "begins or ends with a blank", "has
// the part .., which stands for another folder in an IRI". nullopt: it can.
std::optional<std::string> DocumentNameFault(std::string_view name);

// urn:docent:operation:NAME, urn:docent:service:NAME, urn:docent:service-document:NAME, urn:docent:workflow:NAME.
std::string OperationIri(std::string_view name);
std::string ServiceIri(std::string_view name);
std::string ServiceDocumentIri(std::string_view name);
std::string WorkflowIri(std::string_view name);
// nullopt: not the IRI of an operation.
std::optional<std::string> OperationOfIri(std::string_view iri);

// nullopt: not the IRI of a workflow.
std::optional<std::string> WorkflowOfIri(std::string_view iri);

// urn:docent:reservation:ID. That of a run has the run's id.
std::string ReservationIri(std::string_view id);

// urn:docent:run:ID. An id consists of segments and is copied as it is.
std::string RunIri(const RunId& run);
// nullopt: not the IRI of a run.
std::optional<RunId> RunOfIri(std::string_view iri);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_DOCENT_IRIS_H_
