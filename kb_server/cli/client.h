// Helpers of the client commands of `docent`: connecting to a server, printing errors, exit codes.
#ifndef DOCENT_KB_SERVER_CLI_CLIENT_H_
#define DOCENT_KB_SERVER_CLI_CLIENT_H_

#include <google/protobuf/message.h>
#include <grpcpp/grpcpp.h>

#include <memory>
#include <string>
#include <string_view>

#include "CLI/App.hpp"
#include "absl/status/statusor.h"
#include "docent/v1/context.pb.h"
#include "docent/v1/term.pb.h"
#include "graph/rdf/term.h"

namespace docent {

// Exit codes of every command.
inline constexpr int kExitOk = 0;
inline constexpr int kExitNegative =
    1;                              // a negative answer: ASK is false, a run failed, a check found errors
inline constexpr int kExitBad = 2;  // bad usage or input, or no server

struct ClientOptions {
  std::string server = "127.0.0.1:7400";  // also from the environment variable DOCENT_SERVER
  bool json = false;
};

// Adds --server and --json to a command.
void AddClientOptions(CLI::App* command, ClientOptions* options);

std::shared_ptr<grpc::Channel> Connect(const ClientOptions& options);

// Prints "docent: message" to stderr and gives the exit code for it. A server that is not there is said so.
int Fail(const grpc::Status& status, const ClientOptions& options);
int Fail(const absl::Status& status);

// Says that the connection was lost, if this is the `first` time in a row, and waits a second before it is tried again.
void PauseToReconnect(bool first);

// A message of the API as one line of JSON, to standard output: fields as the .proto files call them, all of them.
void PrintJson(const google::protobuf::Message& message);

// What a batch or update did, for people or as JSON, to standard output.
void PrintOutcome(const v1::AssertReply& reply, const ClientOptions& options);

// "name=value" where value is N-Triples (<iri>, "text"@en, "1"^^<…>), a prefixed name with a well-known
// prefix, a number, true/false, or anything else as a plain string.
absl::StatusOr<std::pair<std::string, Term>> ParseVariable(const std::string& text);

// What the API calls the format of a file, by its ending; Turtle where that says nothing.
std::string MediaTypeOfFile(const std::string& file);

// Diagnostics of a server, to standard error.
void PrintDiagnostics(const google::protobuf::RepeatedPtrField<v1::Diagnostic>& diagnostics);

// A term of the API as N-Triples, or shortened for people.
std::string ToNTriples(const v1::Term& term);
std::string ToDisplay(const v1::Term& term);

// `text` cut to `width` code points with an ellipsis, line breaks as spaces.
std::string OneLine(std::string_view text, size_t width);

}  // namespace docent

#endif  // DOCENT_KB_SERVER_CLI_CLIENT_H_
