// Facts that people write on a command line, as Turtle with prefixes known beforehand. Any thread.
#ifndef DOCENT_KB_SERVER_CLI_FACT_ARGUMENTS_H_
#define DOCENT_KB_SERVER_CLI_FACT_ARGUMENTS_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "docent/v1/context.grpc.pb.h"
#include "graph/rdf/term.h"

namespace docent {

// "@prefix …" lines for the well-known prefixes and those that the user gave ("NAME=IRI"), all in one line so that
// the columns of diagnostics stay right from the second line on.
absl::StatusOr<std::string> FactPrologue(const std::vector<std::string>& prefixes);

// Turtle → quads. A missing last full stop is added: people forget it on a command line. `name`: for diagnostics.
absl::StatusOr<std::vector<TermQuad>> ParseFacts(const std::string& prologue, std::string text,
                                                 const std::string& name);

// An IRI as people write one where no Turtle is expected: a name with one of those prefixes, <…>, or the IRI itself.
std::string ReadIri(const std::vector<std::string>& prefixes, const std::string& text);

void AddQuads(const std::vector<TermQuad>& quads, google::protobuf::RepeatedPtrField<v1::Quad>* out);

// Where facts that are withdrawn from one graph are told or inferred besides, a line each with how to withdraw them there;
// empty where nowhere, or where the server does not say.
std::string WhereElse(v1::Context::Stub& server, const google::protobuf::RepeatedPtrField<v1::Quad>& facts);

// "NAME=IRI" … as a message has them.
absl::Status AddPrefixes(const std::vector<std::string>& prefixes,
                         google::protobuf::Map<std::string, std::string>* out);

}  // namespace docent

#endif  // DOCENT_KB_SERVER_CLI_FACT_ARGUMENTS_H_
