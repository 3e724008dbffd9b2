// docent status: which server answers, how it is, and how much it holds.
#include <CLI/CLI.hpp>
#include <iostream>
#include <iterator>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "docent/v1/context.grpc.pb.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/display_width.h"

namespace docent::server {
namespace {

// "1 run", "2 runs".
std::string Counted(uint64_t count, const char* noun) {
  return absl::StrCat(count, " ", noun, count == 1 ? "" : "s");
}

// "3 d 4 h", "4 h 12 min", "12 min 5 s": the two largest units.
std::string Lasting(uint64_t seconds) {
  const uint64_t minutes = seconds / 60, hours = minutes / 60, days = hours / 24;
  if (days > 0) return absl::StrCat(days, " d ", hours % 24, " h");
  if (hours > 0) return absl::StrCat(hours, " h ", minutes % 60, " min");
  if (minutes > 0) return absl::StrCat(minutes, " min ", seconds % 60, " s");
  return absl::StrCat(seconds, " s");
}

std::string Bytes(uint64_t bytes) {
  static constexpr const char* kUnits[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  double size = static_cast<double>(bytes);
  size_t unit = 0;
  for (; size >= 1024 && unit + 1 < std::size(kUnits); ++unit) size /= 1024;
  return unit == 0 ? absl::StrCat(bytes, " B") : absl::StrFormat("%.1f %s", size, kUnits[unit]);
}

std::string Names(const google::protobuf::RepeatedPtrField<std::string>& names) {
  return names.empty() ? "none" : absl::StrJoin(names, ", ");
}

void Print(const v1::StatusReply& status) {
  const auto line = [](const char* name, const std::string& value) {
    std::cout << absl::StrFormat("%-12s", name) << Printable(value) << "\n";
  };
  line("health", status.problem().empty() ? "ok" : status.problem());
  line("version", status.version());
  line("address", absl::StrCat("grpc ", status.grpc_address(), ", http ", status.http_address()));
  line("data folder", status.data_folder());
  line("log", Bytes(status.log_bytes()));
  line("up for", Lasting(status.uptime_s()));
  line("revision", absl::StrCat(status.revision()));
  line("facts", absl::StrCat(status.facts(), " in ", Counted(status.graphs(), "graph"), ", and ",
                             status.inferred(), " inferred"));
  line("ontologies", Names(status.ontologies()));
  line("rules", Names(status.rule_sets()));
  line("violations", status.on_violation());
  line("workflows",
       absl::StrCat(status.workflows(), ", and ", Counted(status.robot_services(), "robot service")));
  line("runs", absl::StrCat(status.runs(), ", ", status.live_runs(), " of them live"));
  line("robots", absl::StrCat(status.robots(), ", ", status.robots_offline(), " of them offline"));
}

int RunStatus(const ClientOptions& client) {
  grpc::ClientContext context;
  v1::StatusReply reply;
  const grpc::Status status = v1::Context::NewStub(Connect(client))->Status(&context, {}, &reply);
  if (!status.ok()) return Fail(status, client);
  if (client.json) {
    PrintJson(reply);
  } else {
    Print(reply);
  }
  return reply.problem().empty() ? kExitOk : kExitNegative;
}

}  // namespace

void AddStatusCommand(CLI::App* app, int* exit_code) {
  auto client = std::make_shared<ClientOptions>();
  CLI::App* command =
      app->add_subcommand("status", "Tell which server answers, how it is, and how much it holds");
  command->group(kServerGroup);
  AddClientOptions(command, client.get());
  command->footer(
      "Exit code 1: something keeps the server from serving as it should.\nExample:\n  docent status");
  command->callback([client, exit_code] { *exit_code = RunStatus(*client); });
}

}  // namespace docent::server
