// docent services: composite robot services (RSEL processes).
#include "CLI/App.hpp"
#include "absl/strings/str_cat.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/services/service_commands.h"
#include "kb_server/cli/variable_argument.h"

namespace docent::server {
namespace {

using Arguments = std::shared_ptr<ServiceArguments>;

// A part of the command, with arguments of its own. What stands before its name (--server, --json) counts for it, too.
class Parts {
 public:
  Parts(CLI::App* command, Arguments common, int* exit_code)
      : command_(command), common_(std::move(common)), exit_code_(exit_code) {}

  CLI::App* Add(const char* name, const char* help, int (*run)(const ServiceArguments&),
                Arguments* arguments) {
    *arguments = std::make_shared<ServiceArguments>();
    CLI::App* part = command_->add_subcommand(name, help);
    AddClientOptions(part, &(*arguments)->client);
    part->callback([this_command = command_, common = common_, arguments = *arguments, run, part,
                    exit_code = exit_code_] {
      for (const char* option : {"--server", "--json"}) {
        if (this_command->count(option) == 0 || part->count(option) > 0) continue;
        if (std::string(option) == "--json")
          arguments->client.json = true;
        else
          arguments->client.server = common->client.server;
      }
      *exit_code = run(*arguments);
    });
    return part;
  }

