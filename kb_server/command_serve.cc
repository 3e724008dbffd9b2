// docent serve: the server.
#include <signal.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <iostream>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/grpc/one_callback_thread.h"
#include "kb_server/server.h"
#include "spdlog/sinks/stdout_color_sinks.h"
#include "spdlog/spdlog.h"

namespace docent {
namespace {

void ShowProgress(uint64_t done, uint64_t all) {
  if (isatty(STDERR_FILENO) == 0) return;
  std::cerr << "\rreplaying the log: " << done << " of " << all << (done == all ? "\n" : "") << std::flush;
}

int Serve(const ServerSettings& settings) {
  // one thread waits for signals; everybody else inherits the mask and is not disturbed
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);  // a file-size limit is an error of write(2), not the end
  spdlog::set_default_logger(spdlog::stderr_color_mt("docent"));
  spdlog::set_pattern("%H:%M:%S.%e %l %v");

  OneCallbackThread one_callback_thread;
  auto server = Server::Start(settings, ShowProgress);
  if (!server.ok()) return Fail(server.status());
  std::cout << "listening grpc=" << (*server)->grpc_address() << " http=" << (*server)->http_address()
            << std::endl;
  timespec second{0, 500'000'000};
  while (true) {
    int received = sigtimedwait(&signals, nullptr, &second);
    if (received == SIGINT || received == SIGTERM) break;
    one_callback_thread.KeepAwake();
    if (!(*server)->Tend()) return Fail((*server)->status());
  }
  server->reset();
  return kExitOk;
}

CLI::Validator AtLeast(uint64_t least) {
  const auto check = [least](const std::string& text) {
    uint64_t number = 0;
    if (absl::SimpleAtoi(text, &number) && number >= least) return std::string();
    return absl::StrCat("give a whole number, ", least, " or more, not ", text);
  };
  return CLI::Validator(check, "");
}

}  // namespace

std::string DefaultDataFolder() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0') {
    return std::string(state) + "/docent";
  }
  const char* home = std::getenv("HOME");
  return std::string(home != nullptr ? home : ".") + "/.local/state/docent";
}

void AddServeCommand(CLI::App* app, int* exit_code) {
  auto settings = std::make_shared<ServerSettings>();
  settings->data_folder = DefaultDataFolder();
  auto default_graph = std::make_shared<std::string>("union");
  auto on_violation = std::make_shared<std::string>("ignore");
  CLI::App* command = app->add_subcommand("serve", "Run the server; the first line tells the addresses");
  command->add_option("--data", settings->data_folder, "Folder of the durable log; made if absent")
      ->capture_default_str();
  command->add_option("--grpc", settings->grpc_address, "HOST:PORT of the gRPC API; port 0 takes a free one")
      ->envname("DOCENT_GRPC")
      ->capture_default_str();
  command->add_option("--http", settings->http_address, "HOST:PORT of SPARQL, metrics and health over HTTP")
      ->envname("DOCENT_HTTP")
      ->capture_default_str();
  command
      ->add_option("--default-graph", *default_graph,
                   "union: queries without GRAPH see all graphs; strict: only docent:default")
      ->check(CLI::IsMember({"union", "strict"}))
      ->capture_default_str();
  command
      ->add_option(
          "--on-violation", *on_violation,
          "What to do about ontologies and data after whose loading the graph violates shapes (SHACL) of its "
          "ontologies, as it did not before: ignore, warn, refuse")
      ->check(CLI::IsMember({"ignore", "warn", "refuse"}))
      ->capture_default_str();
  command->add_option("--ontology", settings->ontologies, "Ontology files to have loaded");
  command->add_option(
      "--rules", settings->rules,
      "Rules to follow: rdfs, owl2rl, none, and .rules files; those of an earlier start stay in force unless "
      "none or another of the built-in sets is named");
  command->add_option("--allow", settings->allow,
                      "Addresses that SERVICE and LOAD may reach, with all below them: http://…, https://…, "
                      "file:///…; none by default");
  command
      ->add_option("--snapshot-records", settings->limits.snapshot_records,
                   "Turns after which the state is written as a snapshot, so that a start replays fewer")
      ->check(AtLeast(1))
      ->capture_default_str();
  command
      ->add_option("--log-bytes-kept", settings->limits.log_bytes_kept,
                   "About how much of the log is kept; what is older than that and than a snapshot goes")
      ->check(AtLeast(0))
      ->capture_default_str();
  command
      ->add_option("--history-bytes", settings->limits.history_bytes,
                   "Memory of past graph versions for as-of queries; older ones are made again from the log")
      ->check(AtLeast(0))
      ->capture_default_str();
  command
      ->add_option(
          "--http-name", settings->http_names,
          "NAME or NAME:PORT under which HTTP is reached, beside localhost and addresses; may be given again")
      ->allow_extra_args(false);
  command->add_flag("--insecure", settings->insecure,
                    "Allow addresses other than loopback although nothing authenticates clients");
  command->callback([settings, default_graph, on_violation, exit_code] {
    settings->on_violation = *on_violation == "refuse" ? OnViolation::kRefuse
                             : *on_violation == "warn" ? OnViolation::kWarn
                                                       : OnViolation::kIgnore;
    settings->default_graph =
        *default_graph == "strict" ? sparql::DefaultGraph::kStrict : sparql::DefaultGraph::kUnion;
    *exit_code = Serve(*settings);
  });
}

}  // namespace docent
