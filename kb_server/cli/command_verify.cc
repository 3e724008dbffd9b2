// docent verify FOLDER: looks for damage in a data folder, without a server and without changing anything.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "graph/log/folder_check.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/display_width.h"
#include "kb_server/cli/terminal.h"

namespace docent::server {
namespace {

struct VerifyArguments {
  std::string folder;
  bool json = false;
};

void ShowChecked(uint64_t done, uint64_t all) {
  if (isatty(STDERR_FILENO) == 0) return;
  PrintProgress(absl::StrCat("checking records: ", done, " of ", all, done == all ? "\n" : ""));
}

int Verify(const VerifyArguments& arguments) {
  const absl::StatusOr<log::FolderReport> report = log::CheckFolder(arguments.folder, ShowChecked);
  if (!report.ok()) return Fail(report.status());
  if (arguments.json) {
    const nlohmann::json json = {{"first", report->first},
                                 {"last", report->last},
                                 {"snapshots", report->snapshots},
                                 {"faults", report->faults}};
    std::cout << PrintableJson(json.dump()) << "\n";
  } else if (report->sound()) {
    std::cout << report->database << ": records " << report->first << " to " << report->last << " are whole; "
              << report->snapshots.size() << (report->snapshots.size() == 1 ? " snapshot" : " snapshots")
              << " too\n";
  }
  for (const std::string& fault : report->faults) std::cerr << "docent: " << fault << "\n";
  return report->sound() ? kExitOk : kExitNegative;
}

}  // namespace

void AddVerifyCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<VerifyArguments>();
  arguments->folder = DefaultDataFolder();
  CLI::App* command =
      app->add_subcommand("verify", "Check every record and snapshot of a data folder for damage");
  command->group(kServerGroup);
  command->add_option("folder", arguments->folder, "The data folder; a server may be using it")
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "Print JSON");
  command->footer("Exit code 1: something is damaged.\nExample:\n  docent verify /var/lib/docent");
  command->callback([arguments, exit_code] { *exit_code = Verify(*arguments); });
}

}  // namespace docent::server
