// docent tell: facts and sensor readings from the command line, as a robot, sensor or person would tell them.
#include <iostream>

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "docent/v1/context.grpc.pb.h"
#include "graph/rdf/text_input.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/fact_arguments.h"

namespace docent {
namespace {

struct TellArguments {
  ClientOptions client;
  std::string facts;
  std::string withdraw;
  std::vector<std::string> readings;
  std::vector<std::string> prefixes;
  std::string source;
  std::string request_id;
  uint64_t lifetime_ms = 0;
};

// "SENSOR=VALUE": the sensor as an IRI or prefixed name, the value as plain text.
absl::Status AddReading(const std::string& prologue, const std::string& text, v1::AssertRequest* request) {
  size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0) {
    return absl::InvalidArgumentError(absl::StrCat("--reading \"", text, "\" is not SENSOR=VALUE"));
  }
  if (absl::Status status = CheckUtf8(text, "--reading"); !status.ok()) return status;
  std::string sensor = text.substr(0, equals);
  auto quads = ParseFacts(prologue, absl::StrCat(sensor, " a ", sensor), "--reading");
  if (!quads.ok()) return quads.status();
  v1::SensorReading* reading = request->add_readings();
  reading->set_sensor((*quads)[0].subject.lexical);
  reading->mutable_value()->mutable_literal()->set_lexical(text.substr(equals + 1));
  return absl::OkStatus();
}

absl::StatusOr<v1::AssertRequest> MakeRequest(const TellArguments& arguments) {
  auto prologue = FactPrologue(arguments.prefixes);
  if (!prologue.ok()) return prologue.status();
  auto add = ParseFacts(*prologue, arguments.facts, "facts");
  if (!add.ok()) return add.status();
  auto remove = ParseFacts(*prologue, arguments.withdraw, "--withdraw");
  if (!remove.ok()) return remove.status();
  v1::AssertRequest request;
  AddQuads(*add, request.mutable_add());
  AddQuads(*remove, request.mutable_remove());
  for (const std::string& reading : arguments.readings) {
    if (absl::Status status = AddReading(*prologue, reading, &request); !status.ok()) return status;
  }
  if (request.add_size() + request.remove_size() + request.readings_size() == 0) {
    return absl::InvalidArgumentError("nothing to tell; give facts, --withdraw or --reading");
  }
  request.set_source(ReadIri(arguments.prefixes, arguments.source));
  request.set_request_id(arguments.request_id);
  request.set_lifetime_ms(arguments.lifetime_ms);
  return request;
}

int RunTell(const TellArguments& arguments) {
  auto request = MakeRequest(arguments);
  if (!request.ok()) return Fail(request.status());
  v1::AssertReply reply;
  grpc::ClientContext context;
  const auto server = v1::Context::NewStub(Connect(arguments.client));
  grpc::Status status = server->Assert(&context, *request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  PrintOutcome(reply, arguments.client);
  if (!arguments.client.json) std::cerr << WhereElse(*server, request->remove());
  return kExitOk;
}

}  // namespace

void AddTellCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<TellArguments>();
  CLI::App* command = app->add_subcommand(
      "tell", "Tell facts, or what a sensor reads: a new value of a state property replaces the old one");
  AddClientOptions(command, &arguments->client);
  command->add_option("facts", arguments->facts, "Turtle, e.g. 'expo:John docent:selected expo:B03'");
  command->add_option("--withdraw", arguments->withdraw, "Turtle: facts that no longer hold");
  command
      ->add_option("--reading", arguments->readings,
                   "SENSOR=VALUE; the graph's reading mappings make it a fact")
      ->allow_extra_args(false);
  command->add_option("--prefix", arguments->prefixes, "NAME=IRI, besides the well-known prefixes")
      ->allow_extra_args(false);
  command->add_option("--source", arguments->source, "IRI of who says it, whole or with a prefix");
  command->add_option("--request-id", arguments->request_id, "A repeat of this id is not applied again");
  command->add_option("--lifetime-ms", arguments->lifetime_ms, "Withdraw the facts after this time")
      ->check(CLI::Range(int64_t{0}, int64_t{10'000'000'000'000}));  // 300 years
  command->callback([arguments, exit_code] { *exit_code = RunTell(*arguments); });
}

}  // namespace docent