 private:
  CLI::App* const command_;
  const Arguments common_;
  int* const exit_code_;
};

void AddName(CLI::App* part, const Arguments& arguments, const char* help, const char* type) {
  part->add_option("name", arguments->name, help)->required()->type_name(type);
}

void AddRobot(CLI::App* part, const Arguments& arguments, const char* help) {
  part->add_option("--robot", arguments->robot, help)->type_name("IRI");
}

void AddArguments(CLI::App* part, const Arguments& arguments) {
  part->add_option("--arg", arguments->arguments, "An argument of the service")->type_name("NAME=VALUE");
  AddPrefixOption(part, &arguments->prefixes);
  AddRobot(part, arguments, "Robot that carries it out; by default any that offers all of it");
}

void AddVersion(CLI::App* part, const Arguments& arguments, const char* help, int most) {
  part->add_option("--version", arguments->versions, help)->type_name("NUMBER")->expected(1, most);
}

void AddReaders(Parts* parts) {
  Arguments arguments;
  CLI::App* list = parts->Add("list", "List the robot services", ListServices, &arguments);
  AddShowOptions(list, &arguments->client);
  list->footer("Example:\n  docent services list --json");

  CLI::App* show =
      parts->Add("show", "Show a robot service: what it takes and gives, its steps, who can do it",
                 ShowService, &arguments);
  AddName(show, arguments, "Name of a service, or of a document", "NAME");
  show->add_flag("--text", arguments->text, "Print the RSEL text of the document");
  AddVersion(show, arguments, "Print the text of this version, see `docent services versions`", 1);
  AddShowOptions(show, &arguments->client);
  show->footer(
      "Examples:\n  docent services show moveToBooth\n  docent services show BoothServices --version 1");

  CLI::App* versions = parts->Add("versions", "List the texts that were registered under a document's name",
                                  ListServiceVersions, &arguments);
  AddName(versions, arguments, "Name of the document", "DOCUMENT");
  versions->footer("Example:\n  docent services versions BoothServices");

  CLI::App* diff = parts->Add("diff", "Compare two versions of a document, by default the last two",
                              DiffServiceVersions, &arguments);
  AddName(diff, arguments, "Name of the document", "DOCUMENT");
  diff->add_option("versions", arguments->versions, "One version, which is compared with the newest, or two")
      ->type_name("NUMBER")
      ->expected(0, 2);
  diff->footer("Exit code 1: they are different.\nExample:\n  docent services diff BoothServices 1 2");
}

void AddWriters(Parts* parts) {
  Arguments arguments;
  CLI::App* invoke = parts->Add("invoke", "Invoke a robot service and follow it", InvokeService, &arguments);
  AddName(invoke, arguments, "Name of the service", "SERVICE");
  AddArguments(invoke, arguments);
  AddShowOptions(invoke, &arguments->client);
  invoke->footer(
      absl::StrCat(kVariableValueHelp,
                   "\n"
                   "Exit code 1: the invoked service failed or was cancelled.\n"
                   "Example:\n"
                   "  docent services invoke moveToBooth --arg booth=https://w3id.org/docent/expo#B03"));

  CLI::App* remove = parts->Add("remove", "Remove the robot services of a document; runs under way go on",
                                RemoveServices, &arguments);
  AddName(remove, arguments, "Name of the document", "DOCUMENT");
  remove->add_flag("--force", arguments->force, "Also where a workflow or another service uses one of them");
  remove->footer("Example:\n  docent services remove BoothServices");

  CLI::App* generate = parts->Add("generate", "Write an RSEL document of operations that robots describe",
                                  GenerateServices, &arguments);
  generate
      ->add_option(
          "operations", arguments->names,
          "Operations or services, in order, as one service; by default a service for each operation")
      ->type_name("OPERATION");
  arguments->name = "Generated";
  generate->add_option("--name", arguments->name, "Name of the document")
      ->type_name("NAME")
      ->capture_default_str();
  generate
      ->add_option("--process", arguments->process,
                   "Name of its one service; by default that of the document")
      ->type_name("NAME");
  AddRobot(generate, arguments, "Only what this robot describes; by default any");
  AddPrefixOption(generate, &arguments->prefixes);
  generate->footer(
      "The document goes to standard output, what is to be said about it to standard error.\n"
      "Examples:\n"
      "  docent services generate\n"
      "  docent services generate --name Tour moveToBooth briefBoothInfo > tour.rsel.xml");

  CLI::App* check =
      parts->Add("check", "Check RSEL documents against the robots and services that the server has",
                 CheckServices, &arguments);
  check->add_option("files", arguments->names, "RSEL documents")->required()->type_name("FILE");
  check->footer("Exit code 1: a document has errors.\nExample:\n  docent services check tour.rsel.xml");

  CLI::App* from =
      parts->Add("import", "Print what a service elsewhere offers as CAWL nodes, to be pasted into a flow",
                 ImportServices, &arguments);
  from->add_option("from", arguments->names, "FILE.wsdl, or grpc HOST:PORT, or adapter HOST:PORT")
      ->required()
      ->expected(1, 2)
      ->type_name("FILE | grpc ADDRESS | adapter ADDRESS");
  from->footer(
      "A WSDL 1.1 file, a gRPC server with reflection, or a robot adapter; no Docent server is asked.\n"
      "Examples:\n"
      "  docent services import weather.wsdl\n"
      "  docent services import grpc 127.0.0.1:50051\n"
      "  docent services import adapter 127.0.0.1:7500 --json");
}

}  // namespace

void AddServicesCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<ServiceArguments>();
  CLI::App* command =
      app->add_subcommand("services", "List, invoke, generate and remove robot services; their versions");
  command->group(kRobotsGroup);
  command->require_subcommand(0, 1);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  command->add_option("--invoke", arguments->name, "Deprecated: use `docent services invoke`")
      ->type_name("SERVICE");
  AddArguments(command, arguments);
  command->footer(
      "Without a part of it: the list.\n"
      "Examples:\n"
      "  docent services\n"
      "  docent services show moveToBooth\n"
      "  docent services invoke moveToBooth --arg booth=https://w3id.org/docent/expo#B03");
  Parts parts(command, arguments, exit_code);
  AddReaders(&parts);
  AddWriters(&parts);
  command->callback([command, arguments, exit_code] {
    if (!command->get_subcommands().empty()) return;
    *exit_code = arguments->name.empty() ? ListServices(*arguments) : InvokeService(*arguments);
  });
}

}  // namespace docent::server
