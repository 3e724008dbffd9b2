// Adapter for tests: every operation takes a given time and does nothing else. Its journal
// (robot_adapters/sdk/command_journal.h) records the commands. Ends with SIGTERM.
//
//   docent-scripted-adapter --server HOST:PORT --robot IRI --operation NAME[:PART[=TYPE],PART[=TYPE]…] … --journal FILE
//   --take-ms 200
#include <signal.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <iostream>

#include "CLI/CLI.hpp"
#include "absl/strings/str_split.h"
#include "graph/rdf/vocabulary.h"
#include "robot_adapters/sdk/robot_adapter.h"

namespace docent::robot {
namespace {

struct Arguments {
  AdapterOptions options;
  std::vector<std::string> operations;
  std::vector<std::string> capabilities;
  std::vector<std::string> facts;
  int take_ms = 100;
  bool idempotent = false;
  bool fail = false;
};

Operation MakeOperation(const std::string& text, const Arguments& arguments) {
  const std::vector<std::string> name_and_parts = absl::StrSplit(text, absl::MaxSplits(':', 1));
  Operation operation;
  operation.name = name_and_parts[0];
  if (name_and_parts.size() > 1) {
    const std::vector<std::string> parts = absl::StrSplit(name_and_parts[1], ',', absl::SkipEmpty());
    for (const std::string& part : parts) {
      const std::vector<std::string> name_and_type = absl::StrSplit(part, absl::MaxSplits('=', 1));
      operation.input_parts.push_back({name_and_type[0], name_and_type.size() > 1 ? name_and_type[1] : ""});
    }
  }
  for (const std::string& text : arguments.capabilities) {
    const std::vector<std::string> name_and_class = absl::StrSplit(text, absl::MaxSplits('=', 1));
    if (name_and_class.size() == 2 && name_and_class[0] == operation.name)
      operation.capabilities.push_back(name_and_class[1]);
  }
  operation.idempotent = arguments.idempotent;
  operation.description = "does nothing, slowly";
  operation.run = [take = std::chrono::milliseconds(arguments.take_ms),
                   fail = arguments.fail](OperationContext& context) -> absl::StatusOr<NamedTerms> {
    constexpr int kParts = 4;
    for (int i = 0; i < kParts; ++i) {
      context.ReportProgress(static_cast<double>(i) / kParts, "working");
      if (!context.SleepFor(take / kParts)) return absl::CancelledError("told to stop");
    }
    if (fail) return absl::InternalError("failed as the test wanted");
    return NamedTerms{};
  };
  return operation;
}

int Run(const Arguments& arguments) {
  std::vector<Operation> operations;
  for (const std::string& text : arguments.operations) operations.push_back(MakeOperation(text, arguments));
  auto adapter = RobotAdapter::Start(arguments.options, std::move(operations));
  if (!adapter.ok()) {
    std::cerr << "docent-scripted-adapter: " << adapter.status().message() << "\n";
    return 2;
  }
  for (const std::string& fact : arguments.facts) {
    const std::vector<std::string> property_and_value = absl::StrSplit(fact, absl::MaxSplits('=', 1));
    if (property_and_value.size() != 2) continue;
    (*adapter)->SetState(DocentIri(property_and_value[0]), Term::Iri(property_and_value[1]));
  }
  std::cout << "listening grpc=" << (*adapter)->address() << " incarnation=" << (*adapter)->incarnation()
            << std::endl;
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  int number = 0;
  sigwait(&signals, &number);
  return 0;
}

}  // namespace
}  // namespace docent::robot

int main(int argc, char** argv) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  spdlog::set_default_logger(spdlog::stderr_logger_mt("scripted-adapter"));
  docent::robot::Arguments arguments;
  CLI::App app("An adapter whose operations only take their time", "docent-scripted-adapter");
  app.add_option("--server", arguments.options.server, "HOST:PORT of the docent server");
  app.add_option("--robot", arguments.options.robot, "IRI of the robot")->required();
  app.add_option("--listen", arguments.options.listen, "HOST:PORT to serve at; port 0 takes a free one");
  app.add_option("--operation", arguments.operations, "NAME or NAME:PART,PART; may be given several times")
      ->required();
  app.add_option("--capability", arguments.capabilities,
                 "NAME=CLASS: the operation is of this class; several times");
  app.add_option("--fact", arguments.facts,
                 "LOCAL=IRI: a docent: property of the robot, told at the start; several times");
  app.add_option("--journal", arguments.options.journal_path,
                 "Journal of executed commands; none if not given");
  app.add_option("--take-ms", arguments.take_ms, "How long each command takes")
      ->check(CLI::Range(0, 3600000));
  app.add_flag("--idempotent", arguments.idempotent, "Says that its operations may be done twice");
  app.add_flag("--fail", arguments.fail, "Each command fails after its time");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return docent::robot::Run(arguments);
}
