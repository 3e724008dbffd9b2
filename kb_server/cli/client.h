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
#include "graph/command_line/program.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/term.h"

namespace docent::server {

struct ClientOptions {
  std::string server = "127.0.0.1:7400";  // also from the environment variable DOCENT_SERVER
  bool json = false;
  bool full = false;             // IRIs whole, cells uncut
  std::string colours = "auto";  // auto, always, never
};

// Adds --server and --json to a command; without --json to one whose output has a form of its own.
void AddClientOptions(CLI::App* command, ClientOptions* options, bool json = true);
// Adds --full, and --color, to a command whose result names IRIs to people.
void AddShowOptions(CLI::App* command, ClientOptions* options);
// Adds --prefix to a command that takes facts.
void AddPrefixOption(CLI::App* command, std::vector<std::string>* prefixes);

// Where a server on this machine is only starting (`docent serve &`), waits for it, once in a process and about two seconds.
std::shared_ptr<grpc::Channel> Connect(const ClientOptions& options);

// Prints "docent: message" to stderr and gives the exit code for it. A server that is not there is said so; IRIs have the
// server's prefixes, unless they are to be whole.
int Fail(const grpc::Status& status, const ClientOptions& options);
int Fail(const absl::Status& status);

// Says that the connection was lost, if this is the `first` time in a row, and waits a second before it is tried again.
void PauseToReconnect(bool first);

// A message of the API as one line of JSON, to standard output: fields as the .proto files call them, all of them.
void PrintJson(const google::protobuf::Message& message);

// What a batch or update did, for people or as JSON, to standard output; the server's warnings, to standard error.
void PrintOutcome(const v1::AssertReply& reply, const ClientOptions& options);

// What the API calls a format.
std::string MediaTypeOf(RdfFormat format);
// Adds --base to a command that reads RDF files, and standard input if it does.
void AddBaseOption(CLI::App* command, std::string* base, bool standard_input = true);

// Diagnostics of a server, to standard error.
void PrintDiagnostics(const google::protobuf::RepeatedPtrField<v1::Diagnostic>& diagnostics);

// A term of the API as N-Triples.
std::string ToNTriples(const v1::Term& term);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_CLIENT_H_
