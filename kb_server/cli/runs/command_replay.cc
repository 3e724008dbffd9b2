// docent replay --run ID: lives a recorded run again with an edited document, or one node of it. docent runs save: the run as a
// file.
#include <CLI/CLI.hpp>

#include <fstream>
#include <iostream>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "docent/v1/replays.grpc.pb.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/run_name.h"
#include "kb_server/cli/runs/replay_printer.h"
#include "kb_server/cli/runs/steering_commands.h"
#include "kb_server/cli/text_file.h"

namespace docent::server {
namespace {

struct ReplayArguments {
  ClientOptions client;
  std::string run;
  std::string workflow;
  std::string node;
  uint64_t at = 0;
  bool assume_done = false;
};

int TryNode(const ReplayArguments& arguments, const std::string& cawl) {
  v1::TryNodeRequest request;
  request.set_run(arguments.run);
  request.set_node(arguments.node);
  request.set_turn(arguments.at);
  request.set_name(arguments.workflow);
  request.set_cawl(cawl);
  v1::TryNodeReply reply;
  grpc::ClientContext context;
  const grpc::Status status =
      v1::Replays::NewStub(Connect(arguments.client))->TryNode(&context, request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json)
    PrintJson(reply);
  else
    PrintTrial(request, reply, Presenter(arguments.client));
  return reply.opens() ? kExitOk : kExitNegative;
}

int Replay(const ReplayArguments& arguments) {
  std::string cawl;
  if (!arguments.workflow.empty()) {
    auto text = ReadBytes(arguments.workflow);
    if (!text.ok()) return Fail(text.status());
    cawl = *std::move(text);
    if (cawl.empty())
      return Fail(absl::InvalidArgumentError(
          absl::StrCat(arguments.workflow, " is empty; give a workflow document")));
  }
  if (!arguments.node.empty()) return TryNode(arguments, cawl);
  v1::ReplayRequest request;
  request.set_run(arguments.run);
  request.set_name(arguments.workflow);
  request.set_cawl(cawl);
  request.set_assume_done(arguments.assume_done);
  v1::ReplayReply reply;
  grpc::ClientContext context;
  const grpc::Status status =
      v1::Replays::NewStub(Connect(arguments.client))->Replay(&context, request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json)
    PrintJson(reply);
  else
    PrintReplay(reply, Presenter(arguments.client));
  return reply.same() ? kExitOk : kExitNegative;
}

struct SaveArguments {
  ClientOptions client;
  std::string run;
  std::string to;
};

int Save(const SaveArguments& arguments) {
  v1::SaveRunRequest request;
  request.set_run(arguments.run);
  v1::SaveRunReply reply;
  grpc::ClientContext context;
  const grpc::Status status =
      v1::Replays::NewStub(Connect(arguments.client))->Save(&context, request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  for (const std::string& warning : reply.warnings()) std::cerr << "docent: warning: " << warning << "\n";
  if (arguments.to.empty() || arguments.to == "-") {
    PrintForPrograms(reply.saved());
    return kExitOk;
  }
  std::ofstream(arguments.to, std::ios::app);  // a file that is not there yet begins empty
  if (absl::Status written = ReplaceTextFile(arguments.to, reply.saved()); !written.ok())
    return Fail(written);
  if (!arguments.client.json) std::cout << arguments.run << " is saved in " << arguments.to << "\n";
  return kExitOk;
}

}  // namespace

void AddReplayCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = app->add_subcommand("replay",
                                          "Live a recorded run again without robots, with its document or an "
                                          "edited one, and say which nodes do otherwise");
  command->group(kRobotsGroup);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  TakesRunName(command->add_option("--run", arguments->run, "Id of the run"))->type_name("ID")->required();
  command->add_option("--workflow", arguments->workflow, "The edited document; by default the one that ran")
      ->type_name("FILE");
  CLI::Option* node =
      command->add_option("--node", arguments->node, "Try this one node only, on the facts of one turn")
          ->type_name("NAME");
  command
      ->add_option("--at", arguments->at,
                   "That turn (revision); by default the one in which the node opened last, else the last "
                   "one of the run")
      ->type_name("TURN")
      ->check(CLI::PositiveNumber)
      ->needs(node);
  command
      ->add_flag("--assume-done", arguments->assume_done,
                 "Take commands that the recorded run did not send to have succeeded at once; by default the "
                 "replay ends with the first of them")
      ->excludes(node);
  command->footer(
      "The facts, the answers of robots and the requests of operators are those of the recorded run. Nothing "
      "is sent and\n"
      "nothing changes. Exit code 1: a node does otherwise, or with --node: it does not open.\n"
      "Examples:\n"
      "  docent replay --run BoothGuide-1 --workflow edited.cawl.xml\n"
      "  docent replay --run BoothGuide-1 --node Move2Booth\n"
      "  docent replay --run BoothGuide-1 --node Move2Booth --at 212");
  command->callback([arguments, exit_code] { *exit_code = Replay(*arguments); });
}

void AddSaveCommand(CLI::App* runs, int* exit_code) {
  auto arguments = std::make_shared<SaveArguments>();
  CLI::App* command =
      runs->add_subcommand("save", "Save a run as a file, which docent test lives again after an edit");
  AddClientOptions(command, &arguments->client);
  TakesRunName(command->add_option("run", arguments->run, "Id of the run"))->required();
  command->add_option("--to", arguments->to, "File to write; by default, or -, the standard output")
      ->type_name("FILE");
  command->footer(
      "Example:\n"
      "  docent runs save BoothGuide-1 --to booth_guide.run.json");
  command->callback([arguments, exit_code] { *exit_code = Save(*arguments); });
}

}  // namespace docent::server
