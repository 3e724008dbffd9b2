// docent whatif '+S P O' '-S P O': what facts would do if they were told.
#include <iostream>

#include "docent/v1/context.grpc.pb.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/fact_arguments.h"

namespace docent::server {
namespace {

struct WhatIfArguments {
  ClientOptions client;
  std::vector<std::string> with;
  std::vector<std::string> without;
  std::vector<std::string> prefixes;
  std::string source;
};

absl::StatusOr<v1::WhatIfRequest> MakeRequest(const WhatIfArguments& arguments, FactArguments& facts) {
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return status;
  v1::WhatIfRequest request;
  for (const std::string& text : arguments.with) {
    auto quads = facts.Parse(text, "+fact");
    if (!quads.ok()) return quads.status();
    AddQuads(*quads, request.mutable_add());
  }
  for (const std::string& text : arguments.without) {
    auto quads = facts.Parse(text, "-fact");
    if (!quads.ok()) return quads.status();
    AddQuads(*quads, request.mutable_remove());
  }
  if (request.add_size() + request.remove_size() == 0)
    return absl::InvalidArgumentError("no facts given; e.g. docent whatif '+expo:R01 docent:localised true'");
  request.set_source(facts.Iri(arguments.source));
  request.set_full(arguments.client.full || arguments.client.json);
  return request;
}

int RunWhatIf(const WhatIfArguments& arguments) {
  const IriNames known = ServerNames(arguments.client);
  FactArguments facts([&] { return known; });
  auto request = MakeRequest(arguments, facts);
  if (!request.ok()) return Fail(request.status());
  AddPrefixes(known, facts.given(), request->mutable_prefixes());
  v1::WhatIfReply reply;
  grpc::ClientContext context;
  const auto server = v1::Context::NewStub(Connect(arguments.client));
  grpc::Status status = server->WhatIf(&context, *request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json) {
    PrintJson(reply);
  } else {
    const Presenter presenter(arguments.client, facts.given(), known);
    std::cout << presenter.names().InText(reply.text());
    if (reply.removed_size() == 0) std::cerr << WhereElse(*server, request->remove(), presenter);
    std::cerr << "revision " << reply.revision() << "; nothing was written\n";
  }
  return kExitOk;
}

}  // namespace

std::vector<std::string> WithSignedFacts(std::vector<std::string> arguments) {
  if (arguments.empty() || arguments[0] != "whatif") return arguments;
  std::vector<std::string> out;
  for (std::string& argument : arguments) {
    const bool fact = argument.size() > 1 && argument.find_first_of(" \t\n") != std::string::npos;
    if (fact && (argument[0] == '+' || (argument[0] == '-' && argument[1] != '-'))) {
      out.push_back(argument[0] == '+' ? "--with" : "--without");
      out.push_back(argument.substr(1));
    } else {
      out.push_back(std::move(argument));
    }
  }
  return out;
}

void AddWhatIfCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<WhatIfArguments>();
  CLI::App* command = app->add_subcommand(
      "whatif",
      "Try facts without writing them: what would be inferred, which conditions would change, which steps "
      "would start");
  command->group(kGraphGroup);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  command->add_option("--with", arguments->with, "Facts in Turtle that would be told; also written '+S P O'")
      ->type_name("TURTLE")
      ->allow_extra_args(false);
  command
      ->add_option("--without", arguments->without,
                   "Facts in Turtle that would be withdrawn; also written '-S P O'")
      ->type_name("TURTLE")
      ->allow_extra_args(false);
  AddPrefixOption(command, &arguments->prefixes);
  command->add_option("--source", arguments->source, "Source that would tell the facts")->type_name("IRI");
  command->footer(
      "Example:\n"
      "  docent whatif '+expo:R01 docent:localised false' '-expo:John docent:selected expo:B03'");
  command->callback([arguments, exit_code] { *exit_code = RunWhatIf(*arguments); });
}

}  // namespace docent::server
