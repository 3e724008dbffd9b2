// docent tell: facts and sensor readings from the command line, as a robot, sensor or person would tell them.
#include <iostream>

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "docent/v1/context.grpc.pb.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/fact_arguments.h"

namespace docent::server {
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
absl::Status AddReading(FactArguments& facts, const std::string& text, v1::AssertRequest* request) {
  size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0) {
    return absl::InvalidArgumentError(absl::StrCat("--reading \"", text, "\" is not SENSOR=VALUE"));
  }
  if (absl::Status status = CheckUtf8(text, "--reading"); !status.ok()) return status;
  std::string sensor = text.substr(0, equals);
  auto quads = facts.Parse(absl::StrCat(sensor, " a ", sensor), "--reading");
  if (!quads.ok()) return quads.status();
  v1::SensorReading* reading = request->add_readings();
  reading->set_sensor((*quads)[0].subject.lexical);
  reading->mutable_value()->mutable_literal()->set_lexical(text.substr(equals + 1));
  return absl::OkStatus();
}

absl::StatusOr<v1::AssertRequest> MakeRequest(const TellArguments& arguments, FactArguments& facts) {
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return status;
  auto add = facts.Parse(arguments.facts, "facts");
  if (!add.ok()) return add.status();
  auto remove = facts.Parse(arguments.withdraw, "--withdraw");
  if (!remove.ok()) return remove.status();
  v1::AssertRequest request;
  AddQuads(*add, request.mutable_add());
  AddQuads(*remove, request.mutable_remove());
  for (const std::string& reading : arguments.readings) {
    if (absl::Status status = AddReading(facts, reading, &request); !status.ok()) return status;
  }
  if (request.add_size() + request.remove_size() + request.readings_size() == 0) {
    return absl::InvalidArgumentError("nothing to tell; give facts, --withdraw or --reading");
  }
  request.set_source(facts.Iri(arguments.source));
  request.set_request_id(arguments.request_id);
  request.set_lifetime_ms(arguments.lifetime_ms);
  return request;
}

int RunTell(const TellArguments& arguments) {
  FactArguments facts([&] { return ServerNames(arguments.client); });
  auto request = MakeRequest(arguments, facts);
  if (!request.ok()) return Fail(request.status());
  v1::AssertReply reply;
  grpc::ClientContext context;
  const auto server = v1::Context::NewStub(Connect(arguments.client));
  grpc::Status status = server->Assert(&context, *request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  PrintOutcome(reply, arguments.client);
  if (!arguments.client.json && request->remove_size() > 0)
    std::cerr << WhereElse(*server, request->remove(), Presenter(arguments.client, facts.given()));
  return kExitOk;
}

}  // namespace

void AddTellCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<TellArguments>();
  CLI::App* command = app->add_subcommand(
      "tell", "Tell facts or sensor readings; a new value of a state property replaces the old one");
  command->group(kGraphGroup);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  command->add_option("facts", arguments->facts, "Facts in Turtle; known prefixes need no declaration");
  command->add_option("--withdraw", arguments->withdraw, "Facts in Turtle that no longer hold")
      ->type_name("TURTLE");
  command
      ->add_option("--reading", arguments->readings,
                   "A sensor reading; the reading mappings of the graph make it a fact")
      ->type_name("SENSOR=VALUE")
      ->allow_extra_args(false);
  AddPrefixOption(command, &arguments->prefixes);
  command
      ->add_option("--source", arguments->source, "Source that tells the facts: the graph that they lie in")
      ->type_name("IRI");
  command
      ->add_option("--request-id", arguments->request_id,
                   "Id of the request; a repeated id is not applied again")
      ->type_name("ID");
  command
      ->add_option("--lifetime-ms", arguments->lifetime_ms,
                   "Time after which the facts are withdrawn; without it they stay")
      ->check(CLI::Range(int64_t{1}, int64_t{10'000'000'000'000}))  // 300 years
      ->type_name("MS");
  command->footer(
      "Examples:\n"
      "  docent tell 'expo:John docent:selected expo:B03'\n"
      "  docent tell --reading expo:DoorSensor=tag-17 --prefix expo=https://w3id.org/docent/expo#");
  command->callback([arguments, exit_code] { *exit_code = RunTell(*arguments); });
}

}  // namespace docent::server
