// docent serve: the server.
#include <signal.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <iostream>

#include "absl/strings/str_cat.h"
#include "graph/command_line/log_output.h"
#include "graph/command_line/usage_error.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/settings_file.h"
#include "kb_server/cli/terminal.h"
#include "kb_server/door/descriptors.h"
#include "kb_server/grpc/one_callback_thread.h"
#include "kb_server/server.h"

namespace docent::server {
namespace {

void ShowProgress(uint64_t done, uint64_t all) {
  if (isatty(STDERR_FILENO) == 0) return;
  PrintProgress(absl::StrCat("replaying the log: ", done, " of ", all, done == all ? "\n" : ""));
}

int Serve(const ServerSettings& settings) {
  // one thread waits for signals; everybody else inherits the mask and is not disturbed
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  // The end of the terminal that it was started from is an end like others, unless nohup has it ignored.
  struct sigaction hang_up {};
  if (sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler != SIG_IGN) sigaddset(&signals, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);  // a file-size limit is an error of write(2), not the end
  UseLogOutput("docent", "%H:%M:%S.%e %l %v");

  if (absl::Status status = RaiseDescriptorLimit(); !status.ok()) return Fail(status);
  OneCallbackThread one_callback_thread;
  auto server = Server::Start(settings, ShowProgress);
  if (!server.ok()) return Fail(server.status());
  std::cout << "listening grpc=" << (*server)->grpc_address() << " http=" << (*server)->http_address()
            << (settings.simulated_clock.empty() ? "" : " time=simulated") << std::endl;
  timespec second{0, 500'000'000};
  while (true) {
    int received = sigtimedwait(&signals, nullptr, &second);
    if (received > 0) break;
    one_callback_thread.KeepAwake();
    if (!(*server)->Tend()) return Fail((*server)->status());
  }
  server->reset();
  return kExitOk;
}

constexpr char kConfig[] = "--config";
constexpr char kPrintConfig[] = "--print-config";

// What is not in ServerSettings as it is given.
struct ServeArguments {
  std::string default_graph = "union";
  std::string on_violation = "ignore";
  std::string config;
  bool print_config = false;
};

// Those that a settings file may have.
void AddServeOptions(CLI::App* command, ServerSettings* settings, ServeArguments* arguments) {
  command
      ->add_option("--data", settings->data_folder,
                   "Data folder: the durable log and snapshots; made if absent")
      ->type_name("FOLDER")
      ->capture_default_str();
  command->add_option("--grpc", settings->grpc_address, "HOST:PORT of the gRPC API; port 0 takes a free one")
      ->envname("DOCENT_GRPC")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command->add_option("--http", settings->http_address, "HOST:PORT of SPARQL, metrics and health over HTTP")
      ->envname("DOCENT_HTTP")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command->add_flag("--insecure", settings->insecure,
                    "Allow addresses other than loopback, although clients are not authenticated");
  command
      ->add_option("--http-name", settings->http_names,
                   "NAME or NAME:PORT that HTTP requests may have as Host, beside localhost and addresses")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command
      ->add_option("--web", settings->web_folder,
                   "Folder of the built browser app, in place of the one that comes along")
      ->type_name("FOLDER");
  command
      ->add_option(
          "--http-origin", settings->http_origins,
          "Origin of web pages of another server that may use HTTP (CORS), such as http://localhost:5173")
      ->type_name("ORIGIN")
      ->allow_extra_args(false);
  command
      ->add_option("--default-graph", arguments->default_graph,
                   "What queries without GRAPH see: all graphs (union), or docent:default alone (strict)")
      ->check(CLI::IsMember({"union", "strict"}))
      ->capture_default_str();
  command->add_option("--ontology", settings->ontologies, "Ontology files to load at the start")
      ->type_name("FILE");
  command
      ->add_option("--rules", settings->rules,
                   "Rule sets to use: rdfs, owl2rl, none, and .rules files. Those of an earlier start stay "
                   "in use, unless "
                   "none or another built-in set is named")
      ->type_name("RULES");
  command
      ->add_option("--on-violation", arguments->on_violation,
                   "What to do with what a client writes after which the graph violates SHACL shapes of its "
                   "ontologies that it did not violate before")
      ->check(CLI::IsMember({"ignore", "warn", "refuse"}))
      ->capture_default_str();
  command->add_flag(
      "--warn-unknown", settings->warn_unknown,
      "Warn of properties and classes that are in a namespace of the loaded ontologies and that "
      "none of them declares");
  command
      ->add_option("--allow", settings->allow,
                   "Addresses that SERVICE, LOAD and imports of services may reach, with all below them: "
                   "http://…, https://…, "
                   "file:///…")
      ->type_name("URL");
  command
      ->add_option(
          "--notify", settings->notify,
          "Webhooks that workflows may notify (ext:notify), with all below them: http://…, https://…")
      ->type_name("URL");
  command
      ->add_option("--mqtt", settings->mqtt,
                   "MQTT broker to whose topics workflows may publish (ext:notify to=\"mqtt:…\")")
      ->type_name("HOST:PORT");
  command
      ->add_option(
          "--snapshot-records", settings->limits.snapshot_records,
          "Number of turns after which a snapshot is written, so that a start replays no more of them")
      ->check(AtLeast(1))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--log-bytes-kept", settings->limits.log_bytes_kept,
                   "About how much of the log is kept; older records go once a snapshot covers them")
      ->check(AtLeast(0))
      ->type_name("BYTES")
      ->capture_default_str();
  command
      ->add_option(
          "--history-bytes", settings->limits.history_bytes,
          "Memory for past versions of the graph; older ones are made from the log when they are queried")
      ->check(AtLeast(0))
      ->type_name("BYTES")
      ->capture_default_str();
  command
      ->add_option("--simulated-clock", settings->simulated_clock,
                   "Take the time from this file, in which a simulator writes it (2026-05-12T09:00:00Z), in "
                   "place of the "
                   "system's clock")
      ->type_name("FILE");
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
  auto arguments = std::make_shared<ServeArguments>();
  CLI::App* command =
      app->add_subcommand("serve", "Run the server; the first line of output tells its addresses");
  command->group(kServerGroup);
  AddServeOptions(command, settings.get(), arguments.get());
  command
      ->add_option(kConfig, arguments->config,
                   "Read options from this settings file; those of the command line win")
      ->type_name("FILE");
  command->add_flag(kPrintConfig, arguments->print_config, "Print a settings file with all options, and end");
  command->footer(
      "Examples:\n"
      "  docent serve --data /tmp/docent --rules owl2rl\n"
      "  docent serve --config /etc/docent/docent.toml");
  command->callback([command, settings, arguments, exit_code] {
    const std::vector<std::string> not_in_files = {"help", kConfig + 2, kPrintConfig + 2};
    if (!arguments->config.empty()) {
      if (absl::Status status = ApplySettings(arguments->config, not_in_files, command); !status.ok()) {
        *exit_code = Fail(status);
        return;
      }
    }
    if (arguments->print_config) {
      std::cout << SettingsText(*command, not_in_files);
      return;
    }
    settings->on_violation = arguments->on_violation == "refuse" ? OnViolation::kRefuse
                             : arguments->on_violation == "warn" ? OnViolation::kWarn
                                                                 : OnViolation::kIgnore;
    settings->default_graph =
        arguments->default_graph == "strict" ? sparql::DefaultGraph::kStrict : sparql::DefaultGraph::kUnion;
    *exit_code = Serve(*settings);
  });
}

}  // namespace docent::server
