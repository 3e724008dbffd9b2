// docent test DOCUMENT RUNS: lives saved runs again with a document. No server is needed.
#include <CLI/CLI.hpp>

#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "docent/v1/replays.pb.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/runs/replay_printer.h"
#include "kb_server/grpc/replay/replay_proto.h"
#include "kb_server/replay/case_file.h"
#include "kb_server/replay/played_document.h"
#include "kb_server/replay/run_replays.h"
#include "kb_server/turn/spatial_functions.h"

namespace docent::server {
namespace {

struct TestArguments {
  ClientOptions client;
  std::string document;
  std::vector<std::string> runs;
  std::vector<std::string> services;
  bool assume_done = false;
};

absl::StatusOr<v1::ReplayReply> TestOne(const TestArguments& arguments, const std::string& file,
                                        const std::string& document, const std::vector<Document>& services,
                                        const sparql::FunctionRegistry& functions) {
  auto text = ReadBytes(file);
  if (!text.ok()) return text.status();
  absl::StatusOr<RunCase> saved = DecodeCase(*text, file);
  if (!saved.ok()) return saved.status();
  Cancellation cancellation(std::chrono::milliseconds(kReplayLimits.replay_timeout_ms));
  PlayOptions options;
  options.functions = &functions;
  options.cancellation = &cancellation;
  options.assume_done = arguments.assume_done;
  absl::StatusOr<Replayed> replayed =
      ReplayCase(*std::move(saved), document, arguments.document, options, services);
  if (!replayed.ok())
    return absl::Status(replayed.status().code(), absl::StrCat(file, ": ", replayed.status().message()));
  v1::ReplayReply reply;
  ToProto(*replayed, &reply);
  reply.set_file(file);
  return reply;
}

int Test(const TestArguments& arguments) {
  auto text = ReadBytes(arguments.document);
  if (!text.ok()) return Fail(text.status());
  const auto document = ParseWorkflow(*text, arguments.document, Limits());
  if (!document.ok()) return Fail(document.status());
  PrefixList prefixes((*document)->prefixes.begin(), (*document)->prefixes.end());
  const Presenter presenter(arguments.client, prefixes, IriNames::WellKnown());
  sparql::FunctionRegistry functions;
  RegisterSpatialFunctions(&functions);
  std::vector<Document> services;
  for (const std::string& file : arguments.services) {
    auto rsel = ReadBytes(file);
    if (!rsel.ok()) return Fail(rsel.status());
    services.push_back({Document::Kind::kRsel, Document::Action::kPut, file, *std::move(rsel), nullptr});
  }
  int same = 0, differ = 0, bad = 0;
  for (const std::string& file : arguments.runs) {
    const absl::StatusOr<v1::ReplayReply> reply = TestOne(arguments, file, *text, services, functions);
    if (!reply.ok()) {
      Fail(reply.status());
      ++bad;
      continue;
    }
    ++(reply->same() ? same : differ);
    if (arguments.client.json) {
      PrintJson(*reply);
    } else {
      std::cout << file << ": " << (reply->same() ? "the same" : "differs") << "\n";
      PrintDifferences(*reply, presenter, "  ");
    }
  }
  if (!arguments.client.json) {
    std::cout << absl::StrCat(same, " the same, ", differ, differ == 1 ? " differs" : " differ",
                              bad == 0 ? "" : absl::StrCat(", ", bad, " could not be replayed"), "\n");
  }
  return bad > 0 ? kExitBad : differ > 0 ? kExitNegative : kExitOk;
}

}  // namespace

void AddTestCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<TestArguments>();
  CLI::App* command = app->add_subcommand(
      "test",
      "Live saved runs again with a workflow document, without a server, and say which nodes do otherwise");
  command->group(kDocumentsGroup);
  command->add_option("document", arguments->document, "The workflow document (CAWL)")->required();
  command->add_option("runs", arguments->runs, "Files of docent runs save")->required();
  command
      ->add_option(
          "--services", arguments->services,
          "An edited document of robot services (RSEL), in place of the one of its name that the runs went "
          "by")
      ->type_name("FILE")
      ->allow_extra_args(false);
  command->add_flag("--assume-done", arguments->assume_done,
                    "Take commands that a saved run did not send to have succeeded at once; by default its "
                    "replay ends with the "
                    "first of them");
  command->add_flag("--json", arguments->client.json, "Print JSON, an object a run, as the API has it");
  AddShowOptions(command, &arguments->client);
  command->footer(
      "Exit code 1: a run differs; 2: a file or the document cannot be read.\n"
      "Example:\n"
      "  docent test booth_guide.cawl.xml runs/*.run.json\n"
      "  docent test booth_guide.cawl.xml runs/*.run.json --services booth_guide.rsel.xml");
  command->callback([arguments, exit_code] { *exit_code = Test(*arguments); });
}

}  // namespace docent::server
