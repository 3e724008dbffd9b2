// docent update: a SPARQL Update from the command line or a file.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "docent/v1/context.grpc.pb.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"

namespace docent::server {
namespace {

struct UpdateArguments {
  ClientOptions client;
  std::string update;
  std::string file;
  std::string request_id;
  uint32_t timeout_ms = 0;
};

int RunUpdate(const UpdateArguments& arguments) {
  const auto update = GivenText("update", arguments.update, arguments.file, kUpdateText);
  if (!update.ok()) return Fail(update.status());
  grpc::ClientContext context;
  v1::UpdateRequest request;
  request.set_update(*update);
  request.set_request_id(arguments.request_id);
  request.set_timeout_ms(arguments.timeout_ms);
  v1::AssertReply reply;
  grpc::Status status = v1::Context::NewStub(Connect(arguments.client))->Update(&context, request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  PrintOutcome(reply, arguments.client);
  return kExitOk;
}

}  // namespace

void AddUpdateCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<UpdateArguments>();
  CLI::App* command =
      app->add_subcommand("update", "Change the graph by a SPARQL Update: all of it or nothing");
  command->group(kGraphGroup);
  AddClientOptions(command, &arguments->client);
  command->add_option("update", arguments->update,
                      "SPARQL Update; prefixes that the server knows need no PREFIX");
  command->add_option("--file,-f", arguments->file, "Read the update from a file; - is standard input")
      ->type_name("FILE");
  command
      ->add_option("--request-id", arguments->request_id,
                   "Id of the request; a repeated id is not applied again")
      ->type_name("ID");
  command->add_option("--timeout-ms", arguments->timeout_ms, "Give up evaluating after this time")
      ->type_name("MS");
  command->footer(
      "Example:\n"
      "  docent update 'DELETE WHERE { ?who docent:selected ?booth }'");
  command->callback([arguments, exit_code] { *exit_code = RunUpdate(*arguments); });
}

}  // namespace docent::server
